#include "sensitivities.h"

static void set_release(const System *s, PhasePoint *x, Sensitivities *d) {
    double sn, cs;
    const int np = s->model->n_parameters;
    for (int f = 0; f < d->n; f++) {
        d->th[f] = d->by[f] == RELEASE_ANGLE;
        d->v[f] = d->by[f] == RELEASE_VELOCITY;
        for (int k = 0; k < s->model->n_states; k++) d->z[f][k] = 0.0;
    }
    sine_cosine(x->th, &sn, &cs);
    for (int k = 0; k < s->model->n_motions; k++) {
        const PlacedEffect at = s->model->motions[k];
        const Effect *e = &EFFECTS[at.row];
        if (!e->n_states) continue;
        const double zero = 0.0;
        double by[MAX_STATES * 2] = {0.0}, by_parameter[MAX_STATES * MAX_PARAMETERS] = {0.0};
        const Points q = {1, 1, &x->th, &x->v, &zero, &x->t, &sn, &cs, &zero, s->p[0], s->model->duration, 1.0, NULL};
        const Partials partials = {by, by_parameter, 2, np, 1};
        e->initial(&q, s->p + at.first_parameter, NULL, x->z + at.first_state, at);
        e->initial_partials(&q, s->p + at.first_parameter, NULL, &partials, at);
        for (int f = 0; f < d->n; f++)
            for (int j = 0; j < e->n_states; j++)
                d->z[f][at.first_state + j] = by[2 * j] * d->th[f] + by[2 * j + 1] * d->v[f]
                                              + (d->by[f] >= 0 ? by_parameter[j * np + d->by[f]] : 0.0);
    }
}

/* What changes a rate at the nodes for a change of free value f: through the place where the panel starts, and itself. */
static void forcing(const System *s, const Panel *panel, const Sensitivities *d, int f, int row, double *out) {
    const int nz = s->model->n_states, inputs = 3 + nz;
    const double *by = panel->by + row * inputs * N;
    for (int i = 0; i < N; i++) out[i] = by[i] * (d->th[f] + d->v[f] * panel->h * T_nodes[i]) + by[N + i] * d->v[f];
    for (int k = 0; k < nz; k++) {
        const double *by_state = by + (3 + k) * N;
        for (int i = 0; i < N; i++) out[i] += by_state[i] * d->z[f][k];
        if (s->method[k].kind == INTEGRATED) {
            const double speed = panel->h * d->z[f][s->row[s->method[k].of] - 1];
            for (int i = 0; i < N; i++) out[i] += by_state[i] * speed * T_nodes[i];
        }
    }
    if (nz)
        for (int i = 0; i < N; i++) out[i] += panel->by_start[row * N + i] * d->th[f];
    if (free_value(d, f) >= 0)
        for (int i = 0; i < N; i++) out[i] += panel->by_parameter[(row * s->model->n_parameters + d->by[f]) * N + i];
}

/* What drives the change of lag k: as the blocks', with the change du of the motion that is now known. */
static void lag_forcing(const System *s, const Panel *panel, const Sensitivities *d, int f, int k, const double *du, double *out) {
    const double h = panel->h, *by = panel->by + (1 + k) * (3 + s->model->n_states) * N;
    double once[N], twice[N];
    forcing(s, panel, d, f, 1 + k, out);
    multiply(T_first, du, once);
    multiply(T_second, du, twice);
    for (int i = 0; i < N; i++)
        out[i] += h * (h * by[i] * twice[i] + by[N + i] * once[i]) + by[2 * N + i] * du[i] + s->relaxation[k] * d->z[f][k];
}

/* The change of the angle at the nodes. */
static void angle_change(const Panel *panel, const Sensitivities *d, int f, const double *du, double *out) {
    double twice[N];
    multiply(T_second, du, twice);
    for (int i = 0; i < N; i++) out[i] = d->th[f] + panel->h * (d->v[f] * T_nodes[i] + panel->h * twice[i]);
}

static void propagate_one(const System *s, const Panel *panel, Sensitivities *d, int f, const double *by_time) {
    const int nz = s->model->n_states, by = free_value(d, f);
    double rhs[BLOCKS * N], du[BLOCKS * N], input[MAX_STATES * N], th[N];
    for (int block = 0; block < s->blocks; block++) {
        forcing(s, panel, d, f, s->row[block], rhs + block * N);
        for (int i = 0; by_time && i < N; i++) rhs[block * N + i] += by_time[s->row[block] * N + i];
    }
    apply_inverse(panel, s->blocks, rhs, du);
    if (s->lags) angle_change(panel, d, f, du, th);
    for (int k = 0; s->lags && k < nz; k++)
        if (s->method[k].kind == LAG) lag_forcing(s, panel, d, f, k, du, input + k * N);
    const PanelStart start = {d->th[f], d->v[f], d->z[f], input, th};
    integrate_unknowns(s, panel, du, &start, &d->curve[f]);
    for (int k = 0; s->lags && k < nz; k++)
        if (by >= 0)
            d->curve[f].state[k].transient[1] = -s->relaxation_by[k][by] * panel->curve.state[k].transient[0];
}

