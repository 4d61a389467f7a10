"""pysindy's sparse regression beside the known model, in its strong and its weak form: what it selects is what it names.

The known structure (weight, viscous drag, load-dependent friction) is never thresholded: target and library are taken
less what the base explains of them, as in discrepancy modelling (Kaheman et al., IFAC-PapersOnLine 52, 574 (2019); Ebers,
Steele and Kutz, SIAM J. Appl. Dyn. Syst. 23 (2024)), so that a small effect does not compete with the weight.
"""

import warnings
from typing import NamedTuple

import numpy as np
import pysindy
from campaigns import period
from pysindy.differentiation import SmoothedFiniteDifference
from terms import Point, load_coulomb, plain, shaped

LOUD = (
    40.0  # noises by which the angle must move in a window: where it sticks there is no direction of motion
)
# Columns are normalised, so a threshold is a share of what the base leaves of the target, whatever a term's unit
THRESHOLDS = np.geomspace(0.03, 0.95, 14)
ALIKE = 0.98  # correlation beside the base, above which two columns are one term
BAGS, MOST = (
    20,
    0.6,
)  # models on swings drawn anew, and the share of them that must have a term: fewer false alarms
ORDER = 5  # of the local polynomial that smooths: pysindy's own, 3 in 11 samples, leaves the noise in
EVERY = 4  # strong form: samples much closer than the smoothing window say the same
DOMAINS, HALF, POWER = (
    150,
    0.5,
    4,
)  # weak form: test functions a swing, half their window (periods; shorter is noisier), their power
SEED = 1  # of the places of pysindy's test functions and of the swings drawn anew


class Settings(NamedTuple):
    """What differs between the forms, chosen on campaigns of another seed than the README's.

    ``smooth`` is the window of the local polynomial in periods: longer ones bend the swing, and what they bend is then named
    on nulls; shorter ones leave noise. ``ridge`` is on normalised columns, of which many are nearly alike: without it, all come
    in at once. Terms with a shape parameter, a column for each value, help the weak form alone.
    """

    terms: tuple
    smooth: float
    ridge: float


STRONG = Settings((*plain(),), 0.33, 0.02)
WEAK = Settings((*plain(), *shaped()), 0.3, 0.001)


def strong(swings, lacks=()):
    """The terms named from smoothed finite differences, each a tuple of the effects it may stand for.

    ``lacks`` names effects that are not in the catalogue.
    """
    return _named(swings, lacks, _accelerations, STRONG)


def weak(swings, lacks=()):
    """The terms named by the weak form of the velocity's equation, each a tuple of the effects it may stand for.

    ``lacks`` names effects that are not in the catalogue. The velocity is still a smoothed difference: pysindy's weak form is of
    first-order systems.
    """
    return _named(swings, lacks, _integrals, WEAK)


def _named(swings, lacks, form, settings):
    terms = [one for one in settings.terms if one.effects[0] not in lacks]
    length = np.median([period(*one) for one in swings])
    state = np.random.get_state()  # noqa: NPY002, pysindy places its test functions by this generator
    np.random.seed(SEED)  # noqa: NPY002
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of thresholds that leave no term, which is an answer here
            columns, target, owner = _system(swings, terms, length, form, settings.smooth)
            groups = _groups(columns)
            first = [0, 1, 2, *(3 + min(group) for group in groups)]
            coefficients = _selected(columns[:, first], target, owner, settings.ridge)
    finally:
        np.random.set_state(state)  # noqa: NPY002
    owners = [one for one in terms for _ in range(_width(one))]
    found = [
        _names(owners, group, value, lacks)
        for group, value in zip(groups, coefficients, strict=True)
        if value
    ]
    return list(dict.fromkeys(found))


