"""A second pendulum, to hold the engine against and to hide effects in: scipy's DOP853, equations by hand.

Nothing here is taken from the catalogue's formulas or from the engine: the physics is stated again, differently where
it can be. The support of the flexible pivot is a two-by-two linear system for both accelerations; presliding friction
is Dahl's closed form in the angle since the last turning point; play and clock are applied to samples and turning
points. The signs of the velocity and of every other kink are frozen between events, and each event is located.

Its torques, one function an effect, stand in ``torques``.
"""

from dataclasses import dataclass, field
from math import cos, exp, isfinite, pi, sin
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from swingdown.errors import InputError

from .torques import KNOWN, TORQUES, of_twin

_OF_ANGLES = {"backlash", "sensor_lag", "eccentricity", "sensor_curvature"}  # errors of an angle sensor alone
FAR = 60.0  # rad; beyond, the motion has run away


class Accuracy(NamedTuple):
    """DOP853's tolerances, and the longest step in rad of the fastest oscillation: it keeps its tolerances at the ends of the
    steps, and between them only where these are short."""

    rtol: float
    atol: float
    step: float


EXACT = Accuracy(1e-13, 1e-16, 0.3)  # to hold the engine against
BELOW_NOISE = Accuracy(1e-9, 1e-12, 1.0)  # some 1e-8 rad, in half the time


@dataclass
class Motion:
    """What the oracle saw: the reading (rad; of a gyroscope rad/s) and the side of any play it touches (-1, 0, 1) at each time, the turning
    points' times (s), and when it stuck last (s, or None)."""

    reading: np.ndarray
    reversals: list = field(default_factory=list)
    stuck_after: float | None = None
    contact: np.ndarray | None = None


class Runaway(ArithmeticError):
    """The motion leaves what a pendulum does; nothing to compare with."""


class Pendulum:
    """Accelerations of a pendulum with the named effects, the parameters given by name."""

    def __init__(
        self, effects, values, duration, restoring="sine", form="consistent", twins=None, accuracy=EXACT
    ):
        self.accuracy = accuracy
        self.on, self.p, self.duration = frozenset(effects), dict(values), duration
        self.torques = [TORQUES[name] for name in TORQUES if name in self.on]
        self.torques += [of_twin(one) for name, one in (twins or {}).items() if name in self.on]
        self.restoring, self.form = restoring, form
        self.flexible = "flexible_pivot" in self.on
        self.lagging = "sensor_lag" in self.on
        self.wound = "presliding" in self.on
        self.F_start = self.th_start = 0.0  # Dahl friction and angle at the last turning point

    def dahl(self, s, th):
        """Presliding friction torque: dF/dθ = (F_c - s F)/x_c from the last turning point, in closed form."""
        limit, angle = self.p["presliding_friction"], self.p["presliding_angle"]
        return s * limit + (self.F_start - s * limit) * exp(-s * (th - self.th_start) / angle)

    def torque(self, t, th, v, s, kinks):
        """Sum of all torques over the inertia, but for the support's; s the frozen sign of the velocity."""
        total = -(self.p["natural_frequency"] ** 2) * (sin(th) if self.restoring == "sine" else th)
        for torque in self.torques:
            total += torque(self, t, th, v, s, kinks)
        return total

    def accelerations(self, t, th, v, q, w_q, s, kinks):
        """(θ'', q'') from  (1 + m) θ'' + cosθ q'' = torque  and  µ cosθ θ'' + q'' = µ θ'² sinθ - 2 ζ2 ω2 q' - ω2² q."""
        torque = self.torque(t, th, v, s, kinks)
        mass = 1.0
        if "added_mass" in self.on:
            mass += self.p["added_mass"] * s * v / self.p["natural_frequency"]
        if not self.flexible:
            return torque / mass, 0.0
        mu, w2 = self.p["pivot_mass_ratio"], self.p["pivot_frequency"]
        support = mu * v * v * sin(th) - 2 * self.p["pivot_damping_ratio"] * w2 * w_q - w2 * w2 * q
        determinant = mass - mu * cos(th) ** 2
        of_angle, of_pivot = torque - cos(th) * support, mass * support - mu * cos(th) * torque
        return of_angle / determinant, of_pivot / determinant

    def from_rest(self, t, y, s, kinks):
        """The angular acceleration with which it leaves rest in the direction s."""
        return self.accelerations(t, y[0], 0.0, y[2], y[3], s, kinks)[0]

    def kinks(self):
        """The functions of (th, v) whose sign matters besides that of the velocity, by name."""
        found = {}
        if self.on & {"structural_damping", "quadratic_stiffness"}:
            found["angle"] = lambda th, v: th
        if "steady_wind" in self.on:
            found["wind"] = lambda th, v: v - self.p["wind_speed"]
        if "friction_patch" in self.on:
            found["patch_from"] = lambda th, v: th - self.p["patch_from"]
            found["patch_to"] = lambda th, v: th - self.p["patch_to"]
        if "soft_stop" in self.on:
            found["stop"] = lambda th, v: th - self.p["stop_from"]
        if "one_sided_drag" in self.on:
            found["side"] = lambda th, v: th
        return found

    def way_from_rest(self, t, y, came, kinks):
        """The direction in which it leaves rest, the one opposite to where it came from first; 0 where friction holds it."""
        if self.wound:  # the wound-up friction is the same whichever way it leaves
            self.th_start = y[0]
        free = {s: self.from_rest(t, y, s, kinks) for s in (1, -1)}
        for s in (-came, came) if came else ((1, -1) if free[1] + free[-1] >= 0 else (-1, 1)):
            if s * free[s] > 0:
                return s
        return 0


