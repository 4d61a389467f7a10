#include "record.h"

#include <stdlib.h>

static int open_record(Record *r, const InitialValueProblem *problem, double *angles, double *slopes) {
    const Model *m = problem->model;
    const size_t n = problem->n_times;
    *r = (Record){.problem = problem, .angles = angles, .slopes = slopes};
    r->free = (FreeValues){slopes ? problem->n_free : 0, problem->free_values};
    for (int k = 0; k < m->n_sensors; k++)
        if (EFFECTS[m->sensors[k].row].n_states) r->n_states = m->n_states;
    const size_t n_free = r->free.n_free, n_clock = m->n_clocks ? n_free : 0;
    r->memory = malloc((ROOM + n * (3 + n_clock + r->n_states * (1 + n_free))) * sizeof(double));
    if (!r->memory) return NO_MEMORY;
    r->times = r->memory;
    r->positions = r->times + n;
    r->velocities = r->positions + n;
    if (n_clock) r->clock_slopes = r->velocities + n;
    if (r->n_states) r->states = r->velocities + n * (1 + n_clock);
    if (r->n_states) r->state_slopes = r->states + r->n_states * n;
    return true_times(problem, &r->free, r->times, r->clock_slopes) ? DONE : CLOCK_RUNS_BACK;
}

static void close_record(Record *r) { free(r->memory); }

static inline double *slopes_of(const Record *r, int f) { return r->slopes + (size_t)f * r->problem->n_times; }

static inline double *state_slopes_of(const Record *r, int k, int f) {
    return r->state_slopes + ((size_t)k * r->free.n_free + f) * r->problem->n_times;
}

/* A sample that comes later, for the clock's parameters, sees the states move on. */
static void move_states_by_clock(Record *r, const System *s, const Panel *panel, int last) {
    for (int k = 0; k < r->n_states; k++)
        for (int i = r->next; i < last; i++) {
            const double rate = state_rate(&panel->curve.state[k], s->relaxation[k], panel->h, r->positions[i]);
            for (int f = 0; f < r->free.n_free; f++)
                state_slopes_of(r, k, f)[i] += rate * r->clock_slopes[(size_t)f * r->problem->n_times + i];
        }
}

/* How fast what is read changes: the velocity, or where that is read the acceleration. */
static void sample_changes(Record *r, const Panel *panel, const double *x, int size) {
    double a[N];
    const int rate = r->problem->model->reads_rate;
    for (int k = 0; k < N; k++) a[k] = (k + 1) * panel->curve.v[k + 1] * 2.0 / panel->h;
    sample(rate ? a : panel->curve.v, rate ? N - 1 : N, x, size, r->velocities + r->next);
}

static void read_play(Record *r, int last) {
    const double half = 0.5 * r->problem->parameters[r->play.parameter];
    for (int i = r->next; i < last; i++) {
        push_play(&r->play, half, r->angles[i], &r->free, r->slopes + i, r->problem->n_times);
        r->angles[i] = r->play.reading;
        for (int f = 0; f < r->free.n_free; f++) slopes_of(r, f)[i] = r->play.slope[f];
    }
}

/* once a panel, so a call of its own shows in a fit's time */
ALWAYS_INLINE void read_panel(Record *r, const System *s, const Panel *panel, const Sensitivities *d, double t_end) {
    int last = r->next;
    while (last < r->problem->n_times && r->times[last] <= t_end) last++;
    const int next = r->next, size = last - next, rate = r->problem->model->reads_rate;
    const double h = panel->h, per_second = 2.0 / h, *x = r->positions + next;
    for (int i = next; i < last; i++) r->positions[i] = (r->times[i] - panel->from.t) * per_second - 1.0;
    sample(rate ? panel->curve.v : panel->curve.th, rate ? N : N + 1, x, size, r->angles + next);
    if (r->clock_slopes) sample_changes(r, panel, x, size);
    for (int k = 0; k < r->n_states; k++)
        sample_state(&panel->curve.state[k], s->relaxation[k], h, x, size, r->states + (size_t)k * r->problem->n_times + next);
    for (int f = 0; f < r->free.n_free; f++) {
        sample(rate ? d->curve[f].v : d->curve[f].th, rate ? N : N + 1, x, size, slopes_of(r, f) + next);
        for (int k = 0; k < r->n_states; k++)
            sample_state(&d->curve[f].state[k], s->relaxation[k], h, x, size, state_slopes_of(r, k, f) + next);
    }
    if (r->clock_slopes) move_states_by_clock(r, s, panel, last);
    if (r->play.parameter >= 0) read_play(r, last);
    r->next = last;
}

static void push_play_on(Record *r, double th, const double *th_slopes) {
    if (r->play.parameter >= 0)
        push_play(&r->play, 0.5 * r->problem->parameters[r->play.parameter], th, &r->free, th_slopes, 1);
}

static void read_rest(Record *r, double th, const double *th_slopes) {
    const int plays = r->play.parameter >= 0, rate = r->problem->model->reads_rate;
    for (; r->next < r->problem->n_times; r->next++) {
        r->angles[r->next] = rate ? 0.0 : plays ? r->play.reading : th;
        r->velocities[r->next] = 0.0;
        for (int f = 0; f < r->free.n_free; f++)
            slopes_of(r, f)[r->next] = rate ? 0.0 : plays ? r->play.slope[f] : th_slopes[f];
    }
}

static void finish_record(Record *r, int status) {
    const int n = r->problem->n_times, n_free = r->free.n_free;
    if (status != DONE) {
        for (int i = r->next; i < n; i++) r->angles[i] = NAN;
        for (size_t i = 0; i < (size_t)n_free * n; i++) r->slopes[i] = NAN;
        return;
    }
    for (int f = 0; f < n_free && r->clock_slopes; f++)
        for (int i = 0; i < n; i++) slopes_of(r, f)[i] += r->velocities[i] * r->clock_slopes[(size_t)f * n + i];
    const Readings readings = {r->angles, n_free ? r->slopes : NULL, r->states, r->state_slopes};
    read_sensors(r->problem, &r->free, &readings);
}