/* ---- Broken powers of the speed ----
 *
 * By the velocity, such a power has a slope that is infinite where the speed is zero. A polynomial through the nodes follows a
 * sensitivity there only if the velocity's change vanishes along with the speed, which it does not: the reversal itself
 * comes sooner or later. But to come earlier by `lead` is to be changed by the motion's own rates times that, and of these
 * collocation's answer can be compared with the rates themselves; `lead` times what it misses there is what it misses of
 * the sensitivity. */

/* The motion's rates along the panel. */
static void rates_along(const System *s, const Panel *panel, MotionCurve *out) {
    memset(out, 0, sizeof *out);
    memcpy(out->th, panel->curve.v, (N + 1) * sizeof(double));
    multiply(T_monomial, panel->u, out->v);
    for (int k = 0; k < s->model->n_states; k++) {
        const StateCurve *of = &panel->curve.state[k];
        if (s->method[k].kind == RATE_INDEPENDENT) continue; /* a closed form needs no polynomial */
        for (int j = 0; j <= N; j++) out->state[k].poly[j] = 2.0 / panel->h * (j + 1) * of->poly[j + 1];
        out->state[k].transient[0] = of->transient[1] - s->relaxation[k] * of->transient[0];
        out->state[k].transient[1] = -s->relaxation[k] * of->transient[1];
    }
}

/* a += factor * b */
static void add_curve(int n_states, double factor, const MotionCurve *b, MotionCurve *a) {
    for (int j = 0; j < N + 2; j++) {
        a->th[j] += factor * b->th[j];
        a->v[j] += factor * b->v[j];
    }
    for (int k = 0; k < n_states; k++) {
        for (int j = 0; j < N + 2; j++) a->state[k].poly[j] += factor * b->state[k].poly[j];
        for (int j = 0; j < 2; j++) a->state[k].transient[j] += factor * b->state[k].transient[j];
    }
}

/* What changes the rates at the nodes because time goes on; by differences, for they are smooth in time. */
#define TIME_STEP 1e-5
static void rates_by_time(const System *s, const Panel *panel, double *out) {
    double later[BLOCKS * N], t[N];
    MotionPoints nodes = nodes_of(panel);
    nodes.t = t;
    for (int side = -1; side < 2; side += 2) {
        for (int i = 0; i < N; i++) t[i] = panel->t[i] + side * TIME_STEP;
        right_hand_side(s, &nodes, side < 0 ? out : later, NULL);
    }
    for (int i = 0; i < (1 + s->model->n_states) * N; i++) out[i] = (later[i] - out[i]) / (2.0 * TIME_STEP);
}

static void mend_broken_powers(System *s, const Panel *panel, Sensitivities *d, double x_end) {
    double rates[BLOCKS], by_time[BLOCKS * N];
    const int own = d->n, nz = s->model->n_states;
    const int ends_slower = fabs(horner(panel->curve.v, N, x_end)) < fabs(panel->from.v);
    MotionCurve missed, *found = &d->curve[own];
    rates_at(s, &panel->from, s->direction, rates);
    d->th[own] = panel->from.v;
    d->v[own] = rates[0];
    for (int k = 0; k < nz; k++) d->z[own][k] = rates[1 + k];
    if (s->timed) rates_by_time(s, panel, by_time);
    propagate_one(s, panel, d, own, s->timed ? by_time : NULL);
    rates_along(s, panel, &missed);
    d->last_rates[0] = horner(missed.v, N - 1, x_end);
    for (int k = 0; k < nz; k++) d->last_rates[1 + k] = horner(missed.state[k].poly, N, x_end);
    add_curve(nz, -1.0, found, &missed);
    const double own_change = ends_slower ? horner(found->v, N, x_end) : d->v[own];
    for (int f = 0; f < d->n; f++) {
        const double change = ends_slower ? horner(d->curve[f].v, N, x_end) : d->v[f];
        d->lead[f] = own_change != 0.0 ? change / own_change : 0.0;
        add_curve(nz, d->lead[f], &missed, &d->curve[f]);
    }
}

static void propagate(System *s, const Panel *panel, Sensitivities *d, double x_end) {
    for (int f = 0; f < d->n; f++) propagate_one(s, panel, d, f, NULL);
    if (s->fractional_power && !s->stuck) mend_broken_powers(s, panel, d, x_end);
}

