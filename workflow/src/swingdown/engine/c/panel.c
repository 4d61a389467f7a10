#include "panel.h"

#define SOLVED 1e-12 /* residual of the collocation equations against their size, after the last sweep */
#define SWEEPS 14

/* The states at the nodes, from the unknowns; a lag counts as zero, so that its rate is what drives it. */
static void states_at_nodes(const System *s, Panel *panel) {
    double once[N], twice[N];
    const double h = panel->h;
    for (int k = 0; k < s->model->n_states; k++) {
        double *z = panel->z + k * N;
        const double *rate = panel->u + s->method[k].of * N, start = panel->from.z[k];
        switch (s->method[k].kind) {
        case COLLOCATED:
            multiply(T_first, rate, once);
            for (int i = 0; i < N; i++) z[i] = start + h * once[i];
            break;
        case INTEGRATED: {
            const double rate_at_start = panel->from.z[s->row[s->method[k].of] - 1];
            multiply(T_second, rate, twice);
            for (int i = 0; i < N; i++) z[i] = start + h * (rate_at_start * T_nodes[i] + h * twice[i]);
            break;
        }
        case LAG:
            for (int i = 0; i < N; i++) z[i] = 0.0;
            break;
        default: rate_independent(s, &panel->from, k, panel->th, panel->remaining + k * N, z);
        }
    }
}

static void motion_at_nodes(const System *s, Panel *panel) {
    double once[N], twice[N];
    multiply(T_first, panel->u, once);
    multiply(T_second, panel->u, twice);
    for (int i = 0; i < N; i++) {
        panel->v[i] = panel->from.v + panel->h * once[i];
        panel->th[i] = panel->from.th + panel->h * (panel->from.v * T_nodes[i] + panel->h * twice[i]);
    }
    states_at_nodes(s, panel);
}

/* What the right-hand side makes of the unknowns, less the unknowns; the largest of it against its size, or -1 where it is
 * not finite. */
static double residuals(const System *s, const Panel *panel, double *residual) {
    double f[BLOCKS * N], error = 0.0;
    const MotionPoints nodes = nodes_of(panel);
    right_hand_side(s, &nodes, f, NULL);
    for (int k = 0; k < s->blocks; k++) {
        const double *found = f + s->row[k] * N;
        for (int i = 0; i < N; i++) residual[k * N + i] = found[i] - panel->u[k * N + i];
        if (!all_finite(residual + k * N)) return -1.0;
        error = fmax(error, largest(residual + k * N) / size_of_block(s, panel, k, found));
    }
    return error;
}

static int solve_panel(const System *s, Panel *panel, TrajectoryReport *report) {
    double residual[BLOCKS * N], step[BLOCKS * N], last = 0.0;
    int fresh = 0; /* the inverse is of this sweep or the one before */
    for (int i = 0; i < N; i++) panel->t[i] = panel->from.t + panel->h * T_nodes[i];
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        motion_at_nodes(s, panel);
        const double error = residuals(s, panel, residual);
        report->evaluations++;
        if (error < 0.0) return 0;
        /* the step about to be taken leaves an error smaller by the factor that the last one gained */
        const int solved = error * fmin(1.0, error / last) <= SOLVED * s->coarseness;
        const int slow = !solved && sweep && error > 0.2 * last && !fresh;
        if (!panel->has_inverse || slow) {
            if (!linearise(s, panel)) return 0;
            fresh = 2;
        }
        apply_inverse(panel, s->blocks, residual, step);
        for (int i = 0; i < s->blocks * N; i++) panel->u[i] += step[i];
        if (solved) {
            motion_at_nodes(s, panel);
            return 1;
        }
        last = error;
        if (fresh) fresh--;
    }
    return 0;
}

static int invert_lags(const System *s, Panel *panel) {
    for (int k = 0; k < s->model->n_states; k++) {
        if (s->method[k].kind != LAG || is_quick(s->relaxation[k], panel->h)) continue;
        if (!invert_lag(s->relaxation[k], panel->h, panel->lag_inverse[k])) return 0;
    }
    return 1;
}
