"""Amplitude and time of each half-swing: how far it goes, when it passes the middle, and how well both are known."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..arrays import Floats
from ..calmed import calmed
from ..dataset import series_of
from ..errors import InputError
from ..fitting.guess import first_guess
from ..measurement.angle import UNSCALED
from ..measurement.points.points_recording import COUNTED, PASSED, are_points
from ..pendulum.catalogue import RATE
from ..pendulum.half_swings import middle_crossings, middles, steps_between
from .turning_points import turns_of

# of a half-swing on each side: a polynomial of degree 4 finds a turn to 4e-6 of it, of degree 3 a passage
_TURN, _PASS = 0.22, 0.25
_WIDEST = 0.45  # of a half-swing: how far a window reaches where there are few samples; it finds a turn to 2e-4 of it
_MORE = 2  # samples beyond the coefficients of a polynomial, so that it leaves something
_WAVE = 0.48  # of a half-swing on each side, of which a sine is fitted
_ASTRAY = 0.1  # of a half-swing: a swing that turns farther than that from its middle is no sine
_ABOVE = 5.0  # standard deviations of the noise that a swing goes beyond: the passage through the middle is then its own

_Places = NDArray[np.intp]


class HalfSwings(NamedTuple):
    """The half-swings of one recording.

    Turning points: ``number`` (half-swings since the first passage or turning point, whole), signed ``angle`` (rad) and standard
    uncertainty ``u_angle``. Marks of time: ``mark`` (s), ``u_mark``, their place ``at`` among the half-swings, and ``slope``, the signed speed
    (rad/s) with which a passage goes through the middle, infinite for turning points. ``times`` (s) of the turning points where they are
    timed. ``passages`` tells whether the marks are passages through the middle. ``scaled`` is False where the angles are in no unit of angles.
    ``centre`` is what angles of samples are told from.
    """

    recording: str
    number: Floats
    angle: Floats
    u_angle: Floats
    times: Floats
    at: Floats
    mark: Floats
    u_mark: Floats
    slope: Floats
    passages: bool
    both: bool
    scaled: bool = True
    centre: float = 0.0


def half_swings_of(data: xr.Dataset, restoring: str = "sine") -> HalfSwings:
    """The half-swings of an angle dataset, sampled or of turning points; InputError where it has too few, or holds no angle."""
    name = str(data.attrs.get("recording", "recording"))
    if are_points(data):
        return _of_points(data, name)
    series, scaled = series_of(data), data.attrs.get("mode") != UNSCALED
    times, values = data["time"].values, series.values
    if series.name == RATE:
        return _of_rate(name, times, values, restoring, scaled)
    return of_samples(name, times, values, scaled)


def of_samples(
    name: str,
    times: Floats,
    angle: Floats,
    scaled: bool = True,
    quiet: Floats | None = None,
    sine: bool = False,
) -> HalfSwings:
    """The half-swings of a sampled swing: times (s) and angle (rad), both of shape (sample,), whose scale is known if ``scaled``.

    ``quiet`` is the same swing without its noise, by which its passages and sides are told; None where it has little. With ``sine`` turns
    are told from waves through whole half-swings, where these are surer than polynomials about the turns. InputError, which names
    the recording, if there are fewer than four half-swings, or too few samples in each.
    """
    quiet = angle if quiet is None else quiet
    rough, centre = _passages(times, quiet), 0.0
    if rough.size >= 4:
        centre = _centre(times, quiet, rough)
        rough = _passages(times, quiet - centre)
    if rough.size < 4:
        problem = f"it passes its middle {rough.size} times"
        raise InputError(f"recording {name}", problem, "at least four half-swings", "record longer")
    half = np.diff(rough)
    each = float(np.median(half) / np.median(np.diff(times)))  # samples of a half-swing
    turn, through = (
        min(max(usual, (degree + 4) / (2 * each)), _WIDEST) for usual, degree in ((_TURN, 4), (_PASS, 3))
    )
    about = (rough[1:] + rough[:-1]) / 2
    ordered = np.sign(np.interp(about, times, quiet) - centre)
    centres = rough[:-1] + _where_it_turns(times, quiet - centre, rough, ordered) * half
    turns = _polynomials(times, angle, centres, turn * half, 4)
    widths = through * np.minimum(np.append(half, half[-1]), np.insert(half, 0, half[0]))
    passes = _polynomials(times, angle - centre, rough, widths, 3)
    noise = _noise(turns, passes)
    if not np.isfinite(noise):
        problem = f"only {each:.2g} samples in each half-swing"
        raise InputError(f"recording {name}", problem, "at least ten", "record with more samples a second")
    number = np.concatenate([[0], np.cumsum(steps_between(half))])
    if sine:
        waves = _waves(times, angle, centres, half)
        surer = np.nanmedian(waves.vertex(_noise(waves))[2]) < np.nanmedian(turns.vertex(noise)[2])
        turns = waves if surer else turns
    place, size, u_size = turns.vertex(noise)
    at, u_at, slope = passes.root(noise)
    single = np.diff(number) == 1
    told = np.isfinite(size) & single
    loud = told & (np.abs(size - centre) > _ABOVE * noise) & (ordered * (size - centre) > 0)
    lost = told & ~loud
    last = int(np.argmax(lost)) if lost.any() else loud.size
    loud[last:] = False  # what comes after the first that is lost in the noise is chosen by the noise
    passed = np.isfinite(at)
    passed[last + 1 :] = False
    # where a half-swing has hardly samples enough, those of one side may all have too few
    above = np.count_nonzero(ordered[loud] > 0)
    both = bool(min(above, np.count_nonzero(loud) - above) >= 2)
    return HalfSwings(
        name, number[:-1][loud], (size - centre)[loud], u_size[loud], place[loud], number[passed] - 0.5, at[passed], u_at[passed],
        slope[passed], True, both, scaled, centre,
    )  # fmt: skip


def _of_rate(name: str, times: Floats, rate: Floats, restoring: str, scaled: bool) -> HalfSwings:
    """The ``HalfSwings`` of angular rates: each half-swing's angle follows from its largest rate by the energy, its ends are where the rate
    is zero."""
    found = of_samples(name, times, rate, scaled, calmed(times, rate, ends_quiet=False))
    frequency = first_guess(times, rate, restoring, RATE).natural_frequency
    share = np.abs(found.angle) / frequency
    size, slope = share, np.full(share.size, 1 / frequency)
    if restoring == "sine":
        half = np.minimum(share / 2, 0.99)
        size, slope = 2 * np.arcsin(half), 1 / np.sqrt(1 - half**2) / frequency
    return found._replace(angle=np.sign(found.angle) * size, u_angle=found.u_angle * slope, passages=False)


def _of_points(data: xr.Dataset, name: str) -> HalfSwings:
    about = data.attrs
    if about["points"] == PASSED:
        raise InputError(f"recording {name}", "passages without speeds hold no amplitude", "amplitudes or samples of the motion", "record the motion itself")  # fmt: skip
    turns = turns_of(data)
    size = turns.angles.size
    if size < 5:
        told = f"{size} turning points", "at least five", "write down more of them"
        raise InputError(f"recording {name}", *told)
    even = turns.halves.astype(float)
    u_angle = turns.u_angles if np.isfinite(turns.u_angles) else max(turns.angle_step / np.sqrt(12), 1e-3 * np.abs(turns.angles).max())  # fmt: skip
    timed = about["points"] != COUNTED
    half = float(np.median(np.diff(turns.times) / np.diff(even)))
    u_time = turns.u_times if np.isfinite(turns.u_times) else max(turns.time_step / np.sqrt(12), 1e-3 * half)
    marks = even if timed else even[:0]
    return HalfSwings(
        name, even, turns.angles, np.full(size, u_angle), turns.times, marks, turns.times[: marks.size], np.full(marks.size, u_time),
        np.full(marks.size, np.inf), False, turns.both, about.get("points_unit", "rad") == "rad",
    )  # fmt: skip


def _passages(times: Floats, angle: Floats) -> Floats:
    """Times (s) at which the angle passes its middle, roughly."""
    return middle_crossings(times, angle - np.median(angle[angle.size // 2 :]))[0]


def _centre(times: Floats, angle: Floats, rough: Floats) -> float:
    """The middle (rad) that the swings have, from each three turning points in a row: decay leaves it alone."""
    bounds = times.searchsorted(rough)
    top, bottom = np.maximum.reduceat(angle, bounds)[:-1], np.minimum.reduceat(angle, bounds)[:-1]
    middle = np.median(angle[angle.size // 2 :])
    turns = np.where(top - middle > middle - bottom, top, bottom)
    return float(np.median(middles(turns))) if turns.size > 2 else float(middle)


def _where_it_turns(times: Floats, away: Floats, rough: Floats, side: Floats) -> Floats:
    """Where between two passages a swing turns, as a share: in the middle, or where it usually does on that side, if that is far from there."""
    bounds = times.searchsorted(rough)
    farthest = [
        a + int(np.argmax(np.abs(away[a:b]))) if b > a else min(a, times.size - 1)
        for a, b in pairwise(bounds)
    ]
    share, large = (times[farthest] - rough[:-1]) / np.diff(rough), np.abs(away[farthest])
    found = np.full(share.size, 0.5)
    for one in (side > 0, side < 0):
        known = one & (large > large.max() / 2)
        usual = float(np.median(share[known])) if known.any() else 0.5
        if abs(usual - 0.5) > _ASTRAY:
            found[one] = usual
    return found


class _Local(NamedTuple):
    """Polynomials through samples: coefficients (window, power) and their covariance for noise of one, centres (s), half-widths (s), what they
    leave (squares, degrees of freedom)."""

    coefficients: Floats
    covariance: Floats
    centres: Floats
    widths: Floats
    squares: Floats
    freedom: Floats

    def _value(self, at: Floats, noise: float) -> tuple[Floats, Floats]:
        powers = at[:, np.newaxis] ** np.arange(self.coefficients.shape[1])
        variance = np.einsum("ki,kij,kj->k", powers, self.covariance, powers)
        return _at(self.coefficients, at), noise * np.sqrt(np.maximum(variance, 0.0))

    def vertex(self, noise: float) -> tuple[Floats, Floats, Floats]:
        """Time (s) and value of the turn in each window, and the value's standard uncertainty; nan where there is none."""
        at = _zero(_slopes(self.coefficients))
        return self.centres + at * self.widths, *self._value(at, noise)

    def root(self, noise: float) -> tuple[Floats, Floats, Floats]:
        """Time (s) of the zero in each window, its standard uncertainty, and the slope there (a second); nan where there is none."""
        at = _zero(self.coefficients)
        slope = _at(_slopes(self.coefficients), at) / self.widths
        return self.centres + at * self.widths, self._value(at, noise)[1] / np.abs(slope), slope


