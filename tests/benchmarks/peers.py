"""The fitters that a user would otherwise pick, each with settings just tight enough for the optimum.

A fitter takes a case's ``Task`` and returns the values it found, in the order of the task's start, and how often it
integrated the equations of motion. The right-hand sides are written as a user would write them, for the case alone.
"""

from dataclasses import dataclass
from math import cos, sin
from typing import NamedTuple

import numpy as np
from scipy.integrate import odeint, solve_ivp
from scipy.optimize import least_squares, minimize

# Just tight enough: the simplex needs the sum of squares to 1e-8 of itself, finite differences a step far above the noise.
RTOL, ATOL = 1e-8, 1e-10
RTOL_DIFFERENCES, ATOL_DIFFERENCES, STEP, STOP = 1e-10, 1e-12, 1e-5, 1e-8


@dataclass(frozen=True)
class Task:
    """Series of angles (rad) at times (s), and where to start: frequency, coefficients, zero, release angle and velocity.

    All but those that fit batches fit the first, ``angle``.
    """

    name: str
    times: np.ndarray
    series: np.ndarray
    start: np.ndarray
    scale: np.ndarray  # typical sizes, for those optimisers that want them

    @property
    def angle(self):
        """The first of the series."""
        return self.series[0]


class Found(NamedTuple):
    """What a fitter found, and with how many trajectories."""

    values: np.ndarray
    evaluations: int


def motion(name):
    """θ'' as a function of (values, θ, θ') for a case."""
    if name == "five":

        def acceleration(p, th, v):
            return -p[0] * p[0] * sin(th) - 2 * p[1] * p[0] * v

    else:

        def acceleration(p, th, v):
            w, viscous, quadratic, load = p[:4]
            friction = load * (v * v + w * w * cos(th))
            s = 1.0 if v > 0 else (-1.0 if v < 0 else 0.0)
            return -w * w * sin(th) - 2 * viscous * w * v - w * quadratic * v * abs(v) - friction * s

    return acceleration


class Counted:
    """Residuals of a task by one of scipy's integrators, counted."""

    def __init__(self, task, integrator, rtol=RTOL, atol=ATOL):
        self.task, self.integrator, self.count = task, integrator, 0
        self.rtol, self.atol = rtol, atol
        self.acceleration = motion(task.name)

    def __call__(self, p):
        self.count += 1
        p = [float(x) for x in p]
        acceleration, times = self.acceleration, self.task.times
        *_, zero, angle, velocity = p
        if self.integrator == "odeint":
            th = odeint(
                lambda y, t: (y[1], acceleration(p, y[0], y[1])),
                (angle, velocity),
                times,
                rtol=self.rtol,
                atol=self.atol,
                mxstep=5000,
            )[:, 0]
        else:
            th = solve_ivp(
                lambda t, y: (y[1], acceleration(p, y[0], y[1])),
                (times[0], times[-1]),
                (angle, velocity),
                t_eval=times,
                method="RK45",
                rtol=self.rtol,
                atol=self.atol,
            ).y[0]
        return th + zero - self.task.angle if th.size == times.size else np.full(times.size, 1e3)


def _simplex(task, integrator):
    residuals = Counted(task, integrator)

    def squares(z):
        r = residuals(z * task.scale)
        return float(r @ r)

    z = task.start / task.scale
    first = np.vstack([z, z + 0.1 * np.eye(z.size)])
    found = minimize(
        squares,
        z,
        method="Nelder-Mead",
        options={"initial_simplex": first, "xatol": 1e-4, "fatol": 1e-7 * squares(z), "maxfev": 20000},
    )
    return Found(found.x * task.scale, residuals.count)


def solve_ivp_nelder_mead(task):
    """solve_ivp RK45 and scipy's Nelder-Mead."""
    return _simplex(task, "solve_ivp")


def odeint_nelder_mead(task):
    """odeint (LSODA) and scipy's Nelder-Mead."""
    return _simplex(task, "odeint")


