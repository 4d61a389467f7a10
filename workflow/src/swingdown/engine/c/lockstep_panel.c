#include "lockstep.h"

#define LOCKSTEP_SOLVED 1e-12    /* residual of the collocation equations against their size, after the last sweep */
#define AT_ONCE 1e-7             /* the same before the first sweep, whose error is as its square: one is enough */
#define FORETOLD 1e-4            /* and where slopes there are as good as at the solution */
/* last two Legendre coefficients of the acceleration against its size, times the square of the phase that the panel takes: at
 * this limit the angle is off by 2e-10 of the largest between the nodes, and by far less at the panels' ends */
#define LOCKSTEP_TRUNCATION 7.5e-5
#define ROUNDS 6
#define LEAST_PIVOT 0.05

/* Angle and velocity at the nodes. */
static inline void lockstep_motion(const LockstepPanel *panel, Each *th, Each *v) {
    const Each h = panel->h, th0 = panel->th, v0 = panel->v;
    Each once[LN], twice[LN];
    UNROLL
    for (int i = 0; i < LN; i++) once[i] = twice[i] = each(0.0);
    UNROLL
    for (int j = 0; j < LN; j++) {
        const Each u = panel->u[j];
        UNROLL
        for (int i = 0; i < LN; i++) {
            once[i] += LOCKSTEP_first[j * LN + i] * u;
            twice[i] += LOCKSTEP_second[j * LN + i] * u;
        }
    }
    UNROLL
    for (int i = 0; i < LN; i++) {
        v[i] = v0 + h * once[i];
        th[i] = th0 + h * (v0 * LOCKSTEP_nodes[i] + h * twice[i]);
    }
}

/* The accelerations from the motion at the nodes; linear: also their derivatives, into the panel. */
static void lockstep_accelerations(const LockstepSystem *s, const Each *th, const Each *v, const LockstepPanel *panel, Each *f,
                                   LockstepPanel *linear) {
    const Model *m = s->model;
    Each sn[LN], cs[LN], t[LN];
    UNROLL
    for (int i = 0; i < LN; i++) {
        sines_cosines(th[i], &sn[i], &cs[i]);
        t[i] = panel->t + panel->h * LOCKSTEP_nodes[i];
        f[i] = each(0.0);
    }
    const LockstepPoints q = {th, v, t, sn, cs, s->p[0], s->direction, m->duration};
    if (linear) {
        UNROLL
        for (int i = 0; i < LN; i++) linear->by_angle[i] = linear->by_velocity[i] = linear->by_parameter[i] = each(0.0);
        for (int k = 0; k < m->n_motions; k++) {
            const PlacedEffect at = m->motions[k];
            EFFECTS[at.row].lockstep_partials(&q, s->p + at.first_parameter, f, linear->by_angle, linear->by_velocity, linear->by_parameter,
                                              linear->by_parameter + at.first_parameter * LN);
        }
    } else
        for (int k = 0; k < m->n_motions; k++) EFFECTS[m->motions[k].row].lockstep(&q, s->p + m->motions[k].first_parameter, f);
}

/* Factors of 1 - d(accelerations)/d(unknowns), without exchanges: the matrix is nearly triangular with a diagonal near one.
 * The fits for which the pivots are large enough. */
static Which factorise_lockstep(LockstepPanel *panel) {
    const Each h = panel->h;
    Each a[LN * LN];
    Which good = (Which)(each(0.0) == each(0.0));
    UNROLL
    for (int i = 0; i < LN; i++) {
        const Each twice = -(h * h * panel->by_angle[i]), once = -(h * panel->by_velocity[i]);
        UNROLL
        for (int j = 0; j < LN; j++)
            a[i * LN + j] = twice * LOCKSTEP_second[j * LN + i] + once * LOCKSTEP_first[j * LN + i] + (i == j ? 1.0 : 0.0);
    }
    UNROLL
    for (int c = 0; c < LN; c++) {
        good &= (Which)(size_of(a[c * LN + c]) > LEAST_PIVOT);
        const Each pivot = panel->pivot[c] = 1.0 / a[c * LN + c];
        UNROLL
        for (int r = c + 1; r < LN; r++) {
            const Each factor = a[r * LN + c] *= pivot;
            UNROLL
            for (int j = c + 1; j < LN; j++) a[r * LN + j] -= factor * a[c * LN + j];
        }
    }
    memcpy(panel->factors, a, sizeof a);
    return good;
}

/* The solution of the factorised equations, in place. */
static inline void substitute_lockstep(const LockstepPanel *panel, Each *x) {
    const Each *a = panel->factors;
    Each y[LN];
    UNROLL
    for (int c = 0; c < LN; c++) y[c] = x[c];
    UNROLL
    for (int c = 0; c < LN; c++) {
        UNROLL
        for (int r = c + 1; r < LN; r++) y[r] -= a[r * LN + c] * y[c];
    }
    UNROLL
    for (int c = LN - 1; c >= 0; c--) {
        y[c] *= panel->pivot[c];
        UNROLL
        for (int r = 0; r < c; r++) y[r] -= a[r * LN + c] * y[c];
    }
    UNROLL
    for (int c = 0; c < LN; c++) x[c] = y[c];
}

