"""Public benchmarks of one degree of freedom, by their published splits: Silverbox and EMPS under their measured input, and equations.

    .venv/bin/python tests/benchmarks/driven.py FOLDER [silverbox emps equations]

FOLDER holds the files of ``FILES``, which are others' and not part of the project; each is held against its SHA-256. Nothing is fetched.
Model and input are chosen beforehand or by the training part alone; a test part gives its first samples for the state, as its publishers say.
"""

import hashlib
import json
import sys
import time
from functools import partial
from itertools import combinations
from pathlib import Path

import numpy as np
import scipy.io
from scipy.optimize import minimize_scalar
from scipy.signal import resample_poly

from swingdown.arrays import swing_under
from swingdown.engine.trajectory import TrajectoryError, sensitivities, simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_jointly
from swingdown.fitting.result import Begin, SwingStart
from swingdown.pendulum.drive import drive
from swingdown.pendulum.model import Model, catalogue
from swingdown_trials.certified.minimum import least_squares

FILES = {
    "SNLS80mV.mat": "5c7413a52255af0cb4e2f93fb6903beb92b08965ba1e6ad0a6ffedfed8477ed4",
    "DATA_EMPS.mat": "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e",
    "DATA_EMPS_PULSES.mat": "0eab75bb1f6b16228ee78791343a88bf9bfd9a51036ac9807d7b5fc11c0e1704",
    "strogatz_extended.json": "b11f8bda01ceee5c5c9445521ac74c8819361af4251bb90c0be398aaeb1a1136",
    "osc1_train.csv": "a846b36b931dee4e2335faf9fb4195a7a8d1b4e4430e915266ef45fcd2e07ee7",
}
"""Silverbox: Wigren & Schoukens, ECC 2013. EMPS: Janot, Gautier & Brunot, 2019. ODEBench: sdascoli/odeformer, odeformer/odebench, at
c9193012. Oscillator 1: deep-symbolic-mathematics/LLM-SR, data/oscillator1/train.csv, at 41c21231."""


def opened(folder, name):
    """The path of a file that is the published one."""
    path = Path(folder) / name
    if hashlib.sha256(path.read_bytes()).hexdigest() != FILES[name]:
        raise SystemExit(f"{path} is another file than the one that the figures are of")
    return path


# ---- Silverbox: an electronic Duffing oscillator; V1 drives it, V2 is read ----

SILVERBOX = {
    "train": (40650, 105712),
    "multisine": (105712, 127400),
    "arrow, all": (100, 40575),
    "arrow, no extrapolation": (100, 32100),
}
FIRST = 50  # samples of a test part that tell its state
FINER = 3  # of the input, which reaches to a third of its sampling rate: between its samples it is what no faster signal is


def silverbox(folder):
    found = scipy.io.loadmat(opened(folder, "SNLS80mV.mat"))
    u, y, rate = found["V1"].ravel(), found["V2"].ravel(), 1e7 / 2**14
    times = np.arange(y.size) / rate
    finer = resample_poly(u, FINER, 1, window=("kaiser", 8.0))
    under = drive(np.arange(finer.size) / rate / FINER, finer, "torque", free=("gain", "delay"))
    effects = "viscous+constant_torque+quadratic_stiffness+cubic_stiffness"
    model = Model(f"{effects}+{under.effect}", restoring="linear")

    def part(name, most=None):
        first, last = SILVERBOX[name]
        own = slice(first, min(last, first + (most or last)))
        return swing_under(under, times[own], y[own])

    began = time.process_time()
    fit = fit_jointly(model, [part("train")])
    print(
        f"Silverbox: {effects.replace('_', ' ')}; {time.process_time() - began:.0f} s of CPU; {fit.message}"
    )
    for name, value, error in zip(fit.free, fit.values, fit.standard_errors, strict=True):
        print(f"    {name:20} {value:.6g} ± {error:.2g}")
    print(f"    {'train':26} RMSE {1e3 * fit.rms:.3f} mV")
    for name in list(SILVERBOX)[1:]:
        begun = fit_jointly(
            model, [part(name, FIRST)], guess=fit.model, seen=False, grown=False, fixed=fit.model.values
        ).only
        whole, seen = part(name)
        error = (
            simulate(begun.model, whole, begun.release_angle, begun.release_velocity)[FIRST:] - seen[FIRST:]
        )
        print(
            f"    {name:26} RMSE {1e3 * np.sqrt(np.mean(error**2)):.3f} mV, largest {1e3 * np.abs(error).max():.2f} mV"
        )


