"""Single terms ranked in the weak form: the equation of motion under test functions, so that no noisy angle is differentiated.

With a test function w that vanishes outside a window, the integral of w theta'' is that of w'' theta, and the integral of
w thetadot is minus that of w' theta. The equation of motion is then linear in its coefficients; the base model's three are
fitted, alone and with one more term at a time, and the terms are ranked by BIC (Messenger and Bortz, Multiscale Model.
Simul. 19, 1474 (2021); the weights are those of Bortz, Messenger and Dukic, Bull. Math. Biol. 85, 110 (2023)).
"""

import numpy as np
from campaigns import period
from scipy.linalg import cholesky, solve_triangular
from scipy.signal import savgol_filter
from terms import Point, load_coulomb, plain, shaped

MARGIN = 10.0  # of BIC: a term that does not better the base by it is not named
WIDTH = 0.18  # half of a test function's window, in periods: longer ones wash out what happens within a swing
OVERLAP = 4  # test functions in half a window; closer ones add nothing but cost
POWER = 6  # of (1 - s^2): smooth enough at the window's ends for two derivatives under the trapezoidal rule
SMOOTH, ORDER = (
    0.4,
    5,
)  # window of the local polynomial behind the terms beyond the base (periods), and its order
LOUD = 40.0  # a window in which the angle moves by less than so many times the noise tells no direction of motion
LINES = (0.2, 8.0)  # Hz, in which a vibration is looked for
OWN = 0.1  # Hz on either side of the pendulum's own frequency, where a drive is no name


def rank(swings, lacks=()):
    """A list of (effects a term may stand for, gain in BIC over the base), best first; inadmissible signs are left out.

    ``lacks`` names effects that are not in the catalogue.
    """
    system = System(swings)
    found = {}
    for term in (*plain(), *shaped()):
        if term.effects[0] not in lacks:  # the library has terms, and only then names for them
            gain = system.gain(system.column(term.columns), term.shapes, term.sign)
            names = tuple(name for name in term.effects if name not in lacks)
            found[names] = max(gain, found.get(names, -np.inf))
    if "base_vibration" not in lacks:
        found[("base_vibration",)] = system.vibration()
    return sorted(found.items(), key=lambda one: -one[1])


def named(swings, lacks=()):
    """The effects that the best term may stand for, in a list; an empty one where the base alone does."""
    names, gain = rank(swings, lacks)[0]
    return [names] if gain > MARGIN else []


