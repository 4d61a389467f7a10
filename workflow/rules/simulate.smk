# The simulation study: swings of known damping, noise on them, and what fits make of it.
# needs: the config alone
# makes: results/simulation/, results/tables/table2.csv


rule simulate:
    output:
        "results/simulation/realizations.nc",
    log:
        "results/logs/simulate.log",
    params:
        simulation=config["simulation"],
        model=config["model"],
        seed=config["seed"],
        code=code("simulate"),
    message:
        "Simulating swings and drawing their noise"
    script:
        "../scripts/simulate.py"


rule fit_simulated:
    input:
        realizations=rules.simulate.output[0],
    output:
        "results/simulation/norms_{simulated}.nc",
    log:
        "results/logs/fit_simulated/{simulated}.log",
    params:
        fitted=config["simulation"]["fitted"],
        start=config["simulation"]["start"],
        effects=config["effects"],
        code=code("fit_simulated"),
    message:
        "Fitting the noisy swings simulated with {wildcards.simulated}"
    script:
        "../scripts/fit_simulated.py"


rule table2:
    input:
        norms=expand("results/simulation/norms_{simulated}.nc", simulated=config["simulation"]["simulated"]),
        published=find("resources/paper/table2.csv"),
    output:
        norms="results/simulation/norms.nc",
        table=report("results/tables/table2.csv", category="Tables", labels={"table": "2"}),
    log:
        "results/logs/table2.log",
    params:
        code=code("table2"),
    message:
        "Collecting the norms of the simulation study (Table 2)"
    script:
        "../scripts/table2.py"
