"""What somebody who knows how would write: compiled or high-order integrators with sensitivities, and a small least squares.

For the smooth case alone (``five``): friction that turns with the velocity needs events and jumps of the sensitivities in each
of these packages, which is where a project such as this one begins. All use one and the same Levenberg-Marquardt; a fitter
takes a ``peers.Task`` and returns a ``peers.Found``, ``fits`` tells how many fits it has done.
"""

import numpy as np
from peers import Found

BATCH = 1000  # series at once
TOLERANCE = 1e-10  # relative fall of the sum of squares, as this engine's


def levenberg_marquardt(evaluate, x, times, angle):
    """Where ``evaluate(x, times, angle)``, half a sum of squares with J'r and J'J, is least; the sum of squares; evaluations."""
    damping, count = 1e-4, 1
    value, gradient, normal = evaluate(x, times, angle)
    for _ in range(100):
        damped = normal.copy()
        for i in range(x.size):
            damped[i, i] *= 1.0 + damping
        trial = x - np.linalg.solve(damped, gradient)
        found, trial_gradient, trial_normal = evaluate(trial, times, angle)
        count += 1
        if found <= value:
            fall = (value - found) / value
            x, value, gradient, normal = trial, found, trial_gradient, trial_normal
            damping *= 0.1
            if fall < TOLERANCE:
                break
        else:
            damping *= 10.0
            if damping > 1e12:
                break
    return x, 2.0 * value, count


def half_squares(series, slopes, angle):
    """Half the sum of squares of series - angle, J'r and J'J, of ``slopes`` (n, variables)."""
    residuals = series - angle
    return 0.5 * float(residuals @ residuals), slopes.T @ residuals, slopes.T @ slopes


def runge_kutta(p, times, angle):
    """The same of a viscous pendulum by the classical Runge-Kutta method from sample to sample, sensitivities by hand."""
    w, zeta, zero = p[0], p[1], p[2]
    y = np.zeros(
        10
    )  # angle and velocity; then by natural frequency, viscous ratio, release angle and velocity
    y[0], y[1], y[6], y[9] = p[3], p[4], 1.0, 1.0
    k, z = np.zeros((4, 10)), np.zeros(10)
    row, gradient, normal, value = np.zeros(5), np.zeros(5), np.zeros((5, 5)), 0.0
    row[2] = 1.0
    for j in range(times.size):
        residual = y[0] + zero - angle[j]
        row[0], row[1], row[3], row[4] = y[2], y[4], y[6], y[8]
        value += 0.5 * residual * residual
        for a in range(5):
            gradient[a] += row[a] * residual
            for b in range(a + 1):
                normal[a, b] += row[a] * row[b]
        if j == times.size - 1:
            break
        h = times[j + 1] - times[j]
        for stage in range(4):
            part = 0.0 if stage == 0 else (h if stage == 3 else 0.5 * h)
            for i in range(10):
                z[i] = y[i] + part * k[stage - 1, i] if stage else y[i]
            sine, by_angle, by_velocity = np.sin(z[0]), -w * w * np.cos(z[0]), -2.0 * zeta * w
            k[stage, 0], k[stage, 1] = z[1], -w * w * sine + by_velocity * z[1]
            for f in range(4):
                k[stage, 2 + 2 * f] = z[3 + 2 * f]
                k[stage, 3 + 2 * f] = by_angle * z[2 + 2 * f] + by_velocity * z[3 + 2 * f]
            k[stage, 3] += -2.0 * w * sine - 2.0 * zeta * z[1]
            k[stage, 5] += -2.0 * w * z[1]
        for i in range(10):
            y[i] += h / 6.0 * (k[0, i] + 2.0 * k[1, i] + 2.0 * k[2, i] + k[3, i])
    for a in range(5):
        for b in range(a):
            normal[b, a] = normal[a, b]
    return value, gradient, normal