# ---- EMPS: a carriage on a screw; the motor's force drives it, friction stops it, nothing pulls it back ----

EMPS_FIRST = 20
NO_SPRING = 1e-3  # rad/s; a carriage is a pendulum whose pull takes hours
CARRIAGE = {
    "viscous_force": {"torque": "-b*thetadot", "parameters": {"b": {"unit": "1/s"}}},
    "one_way_force": {"torque": "-b*abs(thetadot)", "parameters": {"b": {"unit": "1/s"}}},
    "place_friction": {"torque": "-c*theta*sign(thetadot)", "parameters": {"c": {"unit": "1/s^2"}}},
    "place_friction_2": {"torque": "-c*theta**2*sign(thetadot)", "parameters": {"c": {"unit": "1/s^2"}}},
}
PUBLISHED = {
    "M": 95.1089,
    "Fv": 203.5034,
    "Fc": 20.3935,
    "OF": -3.1648,
}  # by their publishers: kg, N s/m, N, N
LAWS = {
    "Coulomb, viscous, offset (their law)": "viscous_force+constant_coulomb+constant_torque",
    "and another viscous force each way": "viscous_force+one_way_force+constant_coulomb+constant_torque",
    "and friction that changes along the screw": "viscous_force+one_way_force+place_friction+place_friction_2+constant_coulomb+constant_torque",
}


def emps(folder):
    known = catalogue(CARRIAGE)
    records = []
    for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"):
        found = scipy.io.loadmat(opened(folder, name))
        times, place = found["t"].ravel(), found["qm"].ravel()
        start = np.polyfit(times[:EMPS_FIRST] - times[0], place[:EMPS_FIRST], 3)[::-1]
        records.append((times, place, start[:2], drive(times, found["vir"].ravel(), "torque", "line")))
    gain = float(found["gtau"].item())  # N for one unit of the input
    (times, place, start, under), test = records

    def missed(model, record):
        times, place, start, under = record
        return 1e3 * (simulate(model.driven_by(under), times, *start) - place)[EMPS_FIRST:]  # mm

    def told(model, name):
        train, off = missed(model, records[0]), missed(model, test)
        spread = 1e3 * np.std(test[1])
        print(
            f"    {name:44} train {np.sqrt(np.mean(train**2)):.2f} mm, test {np.sqrt(np.mean(off**2)):.2f} mm, R² {1 - np.mean(off**2) / spread**2:.4f}"
        )

    print("EMPS: position simulated from the measured force alone, over 25 s")
    mass = PUBLISHED["M"]
    bare = Model(f"{next(iter(LAWS.values()))}+{under.effect}", {}, {}, "linear", "consistent", known)
    theirs = {
        "natural_frequency": NO_SPRING, "viscous_force_b": PUBLISHED["Fv"] / mass, "constant_friction": PUBLISHED["Fc"] / mass,
        "constant_torque": -PUBLISHED["OF"] / mass, "torque_gain": gain / mass,
    }  # fmt: skip
    told(bare.with_values(theirs), "the publishers' values, simulated here")
    for name, label in LAWS.items():
        model = Model(f"{label}+{under.effect}", {}, {}, "linear", "consistent", known)
        free = [one for one in model.parameters if one != "natural_frequency"]

        def residuals(x, model=model, free=free):
            values = dict(zip(free, x, strict=True)) | {"natural_frequency": NO_SPRING}
            try:
                seen, slopes = sensitivities(
                    model.with_values(values).driven_by(under), times, *start, free=free
                )
            except TrajectoryError:
                return np.full(times.size, np.inf), np.zeros((times.size, len(free)))
            return seen - place, slopes.T

        began = time.process_time()
        found = least_squares(residuals, [theirs.get(one, 0.0) for one in free], most=100, tolerance=1e-9)
        values = dict(zip(free, map(float, found.x), strict=True)) | {"natural_frequency": NO_SPRING}
        told(model.with_values(values), name)
        print(
            f"        mass {gain / values['torque_gain']:.2f} kg, {time.process_time() - began:.0f} s of CPU"
        )


