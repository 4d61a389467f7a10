"""How often the 95 % intervals from turning points alone hold the truth, on simulated pendulums: of natural frequency and damping where
the law is known, and of period, quality and decay time as they are told, over all laws that the points leave.

``python tests/benchmarks/turning_points.py [PENDULUMS]`` prints a table: scatter alone, readings to a
scale's marks and a camera's frames, and points that nobody wrote down.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "engine"))
from turning import drawn

from swingdown.errors import InputError
from swingdown.measurement.points.points_recording import as_recording, to_angle
from swingdown.measurement.points.turning_points import points_in
from swingdown.pendulum.model import PAPER_MODELS, Model, models
from swingdown.studies.described import described, described_by
from swingdown.studies.experiment import fit_recording
from swingdown.studies.norms import combine_recordings
from swingdown.studies.pendulums import pendulums, quantities_of
from swingdown.studies.quantities import quantities

ABOUT = {
    "recording": "swing",
    "campaign": "pendulum",
    "role": "fit",
    "file": "",
    "sha256": "",
    "source": "simulated",
    "emulated": "yes",
}
LABELS = {
    "viscous_ratio": "viscous",
    "quadratic_coefficient": "quadratic_drag",
    "load_friction": "load_coulomb",
}


def scattered(draws, times, angles, deviations):
    """Readings that scatter."""
    return times + deviations[0] * draws.standard_normal(times.size), angles + deviations[
        1
    ] * draws.standard_normal(times.size)


def to_marks(draws, times, angles, deviations):
    """Readings to the nearest mark and frame, three standard deviations apart, with as much scatter as a third of these."""
    times, angles = scattered(draws, times, angles, deviations)
    steps = 3 * np.array(deviations)
    return np.round(times / steps[0]) * steps[0], np.round(angles / steps[1]) * steps[1]


def missing(draws, times, angles, deviations):
    """Readings that scatter, of which every fifth was not written down."""
    kept = draws.random(times.size) > 0.2
    kept[0] = True
    times, angles = scattered(draws, times, angles, deviations)
    return times[kept], angles[kept]


TOLD = ("period", "quality", "decay_time")


def as_told(norms, fits, label, values):
    """Whether the interval of each of TOLD holds the truth, over all laws and with the law chosen alone; and the k of both."""
    chosen = described_by(norms)
    factor = float(np.nanmax(fits["coverage_factor"].sel(fitted=chosen)))
    row = pendulums(norms).iloc[0].to_dict()
    amplitude = row["amplitude_rad"]
    truth = quantities(Model(tuple(label.split("+")), values), amplitude)
    every, alone = quantities_of(row), described(norms.isel(recording=0), chosen)[1]
    return [
        [
            abs(one[name].value - truth[name].value) < factor * one[name].uncertainty
            if name in one
            else np.nan
            for name in TOLD
        ]
        for one in (every, alone)
    ]


def main(count, ways):
    """The table."""
    known = models(PAPER_MODELS)
    print("| turning points | sides | given the law: frequency, damping | told: period, Q, decay | with the law chosen: Q, decay | law found | not read |\n|---|---|---|---|---|---|---|")  # fmt: skip
    for way in ways:
        for both in (False, True):
            inside, told, lawful, lost = {True: [], False: []}, [], [], 0
            for number in range(count):
                draws = np.random.default_rng((30, number))
                values, (times, angles), deviations = drawn(draws)
                step = 1 if both else 2
                times, angles = way(draws, times[::step] + 2 + draws.random(), angles[::step], deviations)
                try:
                    points = points_in(times, angles, "swing", in_rad=1.0)
                except InputError as problem:
                    print(f"    {number}: {problem.problem}", file=sys.stderr)
                    points = None
                if points is None or points.both != both:
                    lost += 1
                    continue
                angle = to_angle(as_recording(points, "rad", ABOUT))
                fits = fit_recording(angle, known)
                label = "+".join(LABELS[name] for name in values if name in LABELS)
                own = fits.sel(fitted=label)
                for name, value in values.items():
                    one = {
                        key: float(own[key].sel(parameter=name))
                        for key in ("value", "random_standard_error", "coverage_factor")
                    }
                    off = abs(one["value"] - value) < one["coverage_factor"] * one["random_standard_error"]
                    inside[name == "natural_frequency"].append(off)
                norms = combine_recordings([fits])
                lawful.append(label == described_by(norms))
                told.append(as_told(norms, fits, label, values))
            shares = [100 * np.mean(inside[key]) for key in (True, False)]
            every, alone = 100 * np.nanmean(np.array(told, dtype=float), axis=0)
            name = way.__doc__.partition(",")[0].rstrip(".").lower()
            print(f"| {name} | {'both' if both else 'one'} | {shares[0]:.1f}, {shares[1]:.1f} % | {every[0]:.1f}, {every[1]:.1f}, {every[2]:.1f} % | {alone[1]:.1f}, {alone[2]:.1f} % | {100 * np.mean(lawful):.0f} % | {lost} of {count} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    chosen = sys.argv[2:] or ("scattered", "to_marks", "missing")
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 300, [globals()[name] for name in chosen])
