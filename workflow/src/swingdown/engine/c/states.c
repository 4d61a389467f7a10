#include "states.h"

static void set_linear_states(System *s) {
    const double zero = 0.0;
    const int np = s->model->n_parameters;
    for (int k = 0; k < s->model->n_motions; k++) {
        const PlacedEffect at = s->model->motions[k];
        const Effect *e = &EFFECTS[at.row];
        if (!e->n_states) continue;
        double row[3 * MAX_STATES] = {0.0}, by_parameter[3 * MAX_STATES * MAX_PARAMETERS] = {0.0};
        const Points q = {1, 1, &zero, &zero, &zero, &zero, &zero, &zero, &zero, s->p[0], s->model->duration, s->direction, NULL};
        const Partials partials = {NULL, by_parameter, 0, np, 1};
        e->linear(&q, s->p + at.first_parameter, s->sign + s->first_sign[k], row, at);
        e->linear_partials(&q, s->p + at.first_parameter, s->sign + s->first_sign[k], &partials, at);
        for (int j = 0; j < e->n_states; j++) {
            const int state = at.first_state + j;
            s->relaxation[state] = row[3 * j];
            s->drive[state] = row[3 * j + 1];
            s->gain[state] = row[3 * j + 2];
            memcpy(s->relaxation_by[state], by_parameter + 3 * j * np, np * sizeof(double));
            memcpy(s->drive_by[state], by_parameter + (3 * j + 1) * np, np * sizeof(double));
        }
    }
}

static void rate_independent(const System *s, const PhasePoint *start, int k, const double *th, double *remaining, double *z) {
    for (int i = 0; i < N; i++) {
        remaining[i] = remainder_at(s, start, k, th[i]);
        z[i] = rate_independent_at(s, start, k, remaining[i]);
    }
}

static double rate_independent_by(const System *s, const PhasePoint *start, int k, int parameter, double th, double remaining) {
    const double relaxation_by = s->relaxation_by[k][parameter], drive_by = s->drive_by[k][parameter];
    if (relaxation_by == 0.0 && drive_by == 0.0) return 0.0;
    const double equilibrium_by = (drive_by - s->drive[k] * relaxation_by / s->relaxation[k]) / s->relaxation[k];
    return equilibrium_by * (1.0 - remaining)
         - (start->z[k] - equilibrium(s, k)) * remaining * relaxation_by * (th - start->th);
}

static void solve_lag(const LagProblem *lag, StateCurve *out) {
    double c[N], rate[N];
    memset(out, 0, sizeof *out);
    if (!is_quick(lag->relaxation, lag->h)) {
        for (int i = 0; i < N; i++) c[i] = lag->input[i] - lag->relaxation * lag->z0;
        multiply(lag->inverse, c, rate);
        multiply(T_monomial, rate, c);
        integrate(c, N - 1, lag->h, lag->z0, out->poly);
        return;
    }
    for (int i = 0; i < N; i++) rate[i] = lag->input[i] - lag->gain * lag->th[i];
    multiply(T_monomial, rate, c);
    for (int k = N + 1; k >= 0; k--) { /* relaxation z = input - z', from the highest power down */
        const double rise = k > N ? 0.0 : 2.0 / lag->h * (k + 1) * out->poly[k + 1];
        out->poly[k] = (rise - lag->gain * lag->th_poly[k] - (k < N ? c[k] : 0.0)) / -lag->relaxation;
    }
    out->transient[0] = lag->z0 - horner(out->poly, N + 1, -1.0);
}

static int invert_lag(double relaxation, double h, double *inverse) {
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++) inverse[j * N + i] = (i == j) + h * relaxation * T_first[j * N + i];
    return gauss_jordan(N, inverse);
}

static inline int fades(const StateCurve *state) { return state->transient[0] != 0.0 || state->transient[1] != 0.0; }

static double transient_after(const StateCurve *state, double relaxation, double after) {
    return fades(state) ? (state->transient[0] + state->transient[1] * after) * exp(-relaxation * after) : 0.0;
}

static double state_rate(const StateCurve *state, double relaxation, double h, double x) {
    double value = state->poly[N + 1], slope = 0.0;
    for (int k = N; k >= 0; k--) {
        slope = slope * x + value;
        value = value * x + state->poly[k];
    }
    const double after = 0.5 * h * (x + 1.0);
    return 2.0 / h * slope - relaxation * transient_after(state, relaxation, after)
         + (state->transient[1] != 0.0 ? state->transient[1] * exp(-relaxation * after) : 0.0);
}

static void sample_state(const StateCurve *state, double relaxation, double h, const double *x, int n, double *out) {
    sample(state->poly, N + 1, x, n, out);
    if (!fades(state)) return;
    for (int i = 0; i < n; i++) {
        const double after = 0.5 * h * (x[i] + 1.0);
        if (relaxation * after > 45.0) break; /* below rounding from here on */
        out[i] += transient_after(state, relaxation, after);
    }
}
