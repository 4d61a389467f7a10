"""Campaigns with hidden effects as they lie in results/hidden_effects: what a method may see, and the truth beside it."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from swingdown import dataset
from swingdown.errors import InputError
from swingdown_trials.trial import calibration_of


@dataclass(frozen=True)
class Campaign:
    """One campaign: its files and the effects that its catalogue lacks, which a method may know, and the truth, which it may not."""

    name: str
    files: tuple
    lacks: tuple
    truth: dict

    def swings(self):
        """A list of (times in s since the first sample, angles in rad)."""
        return [swing(path) for path in self.files]


def swing(path):
    """(times in s since the first sample, angles in rad) of one CSV file; InputError where it is not there."""
    if not Path(path).is_file():
        raise InputError(path, "the recording is not there", mend="run snakemake hidden_effects again")
    table = pd.read_csv(path)
    times = table["t_s"].to_numpy()
    if "encoder_V" not in table:
        return times - times[0], table["theta_rad"].to_numpy()
    known = dataset.read(calibration_of(Path(path).parent, Path(path).stem.rsplit("-", 1)[0])).sel(mode="gum")
    slope, zero = float(known["line"].sel(coefficient="slope")), float(known["rest_voltage"])
    return times - times[0], slope * (table["encoder_V"].to_numpy() - zero)


def campaigns(folder):
    """The list of ``Campaign`` in a folder results/hidden_effects; InputError where it holds none."""
    folder = Path(folder)
    truths = sorted((folder / "truth").glob("*.json"))
    if not truths:
        raise InputError(
            folder,
            "no campaigns with hidden effects",
            "truth/*.json and campaigns/*/sheet.csv",
            "run snakemake hidden_effects first, or say where with --hidden",
        )
    found = []
    for path in truths:
        place = folder / "campaigns" / path.stem
        for needed in (place / "sheet.csv", place / "excluded.json"):
            if not needed.is_file():
                raise InputError(
                    needed, f"not there, though {path} is", mend="run snakemake hidden_effects again"
                )
        truth, lacks = (json.loads(one.read_text()) for one in (path, place / "excluded.json"))
        sheet = pd.read_csv(place / "sheet.csv", dtype=str) if truth else None
        for name, one in truth.items():
            # beside the sheet, whatever folder it was made in
            files = tuple(
                str(place / Path(file).name) for file in sheet.loc[sheet["campaign"] == name, "file"]
            )
            found.append(Campaign(name, files, tuple(lacks.get(name, ())), one))
    return found


def row(method, one, names, seconds, said=None):
    """One campaign's row of discovery.csv, as a dict: ``names`` lists for each term that is named the effects it may stand for.

    ``exact`` every hidden effect is named and no other (``inside`` the same, unless a method tells ties); ``wrong`` an effect is named that is not hidden; ``alarm`` anything
    is found; ``abstained`` no effect is named. ``said`` is "named" or "consistent" unless told otherwise.
    """
    hidden, kind = set(one.truth["hidden"]), one.truth["kind"]
    said = said or ("named" if names else "consistent")
    told = [next((name for name in rivals if name in hidden), rivals[0]) for rivals in names]
    exact = kind in ("single", "pair") and set(told) == hidden
    return {
        "method": method,
        "campaign": one.name,
        "kind": kind,
        "hidden": "+".join(one.truth["hidden"]),
        "noise": one.truth["noise"],
        "ratio": one.truth["ratio"],
        "said": said,
        "named": "+".join(dict.fromkeys(told)),
        "exact": exact,
        "inside": exact,
        "wrong": any(name not in hidden for name in told),
        "alarm": said not in ("consistent", "failed"),
        "abstained": not told and said != "failed",
        "cpu_s": seconds,
    }


def period(times, angle):
    """The period (s) of a swing, from the largest line of its spectrum: good enough to choose windows by."""
    window = np.hanning(2 * angle.size)[
        angle.size :
    ]  # most of it at the beginning: some swings die out early
    power = np.abs(np.fft.rfft((angle - np.average(angle, weights=window)) * window, 4 * angle.size))
    power[:12] = 0  # fewer than three swings in a record are no line but a drift
    return 4 * times[-1] / np.argmax(power)
