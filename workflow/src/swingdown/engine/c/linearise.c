/* The derivatives of the right-hand side at the nodes of a panel, and the inverse of the collocation equations. */
#include "panel.h"

/* The effects' partial derivatives, added up: rows torque, inertia, states' rates. */
static void add_partials(const System *s, const Panel *panel, const Partials *d) {
    double sn[N], cs[N], u[INPUT_ROWS * N];
    for (int i = 0; i < N; i++) sine_cosine(panel->th[i], &sn[i], &cs[i]);
    if (s->model->input) sample_input(s, N, panel->t, u);
    for (int k = 0; k < s->model->n_motions; k++) {
        const PlacedEffect at = s->model->motions[k];
        const Points q = {N, N, panel->th, panel->v, panel->u, panel->t, sn, cs, panel->z + at.first_state * N,
                          s->p[0], s->model->duration, s->direction, u};
        EFFECTS[at.row].motion_partials(&q, s->p + at.first_parameter, s->sign + s->first_sign[k], d, at);
    }
}

/* The acceleration is torque / (1 + inertia): rows 0 and 1 of n columns become its derivatives in row 0. */
static void divide_by_inertia(double *by, int n, const double *acceleration, const double *share) {
    for (int k = 0; k < n; k++)
        for (int i = 0; i < N; i++) by[k * N + i] = (by[k * N + i] - acceleration[i] * by[(n + k) * N + i]) * share[i];
}

/* A rate-independent state is a closed form in the angle: what depends on it depends on the angle, here and at the panel's
 * start, and on its parameters. */
static void substitute_rate_independent(const System *s, Panel *panel, int k) {
    const int nz = s->model->n_states, inputs = 3 + nz, np = s->model->n_parameters;
    for (int row = 0; row <= nz; row++)
        for (int i = 0; i < N; i++) {
            double *by_state = panel->by + (row * inputs + 3 + k) * N + i;
            if (*by_state == 0.0) continue;
            const double by_angle = -s->relaxation[k] * (panel->z[k * N + i] - equilibrium(s, k));
            const double remaining = panel->remaining[k * N + i];
            panel->by[row * inputs * N + i] += *by_state * by_angle;
            panel->by_start[row * N + i] -= *by_state * by_angle;
            for (int p = 0; p < np; p++) {
                const double by_parameter = rate_independent_by(s, &panel->from, k, p, panel->th[i], remaining);
                panel->by_parameter[(row * np + p) * N + i] += *by_state * by_parameter;
            }
            *by_state *= remaining;
        }
}

static void partials_at_nodes(const System *s, Panel *panel) {
    double by[(1 + BLOCKS) * (3 + MAX_STATES) * N];
    const int nz = s->model->n_states, inputs = 3 + nz, np = s->model->n_parameters, rows = 2 + nz;
    const int plain = !s->inertial && !nz; /* then the parameters' rows are where the effects write them */
    double room[plain ? 1 : (1 + BLOCKS) * MAX_PARAMETERS * N];
    double *by_parameter = plain ? panel->by_parameter : room;
    memset(by, 0, rows * inputs * N * sizeof(double));
    memset(by_parameter, 0, (plain ? 1 : rows) * np * N * sizeof(double));
    const Partials d = {by, by_parameter, inputs, np, N};
    add_partials(s, panel, &d);
    if (s->inertial) {
        double f[BLOCKS * N], share[N];
        const MotionPoints nodes = nodes_of(panel);
        right_hand_side(s, &nodes, f, share);
        divide_by_inertia(by, inputs, f, share);
        divide_by_inertia(by_parameter, np, f, share);
    }
    if (s->stuck) {
        memset(by, 0, inputs * N * sizeof(double));
        memset(by_parameter, 0, np * N * sizeof(double));
    }
    memcpy(panel->by, by, inputs * N * sizeof(double));
    memcpy(panel->by + inputs * N, by + 2 * inputs * N, nz * inputs * N * sizeof(double));
    if (!plain) {
        memcpy(panel->by_parameter, by_parameter, np * N * sizeof(double));
        memcpy(panel->by_parameter + np * N, by_parameter + 2 * np * N, nz * np * N * sizeof(double));
    }
    memset(panel->by_start, 0, (1 + nz) * N * sizeof(double));
    for (int k = 0; k < nz; k++)
        if (s->method[k].kind == RATE_INDEPENDENT) substitute_rate_independent(s, panel, k);
}

/* What a block's rate is integrated to, once and twice, among the inputs of the right-hand side; twice: or -1. */
static void integrals_of(const System *s, int block, int *once, int *twice) {
    *once = block ? 3 + s->row[block] - 1 : 1;
    *twice = block ? -1 : 0;
    for (int k = 0; block && k < s->model->n_states; k++)
        if (s->method[k].kind == INTEGRATED && s->method[k].of == block) *twice = 3 + k;
}

/* Of 1 - d(rates)/d(unknowns): the columns of one block, in the rows of another. */
static void fill_block(const System *s, Panel *panel, int block, int of) {
    const int size = s->blocks * N;
    const double h = panel->h, *by = panel->by + s->row[of] * (3 + s->model->n_states) * N;
    int once, twice;
    integrals_of(s, block, &once, &twice);
    const double *by_once = by + once * N, *by_twice = by + twice * N;
    for (int j = 0; j < N; j++) {
        double *column = panel->inverse + (block * N + j) * size + of * N;
        if (twice >= 0)
            for (int i = 0; i < N; i++)
                column[i] = -h * (h * by_twice[i] * T_second[j * N + i] + by_once[i] * T_first[j * N + i]);
        else
            for (int i = 0; i < N; i++) column[i] = -h * by_once[i] * T_first[j * N + i];
        if (block == 0) column[j] -= by[2 * N + j];
        if (block == of) column[j] += 1.0;
    }
}

static int linearise(const System *s, Panel *panel) {
    partials_at_nodes(s, panel);
    for (int block = 0; block < s->blocks; block++)
        for (int of = 0; of < s->blocks; of++) fill_block(s, panel, block, of);
    panel->has_inverse = s->blocks > 1 ? gauss_jordan(s->blocks * N, panel->inverse) : gauss_jordan(N, panel->inverse);
    return panel->has_inverse;
}
