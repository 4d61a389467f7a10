"""How often a recording's questions err: simulated swings as they should be, and each of them spoilt in one way.

``python tests/benchmarks/questions.py [SWINGS]`` prints the tables that docs/files.md has, and with ``--even`` alone those of samples lost
at even distances and of a gain that drifts.
"""

import re
import sys
import tempfile
from itertools import product
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

from swingdown.answer import explain
from swingdown.engine.trajectory import TrajectoryError, simulate
from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.measurement.swings.even import evenly
from swingdown.measurement.swings.renumbered import lost_evenly
from swingdown.measurement.swings.spikes import find_spikes
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.half_swings import half_swings
from swingdown.pendulum.model import Model

BASE = ("viscous", "load_coulomb")
OTHERS = [e.name for e in SHIPPED if e.name not in BASE and e.beside in ("", "sine")]


def good(number):
    """(times, angle in rad, noise, period) of a swing that is as it should be; every second one has an effect the base model lacks."""
    draws = np.random.default_rng((20, number))
    while True:
        frequency, amplitude = draws.uniform(3, 12), draws.uniform(0.1, 2.6)
        period = 2 * np.pi / frequency
        rate = draws.choice([30, 60, 100, 250])
        if rate * period < 16:
            continue
        times = np.arange(int(draws.uniform(10, 30) * rate)) / rate
        values = {
            "natural_frequency": frequency,
            "viscous_ratio": 10 ** draws.uniform(-3, -1.7),
            "load_friction": draws.uniform(0, 0.004) * amplitude,
        }
        names = list(BASE)
        if number % 2:
            names.append(str(draws.choice(OTHERS)))
            model = Model(tuple(names))
            values |= {one.name: one.typical for one in model.definitions if one.name not in values}
        velocity = draws.choice([0.0, draws.uniform(-0.5, 0.5) * amplitude * frequency])
        try:
            angle = simulate(Model(tuple(names), values), times, amplitude, velocity)
        except (TrajectoryError, InputError):
            continue
        last = angle[-int(3 * period * rate) :]
        if np.ptp(last) < 0.1 * amplitude:  # at rest before the end: what is spoilt there would not show
            continue
        if np.abs(angle).max() > 3 or np.ptp(angle[: int(3 * period * rate)]) < 0.1 * amplitude:
            continue
        noise = amplitude * 10 ** draws.uniform(-3.5, -2)
        if draws.random() < 0.3:  # an encoder
            angle, noise = np.round(angle / noise) * noise, noise / 3
        else:
            angle = angle + noise * draws.standard_normal(times.size)
        return times, angle, noise, period, names[2:]


def held(times, angle, noise, period, draws):
    """Held for one to six periods before the release."""
    n = int(draws.uniform(1, 6) * period / times[1])
    return times, np.append(angle[0] + noise * draws.standard_normal(n), angle[:-n])


def lifted(times, angle, noise, period, draws):
    """Lifted from the middle within half a period to three, without a rest."""
    n = int(draws.uniform(0.5, 3) * period / times[1])
    rise = angle[0] * np.sin(np.linspace(0, np.pi / 2, n)) ** 2
    return times, np.append(rise + noise * draws.standard_normal(n), angle[:-n])


def released_again(times, angle, noise, period, draws):
    """Stopped after a third, lifted to where it began, and released anew."""
    n = len(angle) // 3
    m = int(2 * period / times[1])
    lift = angle[0] * np.linspace(angle[n - 1] / angle[0], 1, m)
    return times, np.concatenate([angle[:n], lift + noise * draws.standard_normal(m), angle])[: len(times)]


def dead(times, angle, noise, period, draws):
    """The sensor stays at one value from some moment between the tenth and a half on."""
    n = int(draws.uniform(0.1, 0.5) * len(angle))
    return times, np.append(angle[:n], np.full(len(angle) - n, angle[n]))


def dropped(times, angle, noise, period, draws):
    """A tenth of a period of samples lost, the time numbered on."""
    n, lost = int(draws.uniform(0.2, 0.6) * len(angle)), max(1, round(0.1 * period / times[1]))
    return times[:-lost], np.delete(angle, np.arange(n, n + lost))


def tenth(times, angle, noise, period, draws):
    """Each tenth sample lost, the time numbered on."""
    kept = angle[np.arange(len(angle)) % 10 != draws.integers(10)]
    return times[: len(kept)], kept


def stumble(times, angle, noise, period, draws):
    """The clock jumps by half a sample."""
    n = int(draws.uniform(0.2, 0.8) * len(angle))
    return times + np.where(np.arange(len(times)) > n, times[1] / 2, 0), angle


def offset(times, angle, noise, period, draws):
    """A zero 0.3 rad beside the vertical."""
    return times, angle + 0.3


def drift(times, angle, noise, period, draws):
    """A zero that drifts by a third of the first swing."""
    return times, angle + 0.33 * np.abs(angle).max() * times / times[-1]


