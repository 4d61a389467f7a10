"""The verdict on a campaign, from the files of its rounds."""

import json
from pathlib import Path

import pandas as pd

from swingdown import console
from swingdown.discovery.files import read_rounds
from swingdown.discovery.verdict import verdict
from swingdown.model import read_model


def discover_verdict(folders, output):
    """The verdict written, and its sentence."""
    rounds = read_rounds(folders)
    last = next(k for k, state in enumerate(rounds) if state["next"] is None or k == len(rounds) - 1)
    used = folders[: last + 1]
    found = verdict(
        rounds[: last + 1],
        [read_model(folder / "model.yaml") for folder in used],
        [pd.read_csv(folder / "ranking.csv") for folder in used],
        [pd.read_csv(folder / "groups.csv").to_dict("records") for folder in used],
    )
    partial = Path(output).with_suffix(".part")
    partial.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n")
    partial.replace(output)
    return f"{found['campaign']}: {found['status']}. {found['sentence']}"


if __name__ == "__main__":
    with console.job(snakemake.log[0]) as say:
        say(discover_verdict([Path(path).parent for path in snakemake.input.rounds], snakemake.output[0]))
