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
        const Points q = {1, 1, &x->th, &x->v, &zero, &x->t, &sn, &cs, &zero, s->p[0], s->model->duration, 1.0};
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
    if (d->by[f] >= 0)
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

static void propagate(const System *s, const Panel *panel, Sensitivities *d) {
    const int nz = s->model->n_states;
    for (int f = 0; f < d->n; f++) {
        double rhs[BLOCKS * N], du[BLOCKS * N], input[MAX_STATES * N], th[N];
        for (int block = 0; block < s->blocks; block++) forcing(s, panel, d, f, s->row[block], rhs + block * N);
        apply_inverse(panel, s->blocks, rhs, du);
        if (s->lags) angle_change(panel, d, f, du, th);
        for (int k = 0; s->lags && k < nz; k++)
            if (s->method[k].kind == LAG) lag_forcing(s, panel, d, f, k, du, input + k * N);
        const PanelStart start = {d->th[f], d->v[f], d->z[f], input, th};
        integrate_unknowns(s, panel, du, &start, &d->curve[f]);
        for (int k = 0; s->lags && k < nz; k++)
            if (d->by[f] >= 0)
                d->curve[f].state[k].transient[1] = -s->relaxation_by[k][d->by[f]] * panel->curve.state[k].transient[0];
    }
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
