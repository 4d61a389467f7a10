#include "dense_output.h"

#define DEFECT 1e-7 /* residual of the equations of motion between the nodes against their size */
/* broken powers of the speed: their errors do not cancel, so the limits are stricter by this */
#define BROKEN_POWER_TRUNCATION 300.0
#define BROKEN_POWER_DEFECT 10.0
#define NARROW 0.015 /* rad; the catalogue's narrowest effect in the angle has 0.01 */

/* State k, where the curve's angle is known. */
static void integrate_state(const System *s, const Panel *panel, int k, const double *u, const PanelStart *start, MotionCurve *curve) {
    const int block = s->method[k].of;
    StateCurve *out = &curve->state[k];
    double c[N], once[N + 1];
    switch (s->method[k].kind) {
    case COLLOCATED:
        multiply(T_monomial, u + block * N, c);
        integrate(c, N - 1, panel->h, start->z[k], out->poly);
        out->poly[N + 1] = out->transient[0] = out->transient[1] = 0.0;
        break;
    case INTEGRATED:
        multiply(T_monomial, u + block * N, c);
        integrate(c, N - 1, panel->h, start->z[s->row[block] - 1], once);
        integrate(once, N, panel->h, start->z[k], out->poly);
        out->transient[0] = out->transient[1] = 0.0;
        break;
    case LAG: {
        const LagProblem lag = {s->relaxation[k], s->gain[k], panel->h, start->z[k], panel->lag_inverse[k],
                                start->input + k * N, start->th_nodes, curve->th};
        solve_lag(&lag, out);
        break;
    }
    default: memset(out, 0, sizeof *out); /* a closed form needs no polynomial */
    }
}

static void integrate_unknowns(const System *s, const Panel *panel, const double *u, const PanelStart *start, MotionCurve *out) {
    double c[N];
    multiply(T_monomial, u, c);
    integrate(c, N - 1, panel->h, start->v, out->v);
    out->v[N + 1] = 0.0;
    integrate(out->v, N, panel->h, start->th, out->th);
    for (int k = 0; k < s->model->n_states; k++) integrate_state(s, panel, k, u, start, out);
}

static void lay_dense_output(const System *s, Panel *panel) {
    double f[BLOCKS * N];
    const MotionPoints nodes = nodes_of(panel);
    if (s->lags) right_hand_side(s, &nodes, f, NULL);
    const PanelStart start = {panel->from.th, panel->from.v, panel->from.z, f + N, panel->th};
    integrate_unknowns(s, panel, panel->u, &start, &panel->curve);
    for (int k = 0; k < s->model->n_states; k++)
        if (s->method[k].kind == LAG)
            for (int i = 0; i < N; i++) panel->z[k * N + i] = horner(panel->curve.state[k].poly, N + 1, 2.0 * T_nodes[i] - 1.0);
}

static PhasePoint point_at(const System *s, const Panel *panel, double x) {
    const double after = 0.5 * panel->h * (x + 1.0);
    PhasePoint at = {panel->from.t + after, horner(panel->curve.th, N + 1, x), horner(panel->curve.v, N, x), {0.0}};
    for (int k = 0; k < s->model->n_states; k++)
        at.z[k] = s->method[k].kind == RATE_INDEPENDENT
            ? rate_independent_at(s, &panel->from, k, remainder_at(s, &panel->from, k, at.th))
            : horner(panel->curve.state[k].poly, N + 1, x) + transient_after(&panel->curve.state[k], s->relaxation[k], after);
    return at;
}

static double tail_of(const double *rate) {
    double c[2] = {0.0, 0.0};
    for (int k = 0; k < 2; k++)
        for (int j = 0; j < N; j++) c[k] += T_tail[k * N + j] * rate[j];
    return fabs(c[0]) + fabs(c[1]);
}

/* How far the last Legendre coefficients of the rates stand out of their sizes. */
static double truncation(const System *s, const Panel *panel) {
    double most = 0.0;
    for (int block = 0; block < s->blocks; block++) {
        /* the angle is the acceleration's integral twice over, a state its rate's once: that leaves more of the error */
        const double size = size_of_block(s, panel, block, panel->u + block * N);
        most = fmax(most, (block ? 30.0 : 1.0) * tail_of(panel->u + block * N) / size);
    }
    return most;
}

/* How far the equations of motion are missed at N positions of the panel, against their size. */
static double defect_at(const System *s, const Panel *panel, const double *x) {
    double t[N], th[N], v[N], again[N], u[BLOCKS * N], z[MAX_STATES * N] = {0.0}, remaining[N], f[BLOCKS * N], most = 0.0;
    const MotionPoints points = {N, th, v, u, t, z};
    for (int i = 0; i < N; i++) t[i] = panel->from.t + 0.5 * panel->h * (x[i] + 1.0);
    values_and_slopes(panel->curve.th, panel->h, x, th, again);
    values_and_slopes(panel->curve.v, panel->h, x, v, u);
    for (int k = 0; k < s->model->n_states; k++) {
        const StateMethod method = s->method[k];
        if (method.kind == RATE_INDEPENDENT) rate_independent(s, &panel->from, k, th, remaining, z + k * N);
        else if (method.kind != LAG)
            values_and_slopes(panel->curve.state[k].poly, panel->h, x, z + k * N, method.kind == COLLOCATED ? u + method.of * N : again);
    }
    right_hand_side(s, &points, f, NULL);
    for (int block = 0; block < s->blocks; block++) {
        const double *found = f + s->row[block] * N;
        const double size = size_of_block(s, panel, block, found);
        for (int i = 0; i < N; i++) most = fmax(most, fabs(found[i] - u[block * N + i]) / size);
    }
    return most;
}

/* How far the equations of motion are missed between the nodes: what is narrower than the nodes' distance shows nowhere
 * else. Looked at are the panel's start and the middles between the nodes and, where an effect may be narrow in the angle,
 * places closer than NARROW. */
static double defect(const System *s, const Panel *panel) {
    double x[N], most, low = panel->th[0], high = panel->th[0];
    x[0] = -1.0;
    for (int i = 1; i < N; i++) x[i] = T_nodes[i] + T_nodes[i - 1] - 1.0;
    most = defect_at(s, panel, x);
    if (s->localised != IN_ANGLE) return most;
    for (int i = 1; i < N; i++) {
        low = fmin(low, panel->th[i]);
        high = fmax(high, panel->th[i]);
    }
    const int rounds = 1 + (int)fmin(1e4, (high - low) / (N * NARROW));
    for (int round = 0; round < rounds; round++) {
        for (int i = 0; i < N; i++) x[i] = 2.0 * (round * N + i + 0.5) / (rounds * N) - 1.0;
        most = fmax(most, defect_at(s, panel, x));
    }
    return most;
}

static double error_ratio(const System *s, const Panel *panel, double omega) {
    const double part = fmin(1.0, panel->h * omega / PI); /* a short panel adds little, however far it is off */
    double ratio = truncation(s, panel) / (s->coarseness * TRUNCATION);
    if (s->fractional_power) ratio *= BROKEN_POWER_TRUNCATION * part;
    if (s->localised && ratio <= 1.0)
        ratio = fmax(ratio, defect(s, panel) / (s->coarseness * DEFECT) * (s->fractional_power ? BROKEN_POWER_DEFECT : 1.0) * part);
    return ratio;
}