def _at(coefficients: Floats, at: Floats) -> Floats:
    """The values of polynomials (window, power), each at a place of its own."""
    return np.sum(coefficients * at[:, np.newaxis] ** np.arange(coefficients.shape[1]), axis=1)


def _slopes(coefficients: Floats) -> Floats:
    return coefficients[:, 1:] * np.arange(1, coefficients.shape[1])


def _zero(coefficients: Floats) -> Floats:
    """Where these polynomials (window, power) are zero near the middle of their windows: Newton's steps; nan beyond the windows."""
    at = np.zeros(len(coefficients))
    for _ in range(6):
        with np.errstate(divide="ignore", invalid="ignore"):
            at = at - _at(coefficients, at) / _at(_slopes(coefficients), at)
        at = np.where(np.abs(at) < 1, at, np.nan)
    return at


def _windows(times: Floats, centres: Floats, widths: Floats) -> tuple[_Places, _Places, _Places]:
    """How many samples are within ``widths`` (s) of each of ``centres``; which they are, one window after the other, and the window of each."""
    first, last = times.searchsorted(centres - widths), times.searchsorted(centres + widths, "right")
    size = last - first
    inside = np.arange(int(size.sum())) - np.repeat(np.cumsum(size) - size, size) + np.repeat(first, size)
    return size, inside, np.repeat(np.arange(centres.size), size)