# ---- Equations that others published ----

TERMS = {
    "x": "-k*theta", "sin x": "-k*sin(theta)", "x^2": "-k*theta**2", "x^3": "-k*theta**3", "x cos x": "-k*theta*cos(theta)", "1": "k",
    "v": "-k*thetadot", "v|v|": "-k*thetadot*abs(thetadot)", "v^3": "-k*thetadot**3", "x^2 v": "-k*theta**2*thetadot", "x v": "-k*theta*thetadot",
    "cos x v": "-k*cos(theta)*thetadot",
}  # fmt: skip
NO_PULL = {
    "natural_frequency": 1.0,
    "no_pull_c": 1.0,
}  # a spring, and what takes it away: every term is then one of the library
OWN = {"no_pull": {"torque": "c*omega_n**2*theta", "parameters": {"c": {"unit": "1"}}}}
OWN |= {
    f"t{k}": {"torque": term, "parameters": {"k": {"unit": "1"}}} for k, term in enumerate(TERMS.values())
}
NAMES = dict(zip(TERMS, list(OWN)[1:], strict=True))
TRUE = {
    24: "x", 25: "x+v", 28: "sin x", 32: "x+x^3+v", 36: "sin x+v+cos x v", 37: "x+v+x^2 v", 40: "x+v+x^2 v", 43: "1+sin x+v", 44: "1+sin x+v|v|",
}  # fmt: skip
OSCILLATOR_1 = "sin x+v^3+x^3+x v+x cos x"
NOISES = (
    0.0,
    0.01,
    0.02,
    0.03,
    0.04,
    0.05,
)  # of ODEBench: each value times (1 + noise times a normal deviate)
SOLVED = (
    1e-4  # of a swing's range: what the solver of the published swings left, as the published constants show
)
MOST_TERMS, FITTED, WEIGHED = (
    3,
    40,
    40,
)  # of an equation; structures of a size that are fitted; those that are weighed
WORTH = 10.0  # of BIC, less is a tie


def _columns(times, angle):
    """What each term's bump-weighed sums are, those of the acceleration, and how far each of these is off where the noise is in proportion
    to the value: a linear least squares problem in the sizes."""
    even = np.linspace(times[0], times[-1], times.size)
    x = np.interp(even, times, angle)
    width = 24
    at = np.linspace(-1.0, 1.0, 2 * width + 1)
    bump = np.polynomial.Polynomial([1.0, 0.0, -1.0]) ** 6
    scale = width * (even[1] - even[0])
    kernels = [bump(at), bump.deriv()(-at) / scale, bump.deriv(2)(-at) / scale**2]

    def weighed(values, order=0):
        return np.convolve(values, kernels[order], "valid")[::4]

    smooth = np.convolve(x, bump(at) / bump(at).sum(), "same")
    v = np.gradient(smooth, even)
    integrals = {"v": x, "x^2 v": x**3 / 3, "x v": x**2 / 2, "cos x v": np.sin(x)}
    plain = {
        "x": x,
        "sin x": np.sin(x),
        "x^2": x**2,
        "x^3": x**3,
        "x cos x": x * np.cos(x),
        "v|v|": v * np.abs(v),
        "v^3": v**3,
    }
    found = {name: -weighed(values) for name, values in plain.items()} | {"1": weighed(np.ones_like(x))}
    found |= {name: weighed(values, 1) for name, values in integrals.items()}
    return found, weighed(x, 2), np.sqrt(np.convolve(x**2, kernels[2] ** 2, "valid")[::4])