def _first_event(pendulum, t, y, end, s, kinks, samples):
    """One smooth piece: values at samples before its end, time and state at the end, and what ended it."""
    p = pendulum
    switch = p.kinks()
    lag = p.p.get("lag_time", 1.0)

    def moving(time, state):
        th, v, q, w_q, reading = state.tolist()
        a, b = p.accelerations(time, th, v, q, w_q, s, kinks)
        return [v, a, w_q, b, (th - reading) / lag if p.lagging else 0.0]

    def held(time, state):
        th, _, q, w_q, reading = state.tolist()
        if not p.flexible:
            return [0.0, 0.0, 0.0, 0.0, (th - reading) / lag if p.lagging else 0.0]
        w2 = p.p["pivot_frequency"]
        b = -2 * p.p["pivot_damping_ratio"] * w2 * w_q - w2 * w2 * q
        return [0.0, 0.0, w_q, b, (th - reading) / lag if p.lagging else 0.0]

    def turning(time, state):
        return s * state[1] if time > t + 1e-8 else 1.0

    def freed(time, state):
        up, down = (p.from_rest(time, state, way, kinks) for way in (1, -1))
        return max(up, -down)

    def crossing(name):
        return lambda time, state: kinks[name] * switch[name](state[0], state[1]) if time > t + 1e-8 else 1.0

    def away(time, state):
        return FAR - abs(state[0])

    events = [turning, *map(crossing, switch), away] if s else [freed]
    for event in events:
        event.terminal, event.direction = True, -1 if s else 1
    frequency = max(
        p.p["natural_frequency"],
        p.p.get("pivot_frequency", 0.0),
        2 * pi * p.p.get("vibration_frequency", 0.0),
        0.3 / lag if p.lagging else 0.0,
    )
    rtol, atol, step = p.accuracy
    done = solve_ivp(
        moving if s else held, (t, end), y, method="DOP853", rtol=rtol, atol=atol, max_step=step / frequency,
        events=events, dense_output=True,
    )  # fmt: skip
    if done.status < 0 or not np.all(np.isfinite(done.y[:, -1])) or abs(done.y[0, -1]) > 0.99 * FAR:
        raise Runaway(done.message)
    ended = next((k for k, found in enumerate(done.t_events) if found.size), None)
    last = done.t[-1]
    inside = samples[(samples >= t) & (samples <= last)]
    found = done.sol(inside)[[0, 4, 1]] if inside.size else np.empty((3, 0))
    return found, last, done.y[:, -1], ended, list(switch)


