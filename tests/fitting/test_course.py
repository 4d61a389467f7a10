"""The free courses of frequency and loss beside a law: what they take from a swing, and when one is worth its price."""

import itertools

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.linalg import block_diag
from scipy.special import ellipk, logsumexp

from swingdown.fitting.course import _FREQUENCIES, _LOSSES, TOLD, Courses, Free, Pieces, _beyond, _chosen

TIMES = np.arange(0, 20, 0.02)


def piece(angle):
    """The pieces of a swing that lies there as it was read."""
    slopes = np.cos(6 * TIMES)[np.newaxis]
    return Pieces(np.zeros(1, dtype=int), slopes, 0 * TIMES, np.ones(TIMES.size), angle, 0.02, 1.0)


def beside(one):
    """The free courses beside a law that follows this swing to a milliradian."""
    return Free([one], np.zeros((1, 1)), np.ones(1, dtype=bool), 1e-6 * TIMES.size)


def test_a_swing_tells_its_amplitude_its_loss_and_by_how_much_a_larger_one_is_slower():
    """The frequency of an amplitude A is pi / (2 K(sin^2(A/2))) of that of small swings (Nayfeh and Mook 1979)."""
    amplitude = 0.5 * np.exp(-0.02 * TIMES)
    found = beside(piece(amplitude * np.cos(6 * TIMES))).leading
    middle = slice(100, -100)
    assert np.exp(found.level)[middle] == pytest.approx(amplitude[middle], rel=0.02)
    assert found.pace[middle] == pytest.approx(0.02, rel=0.1)
    assert found.frequency == pytest.approx(6, rel=0.01)
    frequency = 6 * np.pi / 2 / ellipk(np.sin(amplitude / 2) ** 2)
    assert found.bend[middle] == pytest.approx(np.gradient(frequency, np.log(amplitude))[middle], rel=0.05)


@pytest.mark.parametrize(
    ("of_frequency", "of_loss", "of_both", "kinds"),
    [
        (0.9, 0.9, 1.9, {(0, 0)}),
        (1.1, 0.9, 1.9, {(0, 0), (1, 0)}),
        (1.1, 1.1, 2.1, {(0, 0), (1, 0), (0, 1), (1, 1)}),
    ],
)
def test_a_course_counts_where_it_gains_more_than_its_price(of_frequency, of_loss, of_both, kinds):
    gains = np.array([[0.0, of_loss], [of_frequency, of_both]])
    assert {(f, g) for f, g, gain in _chosen(gains) if gain > 0 or (f, g) == (0, 0)} == kinds


@pytest.mark.parametrize("value", [0.0, 0.3, np.inf])
def test_a_fit_that_does_not_move_has_no_courses(value):
    with np.errstate(invalid="ignore"), pytest.raises(np.linalg.LinAlgError):
        beside(piece(np.full(TIMES.size, value)))


# A swing whose law is known in closed form, of a weight (its frequency falls by a sixteenth of its squared amplitude).
OMEGA, DECAY, SIZE, EACH, NOISE, STEP = 6.0, 0.1, 0.4, 4, 1e-3, 0.05
LONG = np.arange(0, 20, STEP)
NAMES = ["natural_frequency", "quadratic_coefficient", "viscous_ratio"]


def reading(wider=0.0, turned=0.0):
    """The swing, its amplitude's logarithm and its phase changed by so much."""
    return SIZE * np.exp(-DECAY * LONG + wider) * np.cos(OMEGA * LONG + turned)


SLOPES = np.stack([-LONG * reading(turned=np.pi / 2), reading(), LONG * reading()]) / 2


def swung(residual, kept=(True, True, True)):
    """The free courses beside that swing's law of three values, of which some are known beforehand."""
    counts = np.full(LONG.size, EACH)
    one = Pieces(np.arange(3), SLOPES, EACH * residual, counts, reading(), STEP, 1.0)
    precision = np.diag([3e4, 50.0, 2e4])
    rss = float(EACH * residual @ residual + NOISE**2 * EACH * LONG.size)
    return Free([one], precision, np.array(kept), rss), SLOPES, precision


def missed(off=2e-4):
    """Noise of pieces' means, and a frequency of small swings and a loss that the law lacks, where it is fitted."""
    level = np.log(SIZE) - DECAY * LONG
    off = off * np.exp(-(((level + 1.5) / 0.5) ** 2))
    slow = reading(turned=np.cumsum(OMEGA * off) * STEP) - reading()
    read = slow + NOISE / np.sqrt(EACH) * np.random.default_rng(0).standard_normal(LONG.size)
    return read - SLOPES.T @ np.linalg.lstsq(SLOPES.T, read, rcond=None)[0]