def _groups(columns):
    """The columns beyond the base's in groups that nothing tells apart: each a dict of columns with the sign they have in it.

    Quadratic drag and constant friction, or a spring and its cube, differ by next to nothing beside the base. Left in
    together they only take each other's place; either name then counts.
    """
    beside, _ = _beside(columns, columns[:, 0])
    unit = beside / np.linalg.norm(beside, axis=0)
    alike, groups = unit.T @ unit, []
    for k in range(alike.shape[0]):
        home = next((group for group in groups if abs(alike[min(group), k]) > ALIKE), None)
        if home is None:
            groups.append({k: 1.0})
        else:
            home[k] = np.sign(alike[min(home), k])
    return groups


def _names(terms, group, coefficient, lacks):
    """The effects that a group's term may stand for: those alone whose own sign is admissible, where there is one."""
    admissible = [k for k, sign in group.items() if terms[k].sign * sign * coefficient >= 0] or [min(group)]
    return tuple(dict.fromkeys(name for k in admissible for name in terms[k].effects if name not in lacks))


def _width(term):
    one = term.columns(Point(np.zeros(2), np.zeros(2), np.zeros(2), 1.0, 1.0))
    return one.shape[1] if one.ndim == 2 else 1


def _system(swings, terms, length, form, window):
    """(columns, target, swing of each row) of all swings: the base's three columns first."""
    smooth = [_smoothed(*one, window * length) for one in swings]
    omega = _frequency(swings, smooth)
    columns, target, owner = [], [], []
    for k, ((times, angle), (state, difference)) in enumerate(zip(swings, smooth, strict=True)):
        some, values, windows = form(times, state, difference, _library(terms, times, omega), length)
        keep = _moving(windows, angle, state)
        columns.append(some[keep])
        target.append(values[keep])
        owner.append(np.full(keep.sum(), k))
    return np.concatenate(columns), np.concatenate(target), np.concatenate(owner)


def _frequency(swings, smooth):
    """The natural frequency (rad/s), which the friction's load and the added mass need: from weight and viscous drag alone."""
    inner = [
        slice(difference.smoother_kws["window_length"], -difference.smoother_kws["window_length"])
        for _, difference in smooth
    ]
    state = np.concatenate([one[k] for (one, _), k in zip(smooth, inner, strict=True)])
    acceleration = [
        np.asarray(difference._differentiate(one[:, 1:], times))[k, 0]
        for (times, _), (one, difference), k in zip(swings, smooth, inner, strict=True)
    ]
    values = np.linalg.lstsq(
        np.column_stack([-np.sin(state[:, 0]), -state[:, 1]]), np.concatenate(acceleration)
    )[0]
    return np.sqrt(max(values[0], 1.0))


def _smoothed(times, angle, window):
    """(angle and velocity as an array of two columns, the differentiation): both by pysindy."""
    samples = 2 * int(window / (times[1] - times[0]) / 2) + 1
    difference = SmoothedFiniteDifference(smoother_kws={"window_length": samples, "polyorder": ORDER})
    velocity = np.asarray(difference._differentiate(angle[:, None], times))[:, 0]
    return np.column_stack([np.asarray(difference.smoothed_x_)[:, 0], velocity]), difference


def _library(terms, times, omega):
    """pysindy's library of the base's three torques and the terms, as functions of angle, velocity and time."""

    def function(torque, part=None):
        def one(theta, thetadot, t):
            p = Point(*(np.asarray(x, dtype=float).ravel() for x in (theta, thetadot, t)), times[-1], omega)
            found = torque(p)
            return (found if part is None else found[:, part]).reshape(np.shape(theta))

        return one

    base = [lambda p: -np.sin(p.theta), lambda p: -p.thetadot, load_coulomb]
    functions = [function(torque) for torque in base]
    for one in terms:
        width = _width(one)
        functions += [function(one.columns, part if width > 1 else None) for part in range(width)]
    return pysindy.feature_library.CustomLibrary(functions)