class Numba:
    """Runge-Kutta and least squares, all compiled by numba; ``count`` series at once, as a user's loop over them would."""

    only = ("five",)

    def __init__(self, count=1):
        import numba

        evaluate = numba.njit(fastmath=True)(runge_kutta)
        search = numba.njit(levenberg_marquardt)

        @numba.njit
        def fit_all(start, times, series):
            values, evaluations = np.empty((len(series), start.size)), 0
            for k in range(len(series)):
                values[k], _, count = search(evaluate, start, times, series[k])
                evaluations += count
            return values, evaluations

        self.fit_all, self.fits = fit_all, count

    def __call__(self, task):
        values, evaluations = self.fit_all(task.start, task.times, task.series[: self.fits])
        return Found(values[0], round(evaluations / self.fits))


class Heyoka:
    """heyoka's Taylor integrator (LLVM) with its variational equations of first order."""

    only = ("five",)
    fits = 1

    def __init__(self):
        import heyoka as hy

        th, v = hy.make_vars("th", "v")
        w, zeta = hy.par[0], hy.par[1]
        system = [(th, v), (v, -w * w * hy.sin(th) - 2.0 * zeta * w * v)]
        variational = hy.var_ode_sys(system, [w, zeta, th, v], order=1)
        self.integrator = hy.taylor_adaptive(variational, [0.1, 0.0], tol=1e-10, compact_mode=False)
        self.first = self.integrator.state.copy()

    def _evaluate(self, p, times, angle):
        self.integrator.time = times[0]
        self.integrator.state[:] = self.first
        self.integrator.state[:2] = p[3:]
        self.integrator.pars[:2] = p[:2]
        *_, states = self.integrator.propagate_grid(times)
        slopes = np.empty((times.size, 5))
        slopes[:, [0, 1, 3, 4]] = states[:, 2:6]
        slopes[:, 2] = 1.0
        return half_squares(states[:, 0] + p[2], slopes, angle)

    def __call__(self, task):
        values, _, count = levenberg_marquardt(self._evaluate, task.start.copy(), task.times, task.angle)
        return Found(values, count)


class Cvodes:
    """CVODES with forward sensitivities, by CasADi."""

    only = ("five",)
    fits = 1

    def __init__(self):
        import casadi

        self.casadi, self.compiled = casadi, {}

    def _build(self, times):
        ca = self.casadi
        th, v, p = ca.SX.sym("th"), ca.SX.sym("v"), ca.SX.sym("p", 2)
        rates = ca.vertcat(v, -p[0] * p[0] * ca.sin(th) - 2 * p[1] * p[0] * v)
        equations = {"x": ca.vertcat(th, v), "p": p, "ode": rates}
        options = {"reltol": 1e-8, "abstol": 1e-10}
        integrator = ca.integrator("swing", "cvodes", equations, float(times[0]), list(times), options)
        values = ca.MX.sym("values", 4)
        series = integrator(x0=values[2:], p=values[:2])["xf"][0, :].T
        return ca.Function("evaluate", [values], [series, ca.jacobian(series, values)])

    def _evaluate(self, p, times, angle):
        series, by = self.compiled[times.size](np.delete(p, 2))
        slopes = np.ones((times.size, 5))
        slopes[:, [0, 1, 3, 4]] = np.array(by)
        return half_squares(np.array(series)[:, 0] + p[2], slopes, angle)

    def __call__(self, task):
        if task.times.size not in self.compiled:
            self.compiled[task.times.size] = self._build(task.times)
        values, _, count = levenberg_marquardt(self._evaluate, task.start.copy(), task.times, task.angle)
        return Found(values, count)


FITTERS = {
    "numba RK4 + sensitivities + LM, batch, warm": lambda: Numba(BATCH),
    "numba RK4 + sensitivities + LM, warm": Numba,
    "heyoka variational + LM, warm": Heyoka,
    "CVODES sensitivities + LM, warm": Cvodes,
}