def test_a_course_moves_phase_and_amplitude_as_its_law_says():
    """A share f of the frequency adds the angle that it swings further; a share g of the loss takes its part of the amplitude, and by the
    smaller amplitude a weight swings faster."""
    free, _, _ = swung(missed())
    middle, step = slice(60, -60), 1e-4
    shares = np.array([np.interp(LONG, LONG, one) for one in free.basis.at(np.log(SIZE) - DECAY * LONG)])
    for k, share in enumerate(shares):
        summed = cumulative_trapezoid(share, LONG, initial=0)
        turned = OMEGA * step * summed
        wider = -DECAY * step * summed
        bend = -OMEGA * (SIZE * np.exp(-DECAY * LONG)) ** 2 / 8
        by_loss = cumulative_trapezoid(bend * wider, LONG, initial=0)
        for found, right in (
            (free.columns[0][k], (reading(turned=turned) - reading()) / step),
            (free.columns[0][free.count + k], (reading(wider, by_loss) - reading()) / step),
        ):
            assert found[middle] == pytest.approx(right[middle], abs=0.03 * np.abs(right).max() + 1e-3)


def test_a_course_is_smooth_over_the_amplitude():
    """Of random coefficients: its standard deviation is one, and half a scale on it is correlated as the Gaussian says."""
    basis = swung(missed())[0].basis
    at = np.linspace(*basis.knots[[0, -1]], 101)
    covariance = basis.at(at).T @ basis.at(at)
    right = np.exp(-(((at[:, np.newaxis] - at) / 0.5) ** 2) / 2)
    assert covariance == pytest.approx(right, abs=0.02)
    assert np.exp(basis.knots[-1]) == pytest.approx(SIZE, rel=0.05)
    assert basis.knots[0] == pytest.approx(np.log(SIZE) - DECAY * LONG[-1], abs=0.1)


@pytest.mark.parametrize("bent", [False, True])
@pytest.mark.parametrize("kept", [(True, True, True), (True, False, True)])
def test_values_and_evidence_are_those_of_the_whole_normal_distribution(kept, bent):
    """Of all residuals at once, without any of the shortcuts: their covariance with and without the courses; what is beyond first order is
    taken off where there are any."""
    free, slopes, precision = swung(missed(3e-3 if bent else 2e-4), kept)
    of, variance = np.flatnonzero(kept), NOISE**2
    if bent:
        assert free.most(variance)[1]
    values, columns = EACH * slopes[of].T, EACH * free.columns[0].T
    seen = free.pieces[0].residual
    data = seen - EACH * free.bent[0]
    prior = variance * np.linalg.inv(precision[np.ix_(of, of)])
    law = variance * EACH * np.eye(LONG.size) + values @ prior @ values.T
    design, gains = np.hstack([values, columns]), free.gains(variance)
    for f, g in ((2, 0), (0, 3), (4, 5)):
        size = np.repeat([_FREQUENCIES[f], _LOSSES[g]], free.count) ** 2
        whole = law + (columns * size) @ columns.T
        evidence = [
            -(np.linalg.slogdet(one)[1] + read @ np.linalg.solve(one, read)) / 2
            for one, read in ((whole, data), (law, seen))
        ]
        assert gains[f, g] == pytest.approx(evidence[0] - evidence[1], rel=1e-4, abs=1e-3)
        both = block_diag(prior, np.diag(size))
        weights = np.linalg.solve(whole, design @ both).T
        mean, covariance = free.posterior(_FREQUENCIES[f], _LOSSES[g], variance)
        right = weights @ data
        assert mean == pytest.approx(right, rel=1e-4, abs=1e-4 * np.abs(right).max())
        right = np.sqrt(np.diag(both - weights @ design @ both))
        assert np.sqrt(np.diag(covariance)) == pytest.approx(right, rel=1e-3)
    assert gains[0, 0] == 0


def test_values_that_the_pieces_alone_would_move_are_told():
    """Pieces too coarse for the law: their own least squares, with what is known beforehand, end elsewhere than the fit did."""
    free, slopes, precision = swung(missed() + 1e-4 * reading())
    normal = EACH * slopes @ slopes.T + precision
    assert free.start == pytest.approx(np.linalg.solve(normal, slopes @ free.pieces[0].residual))
    assert free.law == pytest.approx(np.linalg.inv(normal))


