"""Writes the emulated bench: swings, tower and rest records as CSV, the truth behind them, and their SHA-256.

    python emulate.py [--to FOLDER] [--only NAME ...]

No apparatus stood behind these files. The equations of motion are written and integrated here on their own (DOP853
from reversal to reversal), so that a fault in the package's trajectories cannot hide in the data they are tried on.
Needs numpy, scipy and pyyaml. The same seed writes the same bytes.
"""

import argparse
import hashlib
from math import acos, cos, degrees, exp, pi, radians, sin
from pathlib import Path

import numpy as np
import yaml
from scipy.integrate import solve_ivp

SEED = 2017
RATE = 100.0  # samples per second
SWING_SECONDS, TOWER_SECONDS = 30.0, 3.0

# The pendulum: quadratic drag and friction that grows with the rod's tension, the paper's own finding.
NATURAL_FREQUENCY = 7.25  # rad/s
QUADRATIC_COEFFICIENT = 0.0012  # s
LOAD_FRICTION = 0.0018

# True lengths (m). config/apparatus.yaml has what was "measured"; each differs by less than its limit.
ARM, SHAFT_DIAMETER, OVER_SHAFT, BOB_DIAMETER = 0.208013, 0.0127008, 0.246338, 0.0253991
TOWER_HEIGHTS = (0.019512, 0.023839, 0.034461, 0.050888)

# The encoder: 72 degrees over 10 V, with one gain and one zero error within its manual's limits, the same in every
# record; then white electronics noise and a 14-bit converter over -10 … 10 V.
VOLTS_PER_RADIAN, GAIN_ERROR = 10.0 / radians(72.0), 0.0012
ZERO_VOLTAGE = 5.0 + 0.0065
NOISE_VOLTS, STEP_VOLTS = 0.002, 20.0 / 2**14

REST_ANGLE = (
    0.00008  # rad; the rig was tapped until the bob settled, else friction holds it anywhere within 1.8 mrad
)
RELEASES_DEG = (20, 20, 22, 22, 24, 24, 27, 27, 30, 30, 34, 34)

# A second campaign on the same bench, the bearing changed for one whose friction first winds up like a spring (Dahl):
# an effect that the study's models do not have, for the search to find.
SECOND_RELEASES_DEG, SECOND_SECONDS = (16, 18, 21, 25, 29, 34), 20.0
PRESLIDING_FRICTION, PRESLIDING_ANGLE = 0.05, 0.006  # rad/s^2, rad


def acceleration(angle, velocity, direction):
    """Angular acceleration (rad/s^2) while the bob moves in ``direction`` (+1 or -1)."""
    gravity = -(NATURAL_FREQUENCY**2) * sin(angle)
    drag = -NATURAL_FREQUENCY * QUADRATIC_COEFFICIENT * velocity * abs(velocity)
    tension = velocity**2 + NATURAL_FREQUENCY**2 * cos(angle)  # times m L: the load on the bearing
    return gravity + drag - LOAD_FRICTION * tension * direction


def motion(times, release_angle, friction=0.0):
    """Angles (rad) at ``times`` (s after a release from rest): one integration from each reversal to the next.

    ``friction`` (rad/s^2) is that which winds up over ``PRESLIDING_ANGLE`` after each reversal, beside the rest.
    """
    angles = np.full(len(times), np.nan)
    start, angle, wound = 0.0, release_angle, 0.0

    def bearing(to, since, before, way):
        """The wound-up friction (rad/s^2) at the angle ``to``, ``before`` at the reversal ``since`` (rad)."""
        return way * friction + (before - way * friction) * exp(-way * (to - since) / PRESLIDING_ANGLE)

    while start < times[-1]:
        if abs(sin(angle)) <= LOAD_FRICTION * cos(angle):  # friction holds it
            angles[times >= start] = angle
            return angles
        direction = -np.sign(angle)
        # The first instant moves off the reversal, where the event would be found again at once.
        head = 1e-4
        first = acceleration(angle, 0.0, direction) - wound
        begin = (angle + 0.5 * first * head**2, first * head)

        def reversal(_, state):
            return state[1]

        reversal.terminal, reversal.direction = True, -direction
        piece = solve_ivp(
            lambda _, state, way=direction, at=angle, had=wound: (
                state[1],
                acceleration(state[0], state[1], way) - bearing(state[0], at, had, way),
            ),
            (start + head, start + 2 * pi / NATURAL_FREQUENCY),
            begin,
            method="DOP853",
            rtol=1e-12,
            atol=1e-14,
            events=reversal,
            dense_output=True,
        )
        end = piece.t_events[0][0]
        early = (times >= start) & (times < start + head)
        angles[early] = angle + 0.5 * first * (times[early] - start) ** 2
        during = (times >= start + head) & (times < end)
        angles[during] = piece.sol(times[during])[0]
        turned = piece.y_events[0][0][0]
        start, angle, wound = end, turned, bearing(turned, angle, wound, direction)
    return angles


def voltages(angles, rng):
    """Volts as the converter reads them from the encoder at ``angles`` (rad)."""
    clean = ZERO_VOLTAGE + (1 + GAIN_ERROR) * VOLTS_PER_RADIAN * np.asarray(angles)
    return np.round((clean + rng.normal(0, NOISE_VOLTS, len(clean))) / STEP_VOLTS) * STEP_VOLTS