def _polynomials(times: Floats, values: Floats, centres: Floats, widths: Floats, degree: int) -> _Local:
    """Polynomials of that degree through the samples within ``widths`` (s) of each of ``centres``; nan where there are too few."""
    size, inside, window = _windows(times, centres, widths)
    place = (times[inside] - centres[window]) / widths[window]
    order = np.arange(degree + 1)
    powers = place ** np.arange(2 * degree + 1)[:, np.newaxis]
    taken = values[inside]
    moments = np.column_stack([np.bincount(window, one, centres.size) for one in powers])
    right = np.column_stack([np.bincount(window, one * taken, centres.size) for one in powers[: degree + 1]])
    normal = moments[:, order[:, np.newaxis] + order]
    # samples on one side alone tell no turn: a hole reaches into the window
    usable = (size >= degree + 1 + _MORE) & (np.linalg.cond(normal) < 1e8)
    found, inverse = np.full((centres.size, degree + 1), np.nan), np.full(normal.shape, np.nan)
    inverse[usable] = np.linalg.inv(normal[usable])
    found[usable] = np.einsum("kij,kj->ki", inverse[usable], right[usable])
    left = taken - np.sum(powers[: degree + 1].T * found[window], axis=1)
    squares = np.bincount(window, left**2, centres.size)
    freedom = (size - degree - 1).astype(float)
    return _Local(found, inverse, centres, widths, np.asarray(squares, dtype=float), freedom)