def test_what_the_courses_tell_is_the_mean_over_their_sizes():
    """By hand: weights by evidence and price, means less those of the law alone, the spread between the kinds in the covariance."""
    free, _, _ = swung(missed())
    variance, told = NOISE**2, len(TOLD)
    found = free.courses(variance)
    gains = free.gains(variance)
    kinds = [((0, 0), 0)]
    for rows, columns, price in ((range(1, 9), [0], 1), ([0], range(1, 8), 1), (range(1, 9), range(1, 8), 2)):
        kinds.append((max(itertools.product(rows, columns), key=lambda at: gains[at]), price))
    evidence = np.array([gains[at] - price for at, price in kinds])
    assert found.gain == pytest.approx(logsumexp(evidence))
    share = np.exp(evidence - found.gain)
    level, pace = free.leading.level, free.leading.pace
    at = np.interp(np.linspace(level[0] - 1, level[0], 401), level[::-1], LONG[::-1])
    last = free.basis.at(np.linspace(level[0] - 1, level[0], 401))
    means, squares = [], []
    for (f, g), _ in kinds:
        mean, covariance = free.posterior(_FREQUENCIES[f], _LOSSES[g], variance)
        mean[:3] -= free.start
        onto = np.zeros((3 + told, mean.size))
        onto[:3, :3] = np.eye(3)
        first = free.basis.at(np.array([level[0] - np.pi / OMEGA * pace[0]]))[:, 0]
        onto[4, 3 : 3 + free.count] = onto[5, 3 + free.count :] = -first
        # the time to fall by a factor e, which is longer where the loss is smaller
        onto[6, 3 + free.count :] = np.trapezoid(last, at, axis=1) / (at[0] - at[-1])
        spread = onto @ covariance @ onto.T
        spread[3, 3] += _FREQUENCIES[f] ** 2
        means.append(onto @ mean)
        squares.append(spread + np.outer(means[-1], means[-1]))
    shift = share @ np.array(means)
    covariance = np.tensordot(share, np.array(squares), 1) - np.outer(shift, shift)
    covariance[:3, :3] -= variance * free.law
    assert found.shift == pytest.approx(shift, rel=0.02, abs=1e-5)
    deviations = np.sqrt(np.abs(np.diag(covariance)))
    assert found.covariance / np.outer(deviations, deviations) == pytest.approx(
        covariance / np.outer(deviations, deviations), abs=0.05
    )
    assert found.begins == pytest.approx([0.0], abs=1e-2)


def test_values_by_name_are_put_where_the_names_are():
    shift = np.arange(1.0, 2 + 1 + len(TOLD))
    one = Courses(1.0, shift, np.outer(shift, shift), [], [])
    mean, covariance = one.over(["viscous_ratio", "natural_frequency"], NAMES)
    assert mean == pytest.approx([2, 0, 1, 3, 4, 5, 6])
    assert covariance == pytest.approx(np.outer(mean, mean))


def test_a_change_of_the_swing_is_told_beyond_first_order():
    """Of an amplitude that is wider by a share and a phase that runs on, both slowly: the change is that to first order and the rest."""
    free, _, _ = swung(missed())
    wider, turned = 0.1 + 0.01 * LONG, 0.3 - 0.02 * LONG
    first = wider * reading() + turned * reading(turned=np.pi / 2)
    found, rest = _beyond(free.leading, free.pieces[0], first, free.floor)
    middle, whole = slice(40, -40), reading(wider, turned) - reading() - first
    assert found[middle] == pytest.approx(wider[middle], abs=0.02)
    assert rest[middle] == pytest.approx(whole[middle], abs=0.15 * np.abs(whole).max())


def test_the_courses_follow_what_the_law_misses_and_no_noise():
    free, _, _ = swung(missed(3e-3))
    taken, seen = free.most(NOISE**2)
    left = (free.pieces[0].residual - taken[0]) / EACH
    assert seen and np.std(left) < 1.05 * NOISE / np.sqrt(EACH)
    assert np.std(missed(3e-3)) > 3 * NOISE / np.sqrt(EACH)
    quiet = missed(0.0)
    taken, seen = swung(quiet)[0].most(NOISE**2)
    assert not seen and np.std(taken[0] / EACH) < 0.5 * np.std(quiet)