def tower_angle(height):
    """The angle (rad) of the arm when the bob rests on a tower of true ``height`` (m)."""
    return acos(((OVER_SHAFT - SHAFT_DIAMETER / 2) - (height + BOB_DIAMETER / 2)) / ARM)


def records():
    """Name, text and truth of every record, by name; each has a random stream of its own."""
    seconds = np.arange(int(SWING_SECONDS * RATE)) / RATE
    for number, nominal in enumerate(RELEASES_DEG, 1):
        rng = np.random.default_rng([SEED, number])
        release = radians(nominal) + rng.normal(0, radians(0.25))
        late = rng.uniform(0, 1 / RATE)  # the hand lets go within the sample before the first one kept
        truth = {"release_angle_deg": degrees(release), "released_before_first_sample_s": float(late)}
        yield f"swing_{number:02d}", seconds, lambda a=release, b=late: motion(seconds + b, a), rng, truth
    second = np.arange(int(SECOND_SECONDS * RATE)) / RATE
    for number, nominal in enumerate(SECOND_RELEASES_DEG, 1):
        rng = np.random.default_rng([SEED, 300 + number])
        release = (-1) ** number * radians(nominal) + rng.normal(0, radians(0.25))
        late = rng.uniform(0, 1 / RATE)
        truth = {"release_angle_deg": degrees(release), "released_before_first_sample_s": float(late)}
        swing = lambda a=release, b=late: motion(second + b, a, PRESLIDING_FRICTION)  # noqa: E731
        yield f"second_{number}", second, swing, rng, truth
    for number, height in enumerate(TOWER_HEIGHTS, 1):
        rng = np.random.default_rng([SEED, 100 + number])
        short = np.arange(int(TOWER_SECONDS * RATE)) / RATE
        angle = tower_angle(height)
        truth = {"height_m": height, "angle_deg": degrees(angle)}
        yield f"tower_{number}", short, lambda a=angle, t=short: np.full_like(t, a), rng, truth
    rng = np.random.default_rng([SEED, 200])
    yield "rest", seconds, lambda: np.full(len(seconds), REST_ANGLE), rng, {"angle_deg": degrees(REST_ANGLE)}


def main(to, only=()):
    """The folder written to. All records, truth.yaml and SHA256SUMS; with ``only``, the named records alone."""
    to = Path(to)
    to.mkdir(parents=True, exist_ok=True)
    truths, sums = {}, []
    for name, seconds, angles, rng, truth in records():
        truths[name] = truth
        if only and name not in only:
            continue
        head = f"# emulated: yes\n# source: resources/bench/emulate.py, seed {SEED}; no real apparatus was recorded\n"
        rows = zip(seconds, voltages(angles(), rng), strict=True)
        text = head + "time_s,voltage_V\n" + "".join(f"{t:.2f},{v:.5f}\n" for t, v in rows)
        (to / f"{name}.csv").write_bytes(text.encode("ascii"))
        sums.append(f"{hashlib.sha256(text.encode('ascii')).hexdigest()}  {name}.csv\n")
    if not only:
        (to / "SHA256SUMS").write_text("".join(sums), encoding="ascii")
        (to / "truth.yaml").write_text(truth_text(truths), encoding="utf-8")
    return to


def truth_text(records_truth):
    """The truth as YAML: what the emulation used and an analysis should find again."""
    truth = {
        "emulated": True,
        "seed": SEED,
        "model": {
            "effects": ["quadratic_drag", "load_coulomb"],
            "restoring": "sine",
            "form": "consistent",
            "values": {
                "natural_frequency": NATURAL_FREQUENCY,
                "quadratic_coefficient": QUADRATIC_COEFFICIENT,
                "load_friction": LOAD_FRICTION,
            },
            "units": {"natural_frequency": "rad/s", "quadratic_coefficient": "s", "load_friction": "1"},
        },
        "second_campaign": {
            "hidden": "presliding",
            "values": {"presliding_friction": PRESLIDING_FRICTION, "presliding_angle": PRESLIDING_ANGLE},
            "units": {"presliding_friction": "rad/s^2", "presliding_angle": "rad"},
        },
        "lengths_m": {
            "arm": ARM,
            "shaft_diameter": SHAFT_DIAMETER,
            "over_shaft": OVER_SHAFT,
            "bob_diameter": BOB_DIAMETER,
        },
        "encoder": {
            "slope_rad_per_V": 1 / ((1 + GAIN_ERROR) * VOLTS_PER_RADIAN),
            "zero_V": ZERO_VOLTAGE,
            "nominal_slope_rad_per_V": 1 / VOLTS_PER_RADIAN,
            "nominal_zero_V": 5.0,
            "noise_V": NOISE_VOLTS,
            "step_V": STEP_VOLTS,
        },
        "records": records_truth,
    }
    head = "# What resources/bench/emulate.py used. No analysis may read this file; tests compare with it.\n"
    return head + yaml.safe_dump(truth, sort_keys=False)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write the emulated bench.")
    parser.add_argument(
        "--to", default=Path(__file__).resolve().parent, help="folder (default: this script's)"
    )
    parser.add_argument("--only", nargs="*", default=(), help="names of records, such as swing_01")
    arguments = parser.parse_args()
    main(arguments.to, arguments.only)