def _accelerations(times, state, difference, library, length):
    """(columns, target, windows) of the strong form: of each row the samples that it comes from."""
    acceleration = np.asarray(difference._differentiate(state[:, 1:], times))[:, 0]
    half = difference.smoother_kws[
        "window_length"
    ]  # smoothed twice, so a whole window at each end is the ends' own
    rows = np.arange(half, times.size - half, EVERY)
    columns = np.asarray(library.fit_transform(np.column_stack([state, times])))
    return columns[rows], acceleration[rows], [slice(k - half // 2, k + half // 2 + 1) for k in rows]


def _integrals(times, state, _, library, length):
    """(columns, target, windows) of the weak form."""
    form = pysindy.WeakPDELibrary(
        function_library=library, spatiotemporal_grid=times, K=DOMAINS, H_xt=HALF * length, p=POWER
    )
    inputs = np.column_stack([state, times])
    columns = np.asarray(form.fit_transform(inputs))
    target = np.asarray(form.convert_u_dot_integral(inputs))[:, 1]
    return columns, target, [slice(one[0][0], one[0][-1] + 1) for one in form.inds_k]


def _moving(windows, angle, state):
    """Which windows the pendulum moves in by much more than the noise."""
    noise = np.sqrt(np.mean((angle - state[:, 0]) ** 2))
    return np.array([np.ptp(state[one, 0]) > LOUD * noise for one in windows], dtype=bool)


def _selected(columns, target, owner, ridge):
    """The coefficients beyond the base's three, zero where a term is not selected."""
    threshold = _threshold(columns, target, owner, ridge)
    draw, swings = np.random.default_rng(SEED), np.unique(owner)
    bags = [
        np.concatenate([np.flatnonzero(owner == k) for k in draw.choice(swings, swings.size)])
        for _ in range(BAGS)
    ]
    kept = np.mean([_support(columns[rows], target[rows], threshold, ridge) for rows in bags], axis=0) > MOST
    values, used = _fitted(columns, target, kept)
    found = np.zeros(columns.shape[1])
    found[used] = values
    return found[3:]


def _beside(columns, target):
    """(columns, target) less what the base's three columns explain of them."""
    base = np.linalg.qr(columns[:, :3])[0]
    return columns[:, 3:] - base @ (base.T @ columns[:, 3:]), target - base @ (base.T @ target)


def _support(columns, target, threshold, ridge):
    """Which columns beyond the base's STLSQ keeps of those beside it, at a threshold."""
    beside, left = _beside(columns, target)
    optimizer = pysindy.STLSQ(threshold=threshold, alpha=ridge, normalize_columns=True, max_iter=50)
    optimizer.fit(beside, left / np.linalg.norm(left))
    return optimizer.coef_[0] != 0


def _fitted(columns, target, support):
    """Coefficients of the base's columns and the selected ones by plain least squares, and which columns those are."""
    used = np.concatenate([np.ones(3, dtype=bool), support])
    return np.linalg.lstsq(columns[:, used], target)[0], used


def _threshold(columns, target, owner, ridge):
    """The largest threshold whose error on swings left out is within a standard error of the least.

    The usual rule; BIC over the same thresholds, rows taken for independent, raised more alarms.
    """
    errors = np.empty((THRESHOLDS.size, np.unique(owner).size))
    none = np.zeros(columns.shape[1] - 3, dtype=bool)
    for fold, k in enumerate(np.unique(owner)):
        fit, out = owner != k, owner == k
        values, used = _fitted(columns[fit], target[fit], none)
        alone = np.mean(
            (target[out] - columns[out][:, used] @ values) ** 2
        )  # so that swings of any size weigh the same
        known = {none.tobytes(): 1.0}
        for row, threshold in enumerate(THRESHOLDS):
            support = _support(columns[fit], target[fit], threshold, ridge)
            if support.tobytes() not in known:
                values, used = _fitted(columns[fit], target[fit], support)
                known[support.tobytes()] = (
                    np.mean((target[out] - columns[out][:, used] @ values) ** 2) / alone
                )
            errors[row, fold] = known[support.tobytes()]
    worse = errors - errors[np.argmin(errors.mean(axis=1))]
    good = worse.mean(axis=1) <= worse.std(axis=1, ddof=1) / np.sqrt(worse.shape[1])
    return THRESHOLDS[np.flatnonzero(good)[-1]]
