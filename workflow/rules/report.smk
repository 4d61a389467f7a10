# One page that holds it all.
# needs: TABLES and FIGURES of the stages above, the captions in workflow/report/
# makes: results/report.html


rule report:
    message: "Writing the report"
    input:
        tables=TABLES,
        figures=[path for path in FIGURES if path.endswith(".svg")],
        captions=[f"{workflow.basedir}/workflow/report/{name}.rst" for name in DRAWN],
        recordings=expand("results/recordings/{recording}.nc", recording=PLAN.measured),
        verdicts=VERDICTS,
        seen=SEEN_FIGURES if VERDICTS else [],
        told=told(),
        template=f"{workflow.basedir}/workflow/report/report.html.j2",
        code=code("report"),
    output: "results/report.html"
    log: "results/logs/report.log"
    params:
        settings=config,
    script: "../scripts/report.py"