def _release(times, angle):
    """Angle and velocity at the first sample, of a cubic through the first 25."""
    return np.polyfit(times[:25] - times[0], angle[:25], 3)[:1:-1]


def _law(swings, most):
    """The structures that were fitted with their BIC, best first; the sizes by term of each."""
    seen = [_columns(*swing) for swing in swings]
    off = np.concatenate([error for *_, error in seen])
    matrix = {name: np.concatenate([columns[name] for columns, *_ in seen]) / off for name in TERMS}
    wanted = np.concatenate([right for _, right, _ in seen]) / off
    ranked = []
    for size in range(1, most + 1):
        for chosen in combinations(TERMS, size):
            block = np.array([matrix[name] for name in chosen]).T
            sizes, *_ = np.linalg.lstsq(block, wanted, rcond=None)
            left = float(np.sum((block @ sizes - wanted) ** 2))
            ranked.append((wanted.size * np.log(left + 1e-30) + size * np.log(wanted.size), chosen, sizes))
    ranked.sort(key=lambda one: one[0])
    kept = [one for k in range(1, most + 1) for one in [r for r in ranked if len(r[1]) == k][:FITTED]]
    known, found = catalogue(OWN), []
    for _, chosen, sizes in kept:
        label = "+".join(["no_pull", *(NAMES[name] for name in chosen)])
        model = Model(label, {}, {}, "linear", "consistent", known)
        values = {f"{NAMES[name]}_k": float(size) for name, size in zip(chosen, sizes, strict=True)} | NO_PULL
        try:
            fit = fit_jointly(
                model,
                swings,
                guess=Begin(model, tuple(SwingStart(values, *_release(*swing)) for swing in swings)),
                seen=False,
                grown=False,
                fixed=NO_PULL,
                most=40,
            )
        except (TrajectoryError, InputError, np.linalg.LinAlgError):
            continue
        found.append((_evidence(fit), "+".join(chosen), fit))
    return sorted(found, key=lambda one: one[0])


class Weighed:
    """A structure under the noise that ODEBench adds: each value times (1 + sigma times a normal deviate), and what the solver left.

    ``evidence`` is BIC of the largest likelihood, ``left`` the residuals over their standard deviations, ``noise`` whether more is left than by
    the solver.
    """

    def __init__(self, fit, swings):
        self.model, self.swings = fit.model, swings
        self.free = [name for name in fit.model.parameters if name not in NO_PULL]
        self.seen = np.concatenate([angle for _, angle in swings])
        self.solved = SOLVED * np.ptp(self.seen)
        at = [fit.model.values[name] for name in self.free]
        at += [value for one in fit.swings for value in (one.release_angle, one.release_velocity)]
        best = np.inf
        for _ in range(6):  # the standard deviations are those of the fit before
            angle, _ = self._motion(at)
            deviation, misfit = self._noise(angle)
            if misfit > best - 0.01:
                break
            best, self.left = misfit, (self.seen - angle) / deviation
            self.noise = np.std(self.seen - angle) > 3 * self.solved
            at = least_squares(partial(self._residuals, deviation), at, most=40, tolerance=1e-8).x
        self.evidence = best + len(at) * np.log(self.seen.size)

    def _motion(self, at):
        """The angles of all swings, and their slopes by each free value."""
        count = len(self.free)
        model = self.model.with_values(NO_PULL | dict(zip(self.free, map(float, at[:count]), strict=True)))
        names = [*self.free, "release_angle", "release_velocity"]
        slopes, angles, first = np.zeros((self.seen.size, len(at))), [], 0
        for k, (times, _) in enumerate(self.swings):
            release = count + 2 * k
            angle, rows = sensitivities(model, times, *map(float, at[release : release + 2]), free=names)
            own = slice(first, first + times.size)
            slopes[own, :count], slopes[own, release : release + 2] = rows[:count].T, rows[count:].T
            angles.append(angle)
            first += times.size
        return np.concatenate(angles), slopes

    def _noise(self, angle):
        """The standard deviation of each value for the most likely sigma, and -2 log of that likelihood."""
        square = (self.seen - angle) ** 2

        def misfit(sigma):
            variance = (sigma * angle) ** 2 + self.solved**2
            return float(np.sum(square / variance + np.log(variance)))

        found = minimize_scalar(misfit, bounds=(0.0, 0.5), method="bounded")
        return np.hypot(found.x * angle, self.solved), found.fun

    def _residuals(self, deviation, at):
        try:
            angle, slopes = self._motion(at)
        except (TrajectoryError, InputError):
            return np.full(self.seen.size, np.inf), np.zeros((self.seen.size, len(at)))
        return (angle - self.seen) / deviation, slopes / deviation[:, None]


