#include "reading.h"

#define CHUNK 64 /* samples at a time */

static inline int smaller(int a, int b) { return a < b ? a : b; }

/* One clock's true times of up to CHUNK samples, in place; slopes: those of the chunk, rows of n_times. */
static void apply_clock(const InitialValueProblem *problem, PlacedEffect at, const FreeValues *free, int size,
                        double *times, double *slopes) {
    const Model *m = problem->model;
    const Effect *e = &EFFECTS[at.row];
    const double *p = problem->parameters;
    double stamped[CHUNK], zero[CHUNK] = {0.0}, by[CHUNK] = {0.0}, by_parameter[MAX_PARAMETERS * CHUNK];
    memcpy(stamped, times, size * sizeof(double));
    const Points q = {size, CHUNK, zero, zero, zero, stamped, zero, zero, zero, p[0], m->duration, 1.0, NULL};
    memset(times, 0, size * sizeof(double));
    e->reading(&q, p + at.first_parameter, NULL, times, at);
    if (!slopes) return;
    memset(by_parameter, 0, m->n_parameters * CHUNK * sizeof(double));
    const Partials d = {by, by_parameter, 1, m->n_parameters, CHUNK};
    e->reading_partials(&q, p + at.first_parameter, NULL, &d, at);
    for (int f = 0; f < free->n_free; f++)
        for (int i = 0; i < size; i++) {
            double *slope = slopes + (size_t)f * problem->n_times + i;
            *slope = *slope * by[i] + (free->free_values[f] >= 0 ? by_parameter[free->free_values[f] * CHUNK + i] : 0.0);
        }
}

static int true_times(const InitialValueProblem *problem, const FreeValues *free, double *out, double *slopes) {
    const int n = problem->n_times;
    for (int i = 0; i < n; i++) out[i] = problem->times[i] - problem->times[0];
    if (slopes) memset(slopes, 0, (size_t)free->n_free * n * sizeof(double));
    for (int c = 0; c < problem->model->n_clocks; c++)
        for (int start = 0; start < n; start += CHUNK)
            apply_clock(problem, problem->model->clocks[c], free, smaller(n - start, CHUNK), out + start, slopes ? slopes + start : NULL);
    for (int i = 1; i < n; i++)
        if (!(out[i] > out[i - 1])) return 0;
    return 1;
}

/* The slopes of a chunk from `start` on, by the chain rule from the sensor's partial derivatives. */
static void chain_slopes(const InitialValueProblem *problem, const FreeValues *free, const Readings *readings, int start, int size,
                         const Partials *d) {
    const int n = problem->n_times, nz = problem->model->n_states;
    for (int f = 0; f < free->n_free; f++) {
        double *row = readings->slopes + (size_t)f * n + start;
        for (int i = 0; i < size; i++) row[i] *= d->by_input[i];
        for (int j = 0; readings->states && j < nz; j++) {
            const double *state_row = readings->state_slopes + ((size_t)j * free->n_free + f) * n + start;
            for (int i = 0; i < size; i++) row[i] += d->by_input[(3 + j) * CHUNK + i] * state_row[i];
        }
        if (free->free_values[f] >= 0)
            for (int i = 0; i < size; i++) row[i] += d->by_parameter[free->free_values[f] * CHUNK + i];
    }
}

/* One sensor's reading of up to CHUNK samples from `start` on. */
static void apply_sensor(const InitialValueProblem *problem, PlacedEffect at, const FreeValues *free, const Readings *readings,
                         int start, int size) {
    const Model *m = problem->model;
    const Effect *e = &EFFECTS[at.row];
    const double *p = problem->parameters, *times = problem->times;
    const int nz = m->n_states, inputs = 3 + nz;
    double th[CHUNK], sn[CHUNK], cs[CHUNK], t[CHUNK], zero[CHUNK] = {0.0}, states[(MAX_STATES + 1) * CHUNK];
    double by[(3 + MAX_STATES) * CHUNK], by_parameter[MAX_PARAMETERS * CHUNK];
    double *y = readings->angles + start;
    memcpy(th, y, size * sizeof(double));
    for (int i = 0; i < size; i++) {
        sine_cosine(th[i], &sn[i], &cs[i]);
        t[i] = times[start + i] - times[0];
    }
    for (int j = 0; readings->states && j < nz; j++)
        memcpy(states + j * CHUNK, readings->states + (size_t)j * problem->n_times + start, size * sizeof(double));
    const Points q = {size, CHUNK, th, zero, zero, t, sn, cs, states + at.first_state * CHUNK, p[0], m->duration, 1.0, NULL};
    memset(y, 0, size * sizeof(double));
    e->reading(&q, p + at.first_parameter, NULL, y, at);
    if (!readings->slopes) return;
    memset(by, 0, inputs * CHUNK * sizeof(double));
    memset(by_parameter, 0, m->n_parameters * CHUNK * sizeof(double));
    const Partials d = {by, by_parameter, inputs, m->n_parameters, CHUNK};
    e->reading_partials(&q, p + at.first_parameter, NULL, &d, at);
    chain_slopes(problem, free, readings, start, size, &d);
}

static void read_sensors(const InitialValueProblem *problem, const FreeValues *free, const Readings *readings) {
    const int n = problem->n_times;
    for (int k = 0; k < problem->model->n_sensors; k++)
        for (int start = 0; start < n; start += CHUNK)
            apply_sensor(problem, problem->model->sensors[k], free, readings, start, smaller(n - start, CHUNK));
}

static void push_play(Play *play, double half, double th, const FreeValues *free, const double *slopes, size_t stride) {
    const double side = play->reading > th + half ? 1.0 : (play->reading < th - half ? -1.0 : 0.0);
    if (side == 0.0) return;
    play->reading = th + side * half;
    for (int f = 0; f < free->n_free; f++)
        play->slope[f] = slopes[f * stride] + side * 0.5 * (free->free_values[f] == play->parameter);
}
