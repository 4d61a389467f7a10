#include "system.h"

static void count_switches(System *s) {
    for (int k = 0; k < s->model->n_motions; k++) {
        const Effect *e = &EFFECTS[s->model->motions[k].row];
        s->first_sign[k] = s->n_switches;
        s->n_switches += e->n_switches;
        s->timed |= e->timed;
        s->inertial |= e->inertial;
        s->fractional_power |= e->fractional_power;
        s->localised = e->localised > s->localised ? e->localised : s->localised;
    }
}

static void lay_out_states(System *s, const Effect *e, int first) {
    for (int j = 0; j < e->n_states; j++) {
        StateMethod *method = &s->method[first + j];
        *method = e->method[j];
        s->lags += method->kind == LAG;
        if (method->kind != COLLOCATED) continue;
        method->of = s->blocks;
        s->row[s->blocks++] = 1 + first + j;
    }
    for (int j = 0; j < e->n_states; j++)
        if (e->method[j].kind == INTEGRATED) s->method[first + j].of = s->method[first + e->method[j].of].of;
}

static int set_up_system(System *s, const Model *model, const double *p, int n_free) {
    *s = (System){.model = model, .p = p, .blocks = 1};
    if (model->n_parameters > MAX_PARAMETERS || n_free > MAX_PARAMETERS) return 0;
    if (model->n_states > MAX_STATES || model->n_motions > MAX_EFFECTS) return 0;
    count_switches(s);
    if (s->n_switches > MAX_SWITCHES) return 0;
    for (int k = 0; k < model->n_motions; k++)
        lay_out_states(s, &EFFECTS[model->motions[k].row], model->motions[k].first_state);
    return 1;
}

#define SAME_KNOT 1e-9 /* of a piece: no panel is shorter */

static double choose_piece(System *s, double t) {
    const Input *input = s->model->input;
    if (!input) return INFINITY;
    const double delay = s->model->input_delay < 0 ? 0.0 : s->p[s->model->input_delay];
    const double *knots = input->knots;
    int k = s->piece;
    while (k + 1 < input->n_pieces && t - delay > knots[k + 1] - SAME_KNOT * (knots[k + 2] - knots[k + 1])) k++;
    s->piece = k;
    return k + 1 < input->n_pieces ? knots[k + 1] + delay : INFINITY;
}

static void sample_input(const System *s, int n, const double *t, double *out) {
    const Input *input = s->model->input;
    const double delay = s->model->input_delay < 0 ? 0.0 : s->p[s->model->input_delay];
    const double since = input->knots[s->piece] + delay, *c = input->coefficients + 4 * (size_t)s->piece;
    for (int i = 0; i < n; i++) {
        const double x = t[i] - since;
        out[i] = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
        out[N + i] = c[1] + x * (2.0 * c[2] + x * 3.0 * c[3]);
        out[2 * N + i] = 2.0 * c[2] + x * 6.0 * c[3];
        out[3 * N + i] = 6.0 * c[3];
    }
}

static void right_hand_side(const System *s, const MotionPoints *at, double *out, double *share) {
    double sn[N], cs[N], u[INPUT_ROWS * N], sum[(1 + BLOCKS) * N]; /* torque, inertia, states' rates */
    const int nz = s->model->n_states;
    for (int i = 0; i < at->n; i++) sine_cosine(at->th[i], &sn[i], &cs[i]);
    if (s->model->input) sample_input(s, at->n, at->t, u);
    memset(sum, 0, (2 + nz) * N * sizeof(double));
    for (int k = 0; k < s->model->n_motions; k++) {
        const PlacedEffect e = s->model->motions[k];
        const Points q = {at->n, N, at->th, at->v, at->a, at->t, sn, cs, at->z + e.first_state * N,
                          s->p[0], s->model->duration, s->direction, u};
        EFFECTS[e.row].motion(&q, s->p + e.first_parameter, s->sign + s->first_sign[k], sum, e);
    }
    if (s->inertial)
        for (int i = 0; i < at->n; i++) {
            const double part = 1.0 / (1.0 + sum[N + i]);
            if (share) share[i] = part;
            sum[i] *= part;
        }
    if (s->stuck)
        for (int i = 0; i < at->n; i++) sum[i] = 0.0;
    memcpy(out, sum, N * sizeof(double));
    memcpy(out + N, sum + 2 * N, nz * N * sizeof(double));
}

static double rates_at(System *s, const PhasePoint *x, double direction, double *out) {
    double z[MAX_STATES * N], rows[BLOCKS * N], a = 0.0;
    const MotionPoints at = {1, &x->th, &x->v, &a, &x->t, z};
    const double kept = s->direction;
    s->direction = direction;
    for (int k = 0; k < s->model->n_states; k++) z[k * N] = x->z[k];
    for (int again = 0; again < (s->model->n_states && out ? 2 : 1); again++) {
        right_hand_side(s, &at, rows, NULL);
        a = rows[0];
    }
    for (int k = 0; out && k <= s->model->n_states; k++) out[k] = rows[k * N];
    s->direction = kept;
    return a;
}

static void switch_values(const System *s, const MotionPoints *at, double *out) {
    double sn[N], cs[N], u[INPUT_ROWS * N];
    for (int i = 0; i < at->n; i++) sine_cosine(at->th[i], &sn[i], &cs[i]);
    if (s->model->input) sample_input(s, at->n, at->t, u);
    for (int k = 0; k < s->model->n_motions; k++) {
        const PlacedEffect e = s->model->motions[k];
        const Points q = {at->n, N, at->th, at->v, at->v, at->t, sn, cs, at->z + e.first_state * N,
                          s->p[0], s->model->duration, s->direction, u};
        if (EFFECTS[e.row].n_switches)
            EFFECTS[e.row].switches(&q, s->p + e.first_parameter, s->sign + s->first_sign[k], out + s->first_sign[k] * N, e);
    }
}

static void switches_at(const System *s, const PhasePoint *x, double *out) {
    double z[MAX_STATES * N], rows[MAX_SWITCHES * N];
    const MotionPoints at = {1, &x->th, &x->v, &x->v, &x->t, z};
    for (int k = 0; k < s->model->n_states; k++) z[k * N] = x->z[k];
    switch_values(s, &at, rows);
    for (int k = 0; k < s->n_switches; k++) out[k] = rows[k * N];
}