class System:
    """The base model's equation of motion under the test functions of all swings, weighted by the noise that reaches each."""

    def __init__(self, swings):
        length = np.median([period(*one) for one in swings])
        self.swings = [_Windows(*one, length) for one in swings]
        self.frequency = 1 / length
        for omega2, viscous in self._starts(length):
            for one in self.swings:
                one.weigh(omega2, viscous)
            target = self._stack(lambda one: one.second @ one.angle)
            base = np.column_stack(
                [
                    self._stack(lambda one: -(one.zeroth @ np.sin(one.angle))),
                    self._stack(lambda one: one.first @ one.angle),  # of -2 zeta omega thetadot
                    self.column(load_coulomb),
                ]
            )
            self.base = np.linalg.qr(base)[0]
            self.coefficients = np.linalg.lstsq(base, target)[0]
            self.left = target - self.base @ (self.base.T @ target)
        self.alone = self._bic(self.left @ self.left, 3)

    def _starts(self, length):
        """First by the period alone, then by the coefficients found so."""
        yield (2 * np.pi / length) ** 2, 0.0
        yield self.coefficients[0], self.coefficients[1]

    def _stack(self, one_swing):
        return np.concatenate([one.weighted(one_swing(one)) for one in self.swings])

    def _bic(self, squares, count):
        n = self.left.size
        return n * np.log(squares / n) + count * np.log(n)

    def column(self, torque):
        """The column (or columns) of a torque."""
        return self._stack(lambda one: one.zeroth @ torque(one.point))

    def gain(self, columns, shapes=0, sign=0):
        """By how much the base's BIC is above that with these columns; minus infinity where the coefficient's sign is inadmissible."""
        columns = columns.reshape(self.left.size, -1)
        beside = columns - self.base @ (self.base.T @ columns)
        size = np.linalg.norm(beside, axis=0)
        if size.min() < 1e-9 * np.linalg.norm(columns, axis=0).max():
            return -np.inf  # the base says the same
        coefficients, *_ = np.linalg.lstsq(beside / size, self.left)
        if sign and sign * coefficients[0] < 0:
            return -np.inf
        rest = self.left - beside / size @ coefficients
        return self.alone - self._bic(rest @ rest, 3 + columns.shape[1] + shapes)

    def vibration(self):
        """The largest gain of a vibration of one frequency, with a phase and an amplitude in each swing."""
        step = 0.5 / max(one.point.duration for one in self.swings)
        lines = np.arange(*LINES, step)
        lines = lines[np.abs(lines - self.frequency) > OWN]
        parts, start = [], 0
        for one in self.swings:
            turns = 2 * np.pi * np.outer(one.point.t, lines)
            shaken = np.cos(one.point.theta)[:, None]
            both = np.stack(
                [one.weighted(one.zeroth @ (shaken * wave(turns))) for wave in (np.cos, np.sin)], axis=-1
            )
            parts.append((slice(start, start + both.shape[0]), both))
            start += both.shape[0]
        best = -np.inf
        for k in range(lines.size):
            columns = np.zeros((self.left.size, 2 * len(parts)))
            for number, (where, both) in enumerate(parts):
                columns[where, 2 * number : 2 * number + 2] = both[:, k]
            best = max(best, self.gain(columns, 1))
        return best


class _Windows:
    """One swing under its test functions: the matrices that integrate against them and their derivatives, and weights."""

    def __init__(self, times, angle, length):
        step = times[1] - times[0]
        self.angle = angle
        samples = 2 * int(SMOOTH * length / step / 2) + 1
        smooth = savgol_filter(angle, samples, ORDER)
        velocity = savgol_filter(angle, samples, ORDER, deriv=1, delta=step)
        self.noise = np.sqrt(np.mean((angle - smooth) ** 2))
        self.point = Point(smooth, velocity, times, times[-1], 2 * np.pi / length)
        half = max(int(WIDTH * length / step), 4)
        centres = np.arange(half, angle.size - half, max(half // OVERLAP, 1))
        travel = np.array([np.ptp(smooth[c - half : c + half + 1]) for c in centres])
        centres = centres[travel > LOUD * self.noise]
        s = np.arange(-half, half + 1) / half
        q, width = 1 - s * s, half * step
        shapes = (
            q**POWER,
            -2 * POWER * s * q ** (POWER - 1) / width,
            (4 * POWER * (POWER - 1) * s * s * q ** (POWER - 2) - 2 * POWER * q ** (POWER - 1)) / width**2,
        )
        self.zeroth, self.first, self.second = (np.zeros((centres.size, angle.size)) for _ in range(3))
        for matrix, shape in zip((self.zeroth, self.first, self.second), shapes, strict=True):
            for k, c in enumerate(centres):
                matrix[k, c - half : c + half + 1] = shape * step

    def weigh(self, omega2, viscous):
        """Take the weights from the noise that reaches the equation at these coefficients, to first order and white."""
        self.point = self.point._replace(omega=np.sqrt(max(omega2, 1e-6)))
        reach = self.second + omega2 * self.zeroth * np.cos(self.point.theta) - viscous * self.first
        covariance = reach @ reach.T
        covariance[np.diag_indices_from(covariance)] *= 1 + 1e-6  # windows that overlap nearly say the same
        self.root = cholesky(covariance, lower=True)

    def weighted(self, columns):
        return solve_triangular(self.root, columns, lower=True)