/* What f makes of the unknowns, less the unknowns; the largest of it against its size. */
static inline Each lockstep_residual(const LockstepSystem *s, const LockstepPanel *panel, const Each *f, Each *residual) {
    Each error = each(0.0), size = s->least;
    UNROLL
    for (int i = 0; i < LN; i++) {
        residual[i] = f[i] - panel->u[i];
        error = larger(size_of(residual[i]), error);
        size = larger(size_of(f[i]), size);
    }
    return error / size;
}

/* Put the values of the fits chosen in place of those that are there. */
static void replace(Which which, int n, const Each *by, Each *there) {
    for (int i = 0; i < n; i++) there[i] = choose(which, by[i], there[i]);
}

/* How far the last Legendre coefficients stand out of the size, over the limit. */
static Each lockstep_error(const LockstepSystem *s, const LockstepPanel *panel) {
    Each tail[2] = {each(0.0), each(0.0)}, size = s->least;
    UNROLL
    for (int i = 0; i < LN; i++) {
        for (int k = 0; k < 2; k++) tail[k] += LOCKSTEP_tail[k * LN + i] * panel->u[i];
        size = larger(size_of(panel->u[i]), size);
    }
    const Each phase = panel->h * s->p[0];
    return (size_of(tail[0]) + size_of(tail[1])) * phase * phase / (LOCKSTEP_TRUNCATION * size);
}

/* One sweep with the present factors, for the fits chosen. */
static inline void sweep_lockstep(LockstepPanel *panel, Which which, Each *residual) {
    substitute_lockstep(panel, residual);
    UNROLL
    for (int i = 0; i < LN; i++) panel->u[i] = choose(which, panel->u[i] + residual[i], panel->u[i]);
}

static Which solve_lockstep(const LockstepSystem *s, LockstepPanel *panel, Which which) {
    Each th[LN], v[LN], f[LN], residual[LN];
    LockstepPanel again;
    Which active = which, solved = which & 0;
    const int n_parameters = s->model->n_parameters;
    const double limit = LOCKSTEP_SOLVED * s->coarseness, near = sqrt(s->coarseness);
    for (int round = 0; round < ROUNDS && any(active); round++) {
        lockstep_motion(panel, th, v);
        lockstep_accelerations(s, th, v, panel, f, round ? &again : panel);
        const Each first = lockstep_residual(s, panel, f, residual);
        if (round) { /* a fit that is solved keeps the slopes that it has, to the bit */
            replace(active, LN, again.by_angle, panel->by_angle);
            replace(active, LN, again.by_velocity, panel->by_velocity);
            replace(active, n_parameters * LN, again.by_parameter, panel->by_parameter);
        }
        const Which good = factorise_lockstep(panel);
        active &= good & (Which)(first < 1e6); /* and a number */
        sweep_lockstep(panel, active, residual);
        const Which foretold = active & (Which)(first <= FORETOLD * near), done = foretold & (Which)(first <= AT_ONCE * near);
        const Which second_sweep = active & ~done;
        solved |= done;
        active = second_sweep;
        if (!any(second_sweep)) break;
        lockstep_motion(panel, th, v);
        lockstep_accelerations(s, th, v, panel, f, NULL);
        const Each second = lockstep_residual(s, panel, f, residual), gained = second / first;
        sweep_lockstep(panel, second_sweep, residual);
        const Which close = (Which)(second * choose((Which)(gained < 1.0), gained, each(1.0)) <= limit);
        solved |= second_sweep & foretold & close;
        active = second_sweep & ~(foretold & close) & (Which)(second < 1e6);
    }
    return solved & (Which)(lockstep_error(s, panel) <= s->most_error);
}

static void change_lockstep(const LockstepPanel *panel, Each th, Each v, int parameter, Each *change) {
    const Each speed = v * panel->h;
    UNROLL
    for (int i = 0; i < LN; i++) change[i] = panel->by_angle[i] * (th + speed * LOCKSTEP_nodes[i]) + panel->by_velocity[i] * v;
    if (parameter >= 0)
        UNROLL
        for (int i = 0; i < LN; i++) change[i] += panel->by_parameter[parameter * LN + i];
    substitute_lockstep(panel, change);
}

static void end_lockstep(const LockstepPanel *panel, const Each *u, Each *th, Each *v) {
    Each once = each(0.0), twice = each(0.0);
    UNROLL
    for (int j = 0; j < LN; j++) {
        const Each part = LOCKSTEP_weights[j] * u[j];
        once += part;
        twice += (1.0 - LOCKSTEP_nodes[j]) * part;
    }
    *th += panel->h * (*v + panel->h * twice);
    *v += panel->h * once;
}