static void move_to(const System *s, const Panel *panel, Sensitivities *d, double x) {
    const double after = 0.5 * panel->h * (x + 1.0), th = horner(panel->curve.th, N + 1, x);
    const PhasePoint *from = &panel->from;
    for (int f = 0; f < d->n; f++) {
        const double th_before = d->th[f];
        d->th[f] = horner(d->curve[f].th, N + 1, x);
        d->v[f] = horner(d->curve[f].v, N, x);
        for (int k = 0; k < s->model->n_states; k++) {
            if (s->method[k].kind == RATE_INDEPENDENT) {
                const double remaining = remainder_at(s, from, k, th), turned = d->th[f] - th_before;
                d->z[f][k] = remaining * (d->z[f][k] - s->relaxation[k] * (from->z[k] - equilibrium(s, k)) * turned)
                             + (d->by[f] >= 0 ? rate_independent_by(s, from, k, d->by[f], th, remaining) : 0.0);
            } else
                d->z[f][k] = horner(d->curve[f].state[k].poly, N + 1, x) + transient_after(&d->curve[f].state[k], s->relaxation[k], after);
        }
    }
}

/* A polynomial misses the rates at the very reversal, where a broken power has its infinite slope. */
static void come_to_rest(System *s, const PhasePoint *x, Sensitivities *d) {
    double rates[BLOCKS];
    if (!s->fractional_power) return;
    rates_at(s, x, s->direction, rates);
    for (int f = 0; f < d->n; f++) {
        d->v[f] += d->lead[f] * (rates[0] - d->last_rates[0]);
        for (int k = 0; k < s->model->n_states; k++)
            if (s->method[k].kind == COLLOCATED) d->z[f][k] += d->lead[f] * (rates[1 + k] - d->last_rates[1 + k]);
    }
}

static void saltate(Sensitivities *d, int n_states, const double *before, const double *after, const double *later) {
    for (int f = 0; f < d->n; f++) {
        d->v[f] += (before[0] - after[0]) * later[f];
        for (int k = 0; k < n_states; k++) d->z[f][k] += (before[1 + k] - after[1 + k]) * later[f];
    }
}

/* A switch's gradient in phase space: by differences of its own formula, which is smooth. */
#define DIFFERENCE 1e-6

static double switch_slope(const System *s, const PhasePoint *x, int k, double *moved) {
    double high[MAX_SWITCHES], low[MAX_SWITCHES];
    const double given = *moved;
    *moved = given + DIFFERENCE;
    switches_at(s, x, high);
    *moved = given - DIFFERENCE;
    switches_at(s, x, low);
    *moved = given;
    return (high[k] - low[k]) / (2.0 * DIFFERENCE);
}

static PhasePoint switch_gradient(const System *s, const PhasePoint *x, int k) {
    PhasePoint at = *x, g;
    g.th = switch_slope(s, &at, k, &at.th);
    g.v = switch_slope(s, &at, k, &at.v);
    g.t = switch_slope(s, &at, k, &at.t);
    for (int j = 0; j < s->model->n_states; j++) g.z[j] = switch_slope(s, &at, k, &at.z[j]);
    return g;
}

/* The same by a parameter. */
static double switch_by_parameter(System *s, const PhasePoint *x, int k, int parameter) {
    double values[MAX_PARAMETERS];
    const double *given = s->p;
    memcpy(values, given, s->model->n_parameters * sizeof(double));
    s->p = values;
    const double slope = switch_slope(s, x, k, &values[parameter]);
    s->p = given;
    return slope;
}

/* Whether the rates on both sides of an event differ by more than rounding. */
static int rates_jump(int n, const double *before, const double *after) {
    double difference = 0.0;
    for (int j = 0; j < n; j++)
        difference = fmax(difference, fabs(after[j] - before[j]) / (fabs(before[j]) + fabs(after[j]) + 1e-12));
    return !(difference < 1e-9);
}

static void cross_switch(System *s, const PhasePoint *x, int k, Sensitivities *d) {
    double before[BLOCKS], after[BLOCKS], later[MAX_PARAMETERS];
    const int nz = s->model->n_states;
    rates_at(s, x, s->direction, before);
    s->sign[k] = -s->sign[k];
    rates_at(s, x, s->direction, after);
    if (!d->n || !rates_jump(1 + nz, before, after)) return;
    const PhasePoint g = switch_gradient(s, x, k);
    double rate = g.th * x->v + g.v * before[0] + g.t;
    for (int j = 0; j < nz; j++) rate += g.z[j] * before[1 + j];
    for (int f = 0; f < d->n; f++) {
        double change = g.th * d->th[f] + g.v * d->v[f];
        for (int j = 0; j < nz; j++) change += g.z[j] * d->z[f][j];
        if (d->by[f] >= 0) change += switch_by_parameter(s, x, k, d->by[f]);
        later[f] = -change / rate;
    }
    saltate(d, nz, before, after, later);
}
