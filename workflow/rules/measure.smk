# From files to angles.
# needs: the recordings' files; for recordings in volts the apparatus sheet and the tower records it names
# makes: results/recordings/, results/angles/, results/calibration/, results/tables/uncertainty_budget.csv
# A recording that cannot be used stops no other: its file says why, and the steps that follow leave it out.

from swingdown.measurement.apparatus import read_apparatus


rule record:
    input:
        file=lambda wildcards: raw(wildcards.recording),
    output:
        "results/recordings/{recording}.nc",
    log:
        "results/logs/record/{recording}.log",
    params:
        row=lambda wildcards: PLAN.rows[wildcards.recording],
        sheet=config.get("recordings"),
        unnamed=lambda wildcards: unnamed(wildcards.recording),
        calibrated=PLAN.apparatus is not None,
        restoring=config["model"]["restoring"],
        code=code("record"),
    message:
        "Reading {wildcards.recording}"
    script:
        "../scripts/record.py"


rule angle:
    input:
        recording="results/recordings/{recording}.nc",
        calibration=lambda wildcards: (
            "results/calibration/calibration.nc" if wildcards.recording in PLAN.in_volts else []
        ),
    output:
        "results/angles/{recording}.nc",
    log:
        "results/logs/angle/{recording}.log",
    params:
        mode=config["calibration"]["mode"],
        restoring=config["model"]["restoring"],
        code=code("angle"),
    message:
        "From signal to angle: {wildcards.recording}"
    script:
        "../scripts/angle.py"


if PLAN.in_volts:

    rule calibrate:
        input:
            apparatus=str(find(PLAN.apparatus)),
            towers=nameable(
                str(find(point["file"]))
                for point in read_apparatus(PLAN.apparatus)["points"]
                if not is_url(point["file"])
            ),
            rest=[f"results/recordings/{name}.nc" for name in PLAN.statics() if name in PLAN.in_volts],
        output:
            line="results/calibration/calibration.nc",
            budget=report(
                "results/tables/uncertainty_budget.csv", category="Tables", labels={"table": "budget"}
            ),
        log:
            "results/logs/calibrate.log",
        params:
            mode=config["calibration"]["mode"],
            draws=config["calibration"]["draws"],
            seed=config["seed"],
            code=code("calibrate"),
        message:
            "Calibrating: heights to angles, angles and voltages to a line"
        script:
            "../scripts/calibrate.py"
