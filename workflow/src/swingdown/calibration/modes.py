"""The three modes of uncertainty, and the points for which they do not agree."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from ..errors import InputError
from ..measurement.apparatus import Apparatus, encoder_limit
from ..measurement.straight_line import fit_line
from ..measurement.uncertainty import Mean, draw_inputs, propagate_gum, symmetric_interval
from .chain import Chain, lengths
from .geometry import printed_bound

MODES = ("paper", "gum", "monte-carlo")
COVERAGE = 0.95
DISAGREEMENT = 0.1  # of a standard uncertainty, between the ends of the GUM's and of Monte Carlo's intervals
REFUSED_ABOVE = 0.01  # probability that the lengths say the drop is longer than the arm
_GRID = 81
_BLOCK = 8


def judge(apparatus: Apparatus, draws: int, seed: int) -> SimpleNamespace:
    """For each point: its angle, u by first order and by Monte Carlo, how far they differ, flags and refusals.

    Parameters
    ----------
    apparatus
        As ``read_apparatus`` returns it.
    draws, seed
        Of the Monte-Carlo mode.
    """
    inputs, angles = lengths(apparatus)
    first = propagate_gum(angles, inputs)
    drawn = angles(draw_inputs(inputs, draws, [seed, 1]))
    impossible = np.isnan(drawn).mean(axis=1)
    reasons, refused, ends, spread = [], [], [], []
    for k in range(len(drawn)):
        real = drawn[k][~np.isnan(drawn[k])]
        low, high = symmetric_interval(real, COVERAGE) if len(real) else (np.nan, np.nan)
        half = first.expanded(COVERAGE)[k]
        u = first.standard_uncertainty[k]
        ends.append(max(abs(first.value[k] - half - low), abs(first.value[k] + half - high)) / u)
        spread.append(real.std(ddof=1) if len(real) > 1 else np.nan)
        reason = []
        if impossible[k] > 0:
            reason.append(f"the drop is longer than the arm in {impossible[k]:.2%} of draws")
        if not ends[-1] <= DISAGREEMENT:
            reason.append(f"GUM and Monte Carlo intervals differ by {ends[-1]:.2g} u")
        refused.append(bool(impossible[k] > REFUSED_ABOVE or not np.isfinite(u)))
        reasons.append(", ".join(reason) + (": left out of the line" if refused[-1] else ""))
    return SimpleNamespace(
        angle=first.value,
        gum=first.standard_uncertainty,
        correlation=first.covariance / np.outer(first.standard_uncertainty, first.standard_uncertainty),
        monte_carlo=np.array(spread),
        impossible=impossible,
        disagreement=np.array(ends),
        refused=refused,
        reasons=reasons,
    )


def paper(apparatus: Apparatus, chain: Chain, still: Mean | None) -> SimpleNamespace:
    """Limits as they are: York's line with limits for standard deviations, its zero, Eq. 11 in absolute form."""
    x, y = chain.voltages(chain.values), chain.angles(chain.values)
    lengths = chain.values[:4]
    limits = [i.limit for i in chain.inputs[:4]]
    heights = [(p["height"], p["limit"]) for p in apparatus["points"]]
    bounds, worst = (
        np.array([printed_bound(lengths, limits, *height, signed) for height in heights])
        for signed in (True, False)
    )
    volts = encoder_limit(apparatus, x)
    line = fit_line(x, y, volts, bounds)
    zero, u_zero = line.inverse(0.0)
    covariance = np.zeros((3, 3))
    covariance[:2, :2] = line.covariance
    gradient = np.array([-1 / line.slope, -zero / line.slope])  # of the zero: -intercept / slope
    covariance[2, :2] = covariance[:2, 2] = line.covariance @ gradient
    covariance[2, 2] = u_zero**2
    rest = float(zero) if still is None else still.value
    return SimpleNamespace(
        line=line,
        values=[line.intercept, line.slope, rest],
        covariance=covariance,
        factor=1.0,
        dof=np.inf,
        boxes=(volts, bounds),
        worst=worst,
    )


def gum(chain: Chain) -> SimpleNamespace:
    propagation = propagate_gum(chain, chain.inputs)
    volts, angles = (np.sqrt(np.diag(c)) for c in chain.covariance_of_points)
    factor = propagation.expanded(COVERAGE)[-1] / propagation.standard_uncertainty[-1]
    return SimpleNamespace(
        line=chain.line,
        values=propagation.value[:3],
        covariance=propagation.covariance[:3, :3],
        factor=float(factor),
        dof=float(propagation.dof[-1]),
        boxes=(volts, angles),
        propagation=propagation,
    )


def monte_carlo(chain: Chain, apparatus: Apparatus, noise: float, draws: int, seed: int) -> SimpleNamespace:
    """The line with all inputs drawn once a draw (JCGM 101).

    Draws whose drop is longer than the arm are impossible and left out, and counted.

    Parameters
    ----------
    chain
        From lengths and voltages to the line, as ``chain.measurement`` returns it.
    apparatus
        As ``read_apparatus`` returns it.
    noise
        Standard deviation of a single sample, in V.
    draws, seed
        How many, and of the random numbers.

    Raises
    ------
    InputError
        If most draws of the lengths are impossible.
    """
    drawn = draw_inputs(chain.inputs, draws, [seed, 2])
    angles = chain.angles(drawn)
    possible = ~np.isnan(angles).any(axis=0)
    if possible.sum() < draws / 2:
        problem = "most draws of the lengths are impossible"
        raise InputError(apparatus["path"], problem, "lengths that fit together", "measure them again")
    drawn = drawn[:, possible]
    outputs = chain(drawn)
    intercept, slope, rest = outputs[:3]
    generator = np.random.Generator(np.random.PCG64([seed, 3]))
    unit, white = generator.uniform(-1, 1, slope.size), noise * generator.standard_normal(slope.size)
    top = apparatus["encoder"]["limits"][-1]["up_to"]
    volts = np.linspace(0 if rest.mean() > top / 4 else -top, top, _GRID)
    limits = encoder_limit(apparatus, volts)
    columns = []
    for block in np.array_split(np.arange(_GRID), _GRID // _BLOCK):
        total = slope * (volts[block, None] + limits[block, None] * unit + white - rest)
        low, high = symmetric_interval(total, COVERAGE)
        columns.append(np.array([total.mean(axis=1), total.std(axis=1, ddof=1), low, high]))
    grid = np.concatenate(columns, axis=1)
    volts_box, angle_box = chain.voltages(drawn).std(axis=1, ddof=1), angles[:, possible].std(axis=1, ddof=1)
    middle, tilt = float(intercept.mean()), float(slope.mean())
    line = replace(chain.line, intercept=middle, slope=tilt, covariance=np.cov(outputs[:2]))
    ratio = (grid[3] - grid[2]) / 2 / grid[1]
    return SimpleNamespace(
        line=line, values=outputs[:3].mean(axis=1), covariance=np.cov(outputs[:3]), factor=float(np.median(ratio)),
        dof=np.inf, boxes=(volts_box, angle_box), grid_voltage=volts, grid=grid, left_out=1 - possible.mean(),
    )  # fmt: skip
