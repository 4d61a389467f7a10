#include "lockstep.h"

#include <stdlib.h>

#include "events.h"

#define PANEL_PHASE 1.6  /* rad of the swing that a panel takes at most */
#define SHORTER 0.75     /* it is tried again */
#define LENGTHS 8        /* that are tried */
#define MOST_NUMBERS 4e5 /* of the solutions kept, for each lane */

/* ---- What the fits are ---- */

static int model_is_smooth(const Model *m) {
    if (m->n_states || m->n_clocks || m->play >= 0 || m->n_motions > MAX_EFFECTS) return 0;
    for (int k = 0; k < m->n_motions; k++)
        if (!EFFECTS[m->motions[k].row].lockstep || EFFECTS[m->motions[k].row].directed) return 0;
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

/* ---- Lanes ---- */

/* Half the sum of squares and its slopes at the first point, for the series in s->series. */
static void take_first_value(Lockstep *s, int lane) {
    LaneFit *fit = &s->fits[lane];
    const int n = s->free.n, size = s->record.n_panels * TERMS;
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
    const int n = s->free.n, np = batch->model->n_parameters, panels = s->record.n_panels;
    LaneFit *fit = &s->fits[lane];
    fit->series = s->next++;
    const double *given = batch->values + (size_t)fit->series * (np + 2);
    s->missed[lane] = compress(&s->record, batch->series + (size_t)fit->series * batch->n_samples, s->series);
    for (int i = 0; i < panels * TERMS; i++) s->data[i][lane] = s->series[i];
    for (int i = 0; i < panels * LN; i++) s->last.u[i][lane] = s->first_u[i];
    for (int i = 0; i < panels * n * LN; i++) s->last.changes[i][lane] = s->first_changes[i];
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
        const Which found = evaluate_lockstep(s, which, 1);
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

/* Memory for a number of panels, in one piece; 0 where there is none. */
static int open_lockstep(Lockstep *s, void **memory) {
    const size_t n = s->free.n, panels = s->record.n_panels, nodes = panels * LN, terms = panels * TERMS;
    const size_t of_each = nodes * (1 + n) + terms + (1 + n) * TERMS;
    const size_t numbers = nodes * (1 + n) + terms * (2 + n) + WIDTH * search_room(s->problem.n_variables);
    *memory = malloc((of_each * WIDTH + numbers + WIDTH) * sizeof(double));
    if (!*memory) return 0;
    Each *room = (Each *)(((size_t)*memory + sizeof(Each) - 1) / sizeof(Each) * sizeof(Each));
    s->last.u = room;
    s->last.changes = s->last.u + nodes;
    s->data = s->last.changes + nodes * n;
    s->angles = s->data + terms;
    s->first_u = (double *)(s->angles + (1 + n) * TERMS);
    s->first_changes = s->first_u + nodes;
    s->first_angles = s->first_changes + nodes * n;
    s->first_slopes = s->first_angles + terms;
    s->series = s->first_slopes + terms * n;
    for (int l = 0; l < WIDTH; l++) s->fits[l].room = s->series + terms + l * search_room(s->problem.n_variables);
    memset(room, 0, of_each * sizeof(Each));
    return 1;
}

/* The batch with panels of at most this length (s); whether that is short enough. */
static int fit_with_panels(Lockstep *s, double longest, const double *first, BatchResult *result) {
    void *memory = NULL;
    const int ready = open_lockstep_record(&s->record, s->batch->times, s->batch->n_samples, longest) && open_lockstep(s, &memory);
    const int enough = ready && solve_first(s, first);
    if (enough) run_lanes(s, result);
    close_lockstep_record(&s->record);
    free(memory);
    return enough;
}

static int fit_in_lockstep(const Batch *batch, const SearchOptions *options, BatchResult *result) {
    const int np = batch->model->n_parameters, n = batch->n_samples;
    for (int k = 0; k < batch->n_series; k++) result->alone[k] = 1;
    FreeSlots slots;
    if (!batch->n_series || n < 2 || !model_is_smooth(batch->model) || !find_free_slots(batch, &slots)) return DONE;
    void *memory = malloc(sizeof(Lockstep) + sizeof(Each));
    if (!memory) return NO_MEMORY;
    Lockstep *s = (Lockstep *)(((size_t)memory + sizeof(Each) - 1) / sizeof(Each) * sizeof(Each));
    memset(s, 0, sizeof *s);
    s->batch = batch;
    s->free = slots;
    s->problem = (LeastSquares){NULL, NULL, batch->n_variables, batch->bounds, *options};
    s->system.model = batch->model;
    for (int l = 0; l < WIDTH; l++) s->fits[l].series = -1;
    const double seconds = batch->times[n - 1] - batch->times[0];
    double h = PANEL_PHASE / swing_frequency(batch->guess[0], batch->guess[np], batch->guess[np + 1]);
    for (int attempt = 0; attempt < LENGTHS; attempt++, h *= SHORTER) {
        if (!(seconds / h * LN * (2 + slots.n) < MOST_NUMBERS)) break;
        if (fit_with_panels(s, h, batch->guess, result)) break;
    }
    free(memory);
    return DONE;
}