def trajectory(  # noqa: PLR0913
    effects,
    values,
    times,
    release_angle,
    release_velocity=0.0,
    restoring="sine",
    form="consistent",
    most=4000,
    twins=None,
    reading="angle",
    accuracy=EXACT,
):
    """The ``Motion`` of a pendulum with these effects (names) and values (by parameter name), release at times[0].

    ``twins`` holds, by name, the torques of effects that are not written here (``Effect.twin``). InputError for an effect
    that is in neither place: what a trial leaves out in silence would be looked for in vain. ``reading`` is ``angle`` or
    ``rate``: what the sensor reads; one of rates has neither play, lag, eccentricity nor curvature. ``accuracy`` is ``EXACT`` or
    ``BELOW_NOISE``.
    """
    effects = tuple(effects)
    if unknown := [name for name in effects if name not in KNOWN and name not in (twins or {})]:
        problem = "the second pendulum does not know it"
        raise InputError(f"effect {unknown[0]!r}", problem, ", ".join(sorted(KNOWN)))
    if reading == "rate" and (other := sorted(_OF_ANGLES & set(effects))):
        problem = "a gyroscope does not have it"
        raise InputError(f"effect {other[0]!r}", problem, "an effect of the motion, gain or zero")
    stamped = np.asarray(times, dtype=float) - times[0]
    duration = float(stamped[-1])
    true = stamped + (values["clock_drift"] * stamped**2 / duration if "clock_drift" in effects else 0.0)
    pendulum = Pendulum(effects, values, duration, restoring, form, twins, accuracy)
    lag = values.get("lag_time", 0.0)
    frequency, begun = values["natural_frequency"], values.get("lag_start", 0.0)
    first = _first_reading(lag, release_angle, release_velocity, frequency, begun)
    y = np.array([release_angle, release_velocity, 0.0, 0.0, first])
    pendulum.th_start = release_angle
    kinks = {}
    for name, function in pendulum.kinks().items():
        side = function(release_angle, release_velocity)
        kinks[name] = 1.0 if side >= 0 else -1.0
    motion = Motion(np.empty(true.size))
    angle, lagging, velocity = np.empty(true.size), np.empty(true.size), np.empty(true.size)
    t, done, end = 0.0, 0, float(true[-1]) * (1 + 1e-12) + 1e-12
    s = int(np.sign(release_velocity))
    pieces = []
    if s == 0:
        s = pendulum.way_from_rest(t, y, 0, kinks)
        motion.stuck_after = t if s == 0 else None
    for _ in range(most):
        if done == true.size:
            break
        found, t_next, y, ended, names = _first_event(pendulum, t, y, end, s, kinks, true[done:])
        count = found.shape[1]
        angle[done : done + count], lagging[done : done + count], velocity[done : done + count] = found
        pieces += [(true[done + k], angle[done + k], done + k) for k in range(count)]
        done += count
        t = t_next
        if ended is None:
            break
        if s == 0:
            up, down = (pendulum.from_rest(t, y, way, kinks) for way in (1, -1))
            s = 1 if up > -down else -1
        elif ended == 0:
            pieces.append((t, y[0], None))
            motion.reversals.append(t)
            if pendulum.wound:
                pendulum.F_start, pendulum.th_start = pendulum.dahl(s, y[0]), y[0]
            y[1] = 0.0
            s = pendulum.way_from_rest(t, y, s, kinks)
            if s == 0:
                motion.stuck_after = t
        else:
            name = names[ended - 1]
            kinks[name] = -kinks[name]
    else:
        raise Runaway("too many events")
    if done < true.size:
        raise Runaway("the end was not reached")
    read = velocity if reading == "rate" else angle
    motion.reading, motion.contact = _read(effects, values, read, lagging, pieces, release_angle)
    if not isfinite(motion.reading.sum()):
        raise Runaway("not finite")
    return motion


def _first_reading(lag, angle, velocity, frequency, begun):
    """What a slow sensor reads at first (rad): the angle where the pendulum was held, what a steady swing leaves of it where it
    swings; a quarter of a swing's own velocity tells half and half. Of a pendulum that has ``begun`` (1) a quarter of a swing before, when it
    was let go, the sensor is behind by what is left of the way from the angle to the steady reading."""
    swinging = velocity**4 / (velocity**4 + (frequency * angle / 4) ** 4 + (1e-6 * frequency) ** 4)
    turn = complex(1, lag * frequency)
    phasor = complex(angle, -velocity / frequency) / turn
    late = -lag * velocity / abs(turn) ** 2
    first = swinging * phasor.real + (1 - swinging) * (angle + late)
    if not begun:
        return first
    return first - begun * (1 - (1 / turn).real) * velocity / frequency * np.exp(-np.pi / 2 / turn.imag)


def _read(effects, values, angle, lagging, pieces, release_angle):
    """What the sensors make of the angle: play first, then lag, eccentricity, gain, zero."""
    reading, contact = angle.copy(), np.zeros(angle.size, dtype=int)
    if "backlash" in effects:
        half, follower = values["backlash_width"] / 2, release_angle
        for _, th, index in pieces:
            follower = min(max(follower, th - half), th + half)
            if index is not None:
                reading[index] = follower
                contact[index] = int(follower == th - half) - int(follower == th + half)
    if "sensor_lag" in effects:
        reading = lagging.copy()
    if "eccentricity" in effects:
        reading = reading + values["eccentricity"] * np.sin(reading + values["eccentricity_phase"])
    if "sensor_gain" in effects:
        reading = reading * (1 + values["sensor_gain"])
    if "sensor_curvature" in effects:
        reading = reading + values["sensor_curvature"] * reading**2
    if "sensor_zero" in effects:
        reading = reading + values["sensor_zero"]
    return reading, contact