def _evidence(fit):
    """BIC, with what the solver of the published swings leaves of every value beside the noise: the order in which structures are weighed."""
    range_of = np.ptp(np.concatenate([one.angle for one in fit.swings]))
    rss = fit.rss + fit.n * (SOLVED * range_of) ** 2
    return fit.n * np.log(rss / fit.n) + len(fit.free) * np.log(fit.n)


def _weighed(found, swings):
    """The structures with most evidence as (evidence, label, ``Weighed``), anew under the noise as it is, best first."""
    again = []
    for _, label, fit in found[:WEIGHED]:
        try:
            one = Weighed(fit, swings)
        except (TrajectoryError, InputError, np.linalg.LinAlgError):
            continue
        again.append((one.evidence, label, one))
    return sorted(again, key=lambda one: one[0])


def _told(found, truth):
    """What comes of it, and the structures with fewest terms of those whose evidence is as good as the best.

    ``recovered``: the true one alone; ``tied``: it and others with as many terms; ``part``: every term of one is there, and what lacks is not
    seen; ``refused``: what the best leaves is no white noise (its first autocorrelation), so no law is named; else ``wrong``.
    """
    if not found:
        return "refused", ""
    best, _, first = found[0]
    left = first.left
    if first.noise and float(left[1:] @ left[:-1]) / float(left @ left) > 4 / np.sqrt(left.size):
        return "refused", ""
    tied = [one for evidence, one, _ in found if evidence - best < WORTH]
    fewest = min(one.count("+") for one in tied)
    simplest = [one for one in tied if one.count("+") == fewest]
    true, sets = set(truth.split("+")), [set(one.split("+")) for one in simplest]
    if true in sets:
        return ("recovered" if len(sets) == 1 else "tied"), " or ".join(simplest)
    return ("part" if any(one < true for one in sets) else "wrong"), " or ".join(simplest)


def equations(folder):
    systems = {one["id"]: one for one in json.loads(opened(folder, "strogatz_extended.json").read_text())}
    print(
        "Equations: twelve terms, at most three of them, by trajectories; both swings of a system, noise as ODEBench adds it"
    )
    for number, truth in TRUE.items():
        line = []
        for noise in NOISES:
            rng = np.random.default_rng(number)
            swings = [
                (np.array(one["t"]), np.array(one["y"][0]) * (1 + noise * rng.standard_normal(len(one["t"]))))
                for one in systems[number]["solutions"][0]
            ]
            verdict, label = _told(_weighed(_law(swings, MOST_TERMS), swings), truth)
            line.append(f"{noise:g} {verdict}" + (f" ({label})" if verdict != "recovered" else ""))
        print(f"    {number}: {truth:16} {'; '.join(line)}", flush=True)
    data = np.loadtxt(opened(folder, "osc1_train.csv"), delimiter=",", skiprows=1)
    swing = (50.0 / 24999 * np.arange(len(data))[::10], data[::10, 0])
    verdict, label = _told(_weighed(_law([swing], 5), [swing]), OSCILLATOR_1)
    print(f"    LLM-SR oscillator 1: {OSCILLATOR_1}: {verdict} ({label})")


if __name__ == "__main__":
    where, asked = sys.argv[1], sys.argv[2:] or ["silverbox", "emps", "equations"]
    for name in asked:
        {"silverbox": silverbox, "emps": emps, "equations": equations}[name](where)
