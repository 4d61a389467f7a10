# One page that holds it all.
# needs: tables, verdicts and figures of the study, the captions in workflow/report/
#        and, where they lie there, the results of sweeps: the report shows them but never computes them
# makes: results/report.html

from swingdown.report.page import FILES
from swingdown.report.sections import FEW

# What the swings are drawn from in the page of one's own recordings: the last round's fit. Of a class there is no room for it.
FITS = (
    expand("results/discovery/{campaign}/last/fit.nc", campaign=PLAN.searched)
    if OWN and len(PLAN.searched) <= FEW
    else []
)


rule page:
    input:
        tables=MADE.tables,
        figures=[path for path in FIGURES if path.endswith(".svg")],
        captions=[
            f"{workflow.basedir}/workflow/report/{Path(path).stem}.rst"
            for path in FIGURES
            if path.endswith(".svg")
        ],
        recordings=expand("results/recordings/{recording}.nc", recording=PLAN.measured),
        verdicts=MADE.verdicts,
        seen=MADE.seen,
        fits=FITS,
        curves=MADE.curves,
        sweep_captions=SWEEP_CAPTIONS,
        told=told(),
        form=list(map(str, FILES)),
    output:
        "results/report.html",
    log:
        "results/logs/report.log",
    params:
        settings=config,
        sweeps=swept(),
        code=code("report"),
    message:
        "Writing the report"
    script:
        "../scripts/report.py"


rule report:
    input:
        lambda wildcards: rules.manifest.input,
        "results/manifest.json",
    localrule: True
