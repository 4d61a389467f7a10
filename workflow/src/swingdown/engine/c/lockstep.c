#include "lockstep.h"

#include <stdlib.h>

#include "events.h"

#define PANEL_PHASE 1.2  /* rad of the swing that a panel takes at most */
#define SHORTER 0.75     /* it is tried again */
#define LENGTHS 8        /* that are tried */
#define SPARE_PANELS 1.5 /* for one where there would be none more */
#define FIRST_ERROR 0.4  /* of the first solution's panels: what the limit leaves for the others to differ */
#define MOST_NUMBERS 4e5 /* of the solutions kept, for each lane */

/* ---- What the fits are ---- */

/* Whether this is for the model; directed: whether its motion depends on the velocity's sign. */
static int model_is_for_lockstep(const Model *m, int *directed) {
    *directed = 0;
    if (m->n_states || m->n_clocks || m->play >= 0 || m->reads_rate || m->n_motions > MAX_EFFECTS) return 0;
    for (int k = 0; k < m->n_motions; k++) {
        if (!EFFECTS[m->motions[k].row].lockstep) return 0;
        *directed |= EFFECTS[m->motions[k].row].directed;
    }
    for (int k = 0; k < m->n_sensors; k++)
        if (!EFFECTS[m->sensors[k].row].affine) return 0;
    return m->n_parameters <= MAX_PARAMETERS;
}

/* Whether the motion changes by a parameter. */
static int is_of_motion(const Model *m, int parameter) {
    for (int k = 0; k < m->n_motions; k++) {
        const int first = m->motions[k].first_parameter;
        if (parameter >= first && parameter < first + EFFECTS[m->motions[k].row].n_parameters) return 1;
    }
    return parameter == 0;
}

/* 0 where they are too many, or two of them are one variable. */
static int find_free_slots(const Batch *batch, FreeSlots *free) {
    const Model *m = batch->model;
    const int np = m->n_parameters;
    free->n = 0;
    if (batch->n_variables > MOST_FREE) return 0;
    for (int i = 0; i < np + 2; i++) {
        if (batch->variable_of[i] < 0) continue;
        if (free->n == batch->n_variables) return 0;
        free->value[free->n] = i;
        free->moves[free->n] = i >= np || is_of_motion(m, i);
        free->variable[free->n++] = batch->variable_of[i];
    }
    return free->n == batch->n_variables && free->n > 0;
}

static Which evaluate_all(Lockstep *s, Which which, int has_last) {
    return s->directed ? evaluate_swings(s, which, has_last) : evaluate_lockstep(s, which, has_last);
}

/* ---- The point from which the batch starts ---- */

static double product_of(const double *a, const double *b, int n) {
    double part[8] = {0.0};
    int i = 0;
    for (; i + 8 <= n; i += 8)
        for (int j = 0; j < 8; j++) part[j] += a[i + j] * b[i + j];
    for (int j = 0; i < n; i++, j++) part[j] += a[i] * b[i];
    return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
}

/* Its solution, to the accuracy that leaves room for others; 0 where there is none. */
static int solve_first(Lockstep *s, const double *values) {
    const int n = s->free.n, np = s->batch->model->n_parameters, size = s->n_rows;
    for (int i = 0; i < np + 2; i++) s->values[i] = each(values[i]);
    for (int l = 0; l < WIDTH; l++) set_sensors(s, l);
    s->system.most_error = FIRST_ERROR;
    const Which all = (Which)(each(0.0) == each(0.0));
    if (!any(evaluate_all(s, all, 0))) return 0;
    s->system.most_error = 1.0;
    for (int i = 0; i < s->n_kept; i++) s->first_kept[i] = s->kept[i][0];
    for (int f = 0; f < n; f++) {
        s->first[f] = values[s->free.value[f]];
        for (int g = 0; g <= f; g++)
            s->first_normal[f * n + g] = product_of(s->first_slopes + (size_t)f * size, s->first_slopes + (size_t)g * size, size);
    }
    return 1;
}

/* ---- Lanes ---- */

/* Half the sum of squares and its slopes at the first point, for the series in s->series. */
static void take_first_value(Lockstep *s, int lane) {
    LaneFit *fit = &s->fits[lane];
    const int n = s->free.n, size = s->n_rows;
    for (int i = 0; i < size; i++) s->series[i] = s->first_angles[i] - s->series[i];
    const double squares = s->missed[lane] + product_of(s->series, s->series, size);
    for (int f = 0; f < n; f++) {
        const int at = s->free.variable[f];
        fit->at.gradient[at] = product_of(s->first_slopes + (size_t)f * size, s->series, size);
        for (int g = 0; g <= f; g++) {
            const int other = s->free.variable[g];
            fit->at.normal[at * n + other] = fit->at.normal[other * n + at] = s->first_normal[f * n + g];
        }
    }
    take_value(&fit->search, 0.5 * squares);
}