def spikes(times, angle, noise, period, draws):
    """Three samples beside the swing by a tenth of it, or by 30 times the noise."""
    where = draws.choice(np.arange(20, len(angle) - 20), 3, replace=False)
    away = max(0.1 * np.ptp(angle), 30 * noise)
    return times, angle + away * np.isin(np.arange(len(angle)), where)


def flipped(times, angle, noise, period, draws):
    """The sign changes half way, not within 0.1 of the swing's size of the middle."""
    half = len(angle) // 2
    late = np.abs(angle[half:]) > 0.3 * np.abs(angle[half:]).max()
    n = half + int(np.argmax(late))
    return times, np.append(angle[:n], -angle[n:])


def degrees(times, angle, noise, period, draws):
    """Degrees, and nobody says so."""
    return times, np.degrees(angle)


def milliseconds(times, angle, noise, period, draws):
    """Milliseconds, and nobody says so."""
    return 1000 * times, angle


def at_the_top(times, angle, noise, period, draws):
    """Half a turn beside the vertical."""
    return times, angle + np.pi


def wrapped(times, angle, noise, period, draws):
    """A range that begins anew within the swing."""
    edge = 0.5 * np.abs(angle).max()
    return times, (angle - edge) % (2 * np.pi) - 2 * np.pi + edge


def resting(times, angle, noise, period, draws):
    """At rest for a third at the end."""
    n = len(angle) // 3
    fade = angle * np.clip((len(angle) - n - np.arange(len(angle))) / (len(angle) - n), 0, None)
    return times, fade + noise * draws.standard_normal(len(angle)) * (np.arange(len(angle)) > len(angle) - n)


SPOILT = {
    held: "in a hand",
    lifted: "in a hand",
    released_again: "released",
    dead: "dead|comes to rest|a hand stops",
    dropped: "jumps|(?i:out of step)",
    tenth: "1 of every 10 samples seems to be lost",
    stumble: "stumbles|the stamps scatter",
    offset: "swings about",
    drift: "drifts|swings about",
    spikes: "a spike",
    flipped: "jumps|(?i:out of step)|turns between",
    degrees: "back and forth|no unit",
    milliseconds: "a period of",
    at_the_top: "swings about|the top|whole turn",
    wrapped: "whole turn|the top|turns between",
    resting: "comes to rest",
}


def asked(times, angle, folder):
    """What is told of a recording, or the refusal; the columns state no unit."""
    (folder / "s.csv").write_text("recording,file\na,a.csv\n")
    np.savetxt(
        folder / "a.csv",
        np.column_stack([times, angle]),
        fmt="%.9g",
        delimiter=",",
        header="t,theta",
        comments="",
    )
    row = read_sheet(folder / "s.csv", check_files=False).loc["a"].to_dict()
    try:
        return str(ingest(row | {"file": str(folder / "a.csv"), "recording": "a"}).attrs.get("remarks", ""))
    except InputError as error:
        return "refused: " + str(error)


