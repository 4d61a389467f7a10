# The paper's figures, in its numbering, and on demand a picture of any recording.
# needs: the datasets and tables of the stages that are part of this study
# makes: results/figures/fig01 … fig15 (.svg and .png); results/figures/recordings/

# A figure, and what its function in swingdown.plots takes, by the names of its arguments. A further figure is a line
# here, that function, and a caption in workflow/report/. Those that take no data lie drawn beside their captions.
DRAWN = {}
DRAWINGS = ["fig01"] + (["fig06"] if PLAN.in_volts else [])

if config["simulation"]["simulated"]:
    norms = {"norms": "results/simulation/norms.nc", "table2": "results/tables/table2.csv"}
    DRAWN["fig02"] = {"realizations": "results/simulation/realizations.nc"}
    DRAWN |= {"fig03": norms, "fig04": norms, "fig05": norms}

if PLAN.in_volts:
    DRAWN["fig07"] = {"apparatus": str(find(PLAN.apparatus))}
    DRAWN["fig08"] = {"calibration": "results/calibration/calibration.nc"}

if PLAN.campaigns:
    # the paper shows one swing, here the first that can be used; the fits of all are in results/experiment/fits/
    swing = {
        "fits": expand("results/experiment/fits/{recording}.nc", recording=PLAN.swings()),
        "angles": expand("results/angles/{recording}.nc", recording=PLAN.swings()),
    }
    norms = {"norms": "results/experiment/norms.nc"}
    DRAWN["fig09"] = {"angles": swing["angles"]}
    DRAWN |= {"fig10": swing, "fig11": swing, "fig12": swing, "fig13": swing | norms, "fig14": swing | norms}
    DRAWN["fig15"] = norms | {"table3": "results/tables/table3.csv"}


# In a study of one's own they are made when asked for by name; the calibration line is its own, too.
SHOWN = [name for name in (*DRAWINGS, *DRAWN) if not OWN or name == "fig08"]
FIGURES = MADE.figures + expand("results/figures/{name}.{ending}", name=SHOWN, ending=["svg", "png"])


for name in DRAWINGS:

    rule:
        name:
            name
        input:
            here([f"{workflow.basedir}/workflow/report/{name}.{ending}" for ending in ("svg", "png")]),
        output:
            svg=report(
                f"results/figures/{name}.svg",
                caption=f"../report/{name}.rst",
                category="Figures",
                labels={"figure": str(int(name.removeprefix("fig")))},
            ),
            png=f"results/figures/{name}.png",
        log:
            f"results/logs/figures/{name}.log",
        params:
            code=code("drawing"),
        message:
            f"Copying Figure {int(name.removeprefix('fig'))}"
        script:
            "../scripts/drawing.py"


for name, needed in DRAWN.items():

    rule:
        name:
            name
        input:
            **needed,
        output:
            svg=report(
                f"results/figures/{name}.svg",
                caption=f"../report/{name}.rst",
                category="Figures",
                labels={"figure": str(int(name.removeprefix("fig")))},
            ),
            png=f"results/figures/{name}.png",
        log:
            f"results/logs/figures/{name}.log",
        params:
            data=needed,
            code=code("figure"),
        message:
            f"Drawing Figure {int(name.removeprefix('fig'))}"
        script:
            "../scripts/figure.py"


if PLAN.campaigns:

    rule used_part:
        input:
            recording="results/recordings/{recording}.nc",
        output:
            svg="results/figures/recordings/{recording}.svg",
            png="results/figures/recordings/{recording}.png",
        log:
            "results/logs/figures/recordings/{recording}.log",
        params:
            code=code("used_part"),
        message:
            "Drawing what is used of {wildcards.recording}"
        script:
            "../scripts/used_part.py"