static void take_lane_value(Lockstep *s, int lane) {
    LaneFit *fit = &s->fits[lane];
    const int n = s->free.n;
    for (int f = 0; f < n; f++) {
        const int at = s->free.variable[f];
        fit->at.gradient[at] = s->gradient[f][lane];
        for (int g = 0; g <= f; g++) {
            const int other = s->free.variable[g];
            fit->at.normal[at * n + other] = fit->at.normal[other * n + at] = s->normal[f * n + g][lane];
        }
    }
    take_value(&fit->search, 0.5 * s->squares[lane]);
}

/* Put the next series into a lane, at its first point. */
static void load_lane(Lockstep *s, int lane) {
    const Batch *batch = s->batch;
    const int n = s->free.n, np = batch->model->n_parameters;
    LaneFit *fit = &s->fits[lane];
    fit->series = s->next++;
    const double *given = batch->values + (size_t)fit->series * (np + 2);
    const double *series = batch->series + (size_t)fit->series * batch->n_samples;
    if (s->directed) {
        s->series_of[lane] = series;
        memcpy(s->series, series, s->n_rows * sizeof(double));
    } else {
        s->missed[lane] = compress(&s->record, series, s->series);
        for (int i = 0; i < s->n_rows; i++) s->data[i][lane] = s->series[i];
    }
    for (int i = 0; i < s->n_kept; i++) s->kept[i][lane] = s->first_kept[i];
    for (int i = 0; i < np + 2; i++) s->values[i][lane] = given[i];
    for (int f = 0; f < n; f++) {
        s->last.x[f][lane] = s->first[f];
        fit->x[s->free.variable[f]] = given[s->free.value[f]];
    }
    begin_search(&fit->search, &s->problem, NULL, 1, fit->room, fit->x, fit->normal, &fit->outcome);
    fit->at = next_point(&fit->search);
}

/* Whether a lane's point, and what is not variable, is the first of the batch. */
static int is_at_first(const Lockstep *s, int lane) {
    const LaneFit *fit = &s->fits[lane];
    const int np = s->batch->model->n_parameters;
    const double *given = s->batch->values + (size_t)fit->series * (np + 2);
    for (int f = 0; f < s->free.n; f++)
        if (fit->at.x[s->free.variable[f]] != s->first[f]) return 0;
    for (int i = 0; i < np + 2; i++)
        if (s->batch->variable_of[i] < 0 && given[i] != s->batch->guess[i]) return 0;
    return 1;
}

/* Keep what a lane's search came to; the fits that did not end at a minimum are left. */
static void keep_result(const Lockstep *s, int lane, BatchResult *result) {
    const LaneFit *fit = &s->fits[lane];
    const size_t n = s->free.n;
    if (fit->outcome.converged != STATIONARY) return;
    result->alone[fit->series] = 0;
    memcpy(result->variables + fit->series * n, fit->x, n * sizeof(double));
    result->squares[fit->series] = 2.0 * fit->search.value;
    result->converged[fit->series] = STATIONARY;
    result->evaluations[fit->series] = fit->outcome.evaluations;
}

/* A lane gets series until one has a point that is to be computed, or none is left. */
static void fill_lane(Lockstep *s, int lane, BatchResult *result) {
    LaneFit *fit = &s->fits[lane];
    while (1) {
        if (fit->series >= 0) {
            if (fit->at.x) return;
            keep_result(s, lane, result);
        }
        fit->series = -1;
        if (s->next >= s->batch->n_series) return;
        load_lane(s, lane);
        if (!is_at_first(s, lane)) return;
        take_first_value(s, lane);
        fit->at = next_point(&fit->search);
    }
}