def _waves(times: Floats, values: Floats, centres: Floats, half: Floats) -> _Local:
    """Half-waves through the samples of each half-swing (s) as parabolas at its turn: a mean, a cosine and a sine, with a third harmonic that
    grows as the cosine's cube, as a pendulum's and a spring's do, alike in all."""
    width = _WAVE * half
    size, inside, window = _windows(times, centres, width)
    phase = np.pi * (times[inside] - centres[window]) / half[window]
    forms = np.stack([np.ones_like(phase), np.cos(phase), np.sin(phase)])
    series = values[inside], np.cos(3 * phase)

    def moments(*of: Floats) -> Floats:
        sums = [[np.bincount(window, one * form, centres.size) for one in of] for form in forms]
        return np.moveaxis(np.array(sums, dtype=float), -1, 0)

    normal = moments(*forms)
    usable = (size >= len(forms) + _MORE) & (np.linalg.cond(normal) < 1e8)
    inverse, found = np.full(normal.shape, np.nan), np.full((centres.size, 3, 2), np.nan)
    inverse[usable] = np.linalg.inv(normal[usable])
    found[usable] = inverse[usable] @ moments(*series)[usable]
    left = [one - np.sum(forms.T * found[window, :, k], axis=1) for k, one in enumerate(series)]
    known, size_of = np.isfinite(left[0]), found[:, 1, 0]
    harmonic = size_of[window] ** 3 * left[1]
    share = left[0][known] @ harmonic[known] / max(harmonic[known] @ harmonic[known], 1e-300)
    squares = np.bincount(window, (left[0] - share * harmonic) ** 2, centres.size).astype(float)
    turn = np.array([[1, 1, 0], [0, 0, np.pi * _WAVE], [0, -((np.pi * _WAVE) ** 2) / 2, 0]])
    coefficients = found[:, :, 0] @ turn.T
    # what the harmonic adds to a turn beside what mean and cosine have taken of it
    coefficients[:, 0] += share * size_of**3 * (1 - found[:, 0, 1] - found[:, 1, 1])
    return _Local(coefficients, turn @ inverse @ turn.T, centres, width, squares, (size - 3).astype(float))


def _noise(*parts: _Local) -> float:
    """The standard deviation of single samples about the polynomials; nan where none has enough."""
    kept = [np.isfinite(one.squares) for one in parts]
    freedom = sum(float(one.freedom[good].sum()) for one, good in zip(parts, kept, strict=True))
    squares = sum(float(one.squares[good].sum()) for one, good in zip(parts, kept, strict=True))
    return float(np.sqrt(squares / freedom)) if freedom > 0 else float("nan")