def odeint_lmfit(task):
    """lmfit's leastsq (MINPACK, finite differences) on odeint."""
    import lmfit

    residuals = Counted(task, "odeint", RTOL_DIFFERENCES, ATOL_DIFFERENCES)
    names = [f"p{k}" for k in range(task.start.size)]
    parameters = lmfit.Parameters()
    for name, value in zip(names, task.start / task.scale, strict=True):
        parameters.add(name, value=float(value))
    found = lmfit.minimize(
        lambda p: residuals(np.array([p[name].value for name in names]) * task.scale),
        parameters,
        method="leastsq",
        epsfcn=STEP**2,
        ftol=STOP,
        xtol=STOP,
    )
    return Found(np.array([found.params[name].value for name in names]) * task.scale, residuals.count)


def odeint_least_squares(task):
    """scipy's least_squares (trf, finite differences) on odeint."""
    residuals = Counted(task, "odeint", RTOL_DIFFERENCES, ATOL_DIFFERENCES)
    found = least_squares(
        lambda z: residuals(z * task.scale),
        task.start / task.scale,
        diff_step=STEP,
        ftol=STOP,
        xtol=STOP,
        gtol=1e-12,
    )
    return Found(found.x * task.scale, residuals.count)


class Diffrax:
    """diffrax (Dopri8, forward-mode derivatives) and optimistix's Levenberg-Marquardt, compiled at the first call."""

    def __init__(self):
        import diffrax
        import jax
        import jax.numpy as jnp
        import optimistix

        jax.config.update("jax_enable_x64", True)
        self.compiled = {}
        self.jax, self.jnp, self.diffrax, self.optimistix = jax, jnp, diffrax, optimistix

    def _build(self, task):
        jnp, diffrax, optimistix = self.jnp, self.diffrax, self.optimistix
        times, scale = jnp.asarray(task.times), jnp.asarray(task.scale)

        def field(t, y, p):
            th, v = y
            w = p[0]
            a = -w * w * jnp.sin(th) - 2 * p[1] * w * v
            if task.name != "five":
                a = a - w * p[2] * v * jnp.abs(v) - p[3] * (v * v + w * w * jnp.cos(th)) * jnp.sign(v)
            return (v, a)

        def residuals(z, angle):
            p = z * scale
            solution = diffrax.diffeqsolve(
                diffrax.ODETerm(field), diffrax.Dopri8(), times[0], times[-1], None, (p[-2], p[-1]), args=p,
                saveat=diffrax.SaveAt(ts=times), stepsize_controller=diffrax.PIDController(rtol=RTOL, atol=ATOL),
                adjoint=diffrax.ForwardMode(), max_steps=100_000, throw=False,
            )  # fmt: skip
            return solution.ys[0] + p[-3] - angle

        solver = optimistix.LevenbergMarquardt(rtol=1e-7, atol=1e-9)

        def fit(z, angle):
            done = optimistix.least_squares(
                residuals, solver, z, args=angle, options={"jac": "fwd"}, max_steps=200, throw=False
            )
            return done.value, done.stats["num_steps"]

        return self.jax.jit(fit)

    def __call__(self, task):
        if task.name not in self.compiled:
            self.compiled[task.name] = self._build(task)
        value, steps = self.compiled[task.name](
            self.jnp.asarray(task.start / task.scale), self.jnp.asarray(task.angle)
        )
        return Found(np.asarray(value) * task.scale, int(steps))


def available(begin=""):
    """The fitters by name that begins so, and the names of those whose packages are not installed."""
    fitters = {
        "solve_ivp RK45 + Nelder-Mead": solve_ivp_nelder_mead,
        "odeint + Nelder-Mead": odeint_nelder_mead,
        "odeint + least_squares": odeint_least_squares,
    }
    missing = []
    from compiled_peers import FITTERS  # which imports from here

    for name, make in {
        "odeint + lmfit leastsq": _lmfit,
        "diffrax + optimistix, warm": Diffrax,
        **FITTERS,
    }.items():
        if not name.startswith(begin):
            continue
        try:
            fitters[name] = make()
        except ImportError:
            missing.append(name)
    return {name: one for name, one in fitters.items() if name.startswith(begin)}, missing


def _lmfit():
    import lmfit  # noqa: F401

    return odeint_lmfit