static void run_lanes(Lockstep *s, BatchResult *result) {
    for (int l = 0; l < WIDTH; l++) fill_lane(s, l, result);
    while (1) {
        Which which = {0};
        for (int l = 0; l < WIDTH; l++) {
            if (s->fits[l].series < 0) continue;
            which[l] = -1;
            for (int f = 0; f < s->free.n; f++) s->values[s->free.value[f]][l] = s->fits[l].at.x[s->free.variable[f]];
            set_sensors(s, l);
        }
        if (!any(which)) return;
        const Which found = evaluate_all(s, which, 1);
        for (int l = 0; l < WIDTH; l++) {
            LaneFit *fit = &s->fits[l];
            if (!which[l]) continue;
            if (found[l]) {
                take_lane_value(s, l);
                fit->at = next_point(&fit->search);
            } else fit->series = -1;
            fill_lane(s, l, result);
        }
    }
}

/* ---- The batch ---- */

/* Memory for the panels, in one piece; 0 where there is none. */
static int open_lockstep(Lockstep *s, void **memory) {
    const size_t n = s->free.n, panels = s->record.n_panels, nodes = panels * LN;
    const size_t data = s->directed ? 0 : panels * TERMS, rows = s->n_rows = s->directed ? (size_t)s->batch->n_samples : data;
    const size_t kept = s->n_kept = s->directed ? nodes + panels : nodes * (1 + n);
    const size_t of_each = kept + data + (1 + n) * TERMS;
    const size_t numbers = kept + rows * (2 + n) + WIDTH * search_room(s->problem.n_variables);
    *memory = malloc((of_each * WIDTH + numbers + WIDTH) * sizeof(double));
    if (!*memory) return 0;
    Each *room = (Each *)(((size_t)*memory + sizeof(Each) - 1) / sizeof(Each) * sizeof(Each));
    memset(room, 0, of_each * sizeof(Each));
    s->kept = s->last.u = room;
    s->last.changes = s->durations = room + nodes;
    s->data = room + kept;
    s->angles = s->data + data;
    s->first_kept = (double *)(s->angles + (1 + n) * TERMS);
    s->first_angles = s->first_kept + kept;
    s->first_slopes = s->first_angles + rows;
    s->series = s->first_slopes + rows * n;
    for (int l = 0; l < WIDTH; l++) s->fits[l].room = s->series + rows + l * search_room(s->problem.n_variables);
    return 1;
}

/* The batch with panels of at most this length (s); whether that is short enough. */
static int fit_with_panels(Lockstep *s, double longest, const double *first, BatchResult *result) {
    const Batch *batch = s->batch;
    const double seconds = batch->times[batch->n_samples - 1] - batch->times[0];
    void *memory = NULL;
    int ready = 1;
    if (s->directed) {
        s->parts = (int)ceil(s->half_swing / longest);
        s->record = (LockstepRecord){.n_panels = (int)(SPARE_PANELS * (seconds / longest + 2.0 * s->parts)), .h = longest};
    } else ready = open_lockstep_record(&s->record, batch->times, batch->n_samples, longest);
    const int enough = ready && open_lockstep(s, &memory) && solve_first(s, first);
    if (enough) run_lanes(s, result);
    close_lockstep_record(&s->record);
    free(memory);
    return enough;
}

static int fit_in_lockstep(const Batch *batch, const SearchOptions *options, BatchResult *result) {
    const int np = batch->model->n_parameters, n = batch->n_samples;
    int directed;
    for (int k = 0; k < batch->n_series; k++) result->alone[k] = 1;
    FreeSlots slots;
    if (!batch->n_series || n < 2 || !model_is_for_lockstep(batch->model, &directed) || !find_free_slots(batch, &slots)) return DONE;
    void *memory = malloc(sizeof(Lockstep) + sizeof(Each));
    if (!memory) return NO_MEMORY;
    Lockstep *s = (Lockstep *)(((size_t)memory + sizeof(Each) - 1) / sizeof(Each) * sizeof(Each));
    memset(s, 0, sizeof *s);
    s->batch = batch;
    s->free = slots;
    s->directed = directed;
    s->problem = (LeastSquares){NULL, NULL, batch->n_variables, batch->bounds, *options};
    s->system.model = batch->model;
    for (int l = 0; l < WIDTH; l++) s->fits[l].series = -1;
    const double seconds = batch->times[n - 1] - batch->times[0];
    const double frequency = swing_frequency(batch->guess[0], batch->guess[np], batch->guess[np + 1]);
    double h = PANEL_PHASE / frequency;
    for (int attempt = 0; attempt < LENGTHS; attempt++, h *= SHORTER) {
        if (!(seconds / h * LN * (2 + slots.n) < MOST_NUMBERS)) break;
        s->half_swing = PI / frequency;
        if (fit_with_panels(s, h, batch->guess, result)) break;
    }
    free(memory);
    return DONE;
}