def left_out(number):
    """A sentence on what is left out of swings with up to 20 samples that are beside them by a tenth, or by 30 times the noise."""
    counts = {}
    for kind, longest in (("single", 1), ("in runs of up to five", 5)):
        spoilt = found = wrongly = 0
        for k in range(number):
            times, angle, noise, _, _ = good(k)
            draws = np.random.default_rng((22, k))
            angle, where = angle.copy(), np.zeros(angle.size, dtype=bool)
            asked_for = int(draws.integers(1, min(20, angle.size // 110) + 1))
            away = max(0.1 * np.ptp(angle), 30 * noise)
            for _ in range(1000):
                length = min(int(draws.integers(1, longest + 1)), asked_for - np.count_nonzero(where))
                at = int(draws.integers(10, angle.size - 10 - length))
                if not where[max(0, at - 8) : at + length + 8].any():
                    where[at : at + length] = True
                    angle[at : at + length] += away * draws.choice([-1, 1])
                if np.count_nonzero(where) == asked_for:
                    break
            marked = find_spikes(times, angle).where
            spoilt += np.count_nonzero(where)
            found += np.count_nonzero(marked & where)
            wrongly += np.count_nonzero(marked & ~where)
        counts[kind] = f"{found} of {spoilt} samples {kind} and {wrongly} that are sound"
    return f"left out as spikes: {', '.join(counts.values())}"


def told_of_lost(times, angle):
    """What is told of samples lost or repeated at even distances."""
    even = evenly(times, angle)
    period = half_swings(angle).period(times)
    return " ".join(lost_evenly(even, period / even.interval)) if even.kept else ""


def sound(number):
    """How often samples are said to be lost of swings of which none is: with noise that lasts, holes, steps, uneven times."""
    wrongly: dict[str, int] = {}
    for k in range(number):
        times, angle, noise, _, _ = good(k)
        draws = np.random.default_rng((23, k))
        lasting = noise * lfilter([np.sqrt(0.19)], [1, -0.9], draws.standard_normal(times.size))
        here = np.append(draws.random(times.size - 1) > 0.05, True)
        uneven = np.sort(times + 0.3 * times[1] * draws.uniform(-1, 1, times.size))
        kinds = {
            "white noise or an encoder": (times, angle),
            "and noise that lasts (AR(1), 0.9)": (times, angle + lasting),
            "and ten times the noise": (times, angle + 10 * noise * draws.standard_normal(times.size)),
            "and one sample of 20 missing": (times[here], angle[here]),
            "and uneven times": (uneven, np.interp(uneven, times, angle)),
        }
        for steps in (10, 30, 100, 1000):
            step = np.ptp(angle) / steps
            kinds[f"in {steps} steps"] = times, np.round(angle / step) * step
        for kind, swing in kinds.items():
            wrongly[kind] = wrongly.get(kind, 0) + bool(told_of_lost(*swing))
    return "\n".join(f"| {kind} | {count} of {number} |" for kind, count in wrongly.items())


def faint(number=20):
    """A row for each noise: how often it is seen that each tenth sample is lost, by samples a period, in 30 periods."""
    rows = []
    for noise in (0.003, 0.01, 0.03, 0.1, 0.3):
        cells = []
        for rate in (30, 60, 120, 250):
            count = np.arange(30 * rate)
            clean = np.exp(-0.02 * count / rate) * np.cos(2 * np.pi * count / rate)
            seen = 0
            for k in range(number):
                draws = np.random.default_rng((24, k))
                kept = (clean + noise * draws.standard_normal(count.size))[count % 10 != k % 10]
                seen += "1 of every 10" in told_of_lost(np.arange(kept.size) / rate, kept)
            cells.append(f"{seen}")
        rows.append(f"| {100 * noise:g} % | {' | '.join(cells)} |")
    return "\n".join(rows)


def distances():
    """How often one sample of 3 to 20 lost, or there twice, is told rightly, wrongly or not, in swings of 24 to 80 samples a period."""
    told = {"rightly": 0, "wrongly": 0, "not": 0}
    for rate, of, lost in product(range(24, 81, 2), (3, 4, 5, 7, 10, 13, 20), (True, False)):
        for k in range(0, of, max(1, of // 3)):
            count = np.arange(30 * rate)
            taken = count + (count + k) // (of - 1) if lost else count - (count + k) // of
            period = rate * of / (of - 1) if lost else rate * (of - 1) / of
            noise = 0.005 * np.random.default_rng((24, k, rate)).standard_normal(count.size)
            angle = np.exp(-0.02 * taken / period) * np.cos(2 * np.pi * taken / period + 0.3) + noise
            said = told_of_lost(count / 100, angle)
            words = f"1 of every {of} samples seems to be {'lost' if lost else 'there twice'}"
            told["rightly" if words in said else "wrongly" if said else "not"] += 1
    return ", ".join(f"{count} {how}" for how, count in told.items())


def gains():
    """A row for each release and drift of the gain: the quality that is told, the model that is fitted, and how the search ends."""
    times, rows = np.arange(3000) / 100, []
    model = Model(("viscous",), {"natural_frequency": 6.0, "viscous_ratio": 0.005})
    for amplitude in (0.2, 1.0):
        angle = simulate(model, times, amplitude, 0.0)
        for gain in (0.0, 0.3, -0.3):
            noise = 1e-3 * amplitude * np.random.default_rng(1).standard_normal(times.size)
            found = explain(times, angle * (1 + gain * times / times[-1]) + noise, unit="rad", rounds=3)
            status = found.verdict["status"]
            rows.append(
                f"| {amplitude} rad | {100 * gain:+.0f} % | {found.row['quality']:.0f} | {found.label} | {status} |"
            )
    return "\n".join(rows)


def main(number):
    """Prints one row for each question, and what was told of good swings."""
    seen = dict.fromkeys(SPOILT, 0)
    wrongly: dict[str, int] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for k in range(number):
            times, angle, noise, period, others = good(k)
            told = asked(times, angle, folder)
            if told and not told.startswith("it comes to rest"):
                wrongly["any"] = wrongly.get("any", 0) + 1
                print("good swing", k, others, told, file=sys.stderr)
            for way, words in SPOILT.items():
                said = asked(*way(times, angle, noise, period, np.random.default_rng((21, k))), folder)
                if re.search(words, said):
                    seen[way] += 1
                elif "-v" in sys.argv:
                    print("missed", k, way.__name__, others, said, file=sys.stderr)
    for way in SPOILT:
        print(f"| {way.__doc__.rstrip('.')} | {seen[way]} of {number} |")
    print(left_out(number))
    print(f"| told of swings as they should be | {wrongly.get('any', 0)} of {number} |")


if __name__ == "__main__":
    swings = next((int(one) for one in sys.argv[1:] if one.isdigit()), 300)
    if "--even" not in sys.argv:
        main(swings)
    print(sound(swings), faint(), distances(), gains(), sep="\n\n")
