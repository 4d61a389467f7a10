#include "lockstep.h"

#include <stdlib.h>

#include "events.h"

#define PANEL_PHASE 1.2  /* rad of the swing that a panel takes at most */
#define LOCKSTEP_ORDER 10.0 /* of the error in the panel's length */
#define SHORTER 0.75     /* it is tried again */
#define LENGTHS 8        /* that are tried */
#define MUCH_SHORTER 0.6 /* for the fits that are left over */
#define SPARE_PANELS 1.5 /* for one where there would be none more */
#define FIRST_ERROR 0.4  /* of the first solution's panels: what the limit leaves for the others to differ */
#define MOST_NUMBERS 4e5 /* of the solutions kept, for each lane */

/* ---- What the fits are ---- */

/* Whether this is for the model; directed, timed: whether its motion depends on the velocity's sign, and on the time. */
static int model_is_for_lockstep(const Model *m, int *directed, int *timed) {
    *directed = *timed = 0;
    if (m->input || m->n_states || m->n_clocks || m->play >= 0 || m->reads_rate || m->n_motions > MAX_EFFECTS) return 0;
    for (int k = 0; k < m->n_motions; k++) {
        if (!EFFECTS[m->motions[k].row].lockstep) return 0;
        *directed |= EFFECTS[m->motions[k].row].directed;
        *timed |= EFFECTS[m->motions[k].row].timed;
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
    s->system.most_error = FIRST_ERROR * s->batch->coarseness;
    const Which all = (Which)(each(0.0) == each(0.0));
    if (!any(evaluate_all(s, all, 0))) return 0;
    s->system.most_error = s->batch->coarseness;
    for (int i = 0; i < s->n_kept; i++) s->first_kept[i] = s->kept[i][0];
    for (int f = 0; f < n; f++) {
        s->first[f] = values[s->free.value[f]];
        for (int g = 0; g <= f; g++)
            s->first_normal[f * n + g] = product_of(s->first_slopes + (size_t)f * size, s->first_slopes + (size_t)g * size, size);
    }
    if (!s->reference) return 1;
    for (int i = 0; i < size; i++) s->series[i] = s->first_angles[i] - s->reference[i];
    s->first_off = s->reference_missed + product_of(s->series, s->series, size);
    for (int f = 0; f < n; f++) s->first_off_gradient[f] = product_of(s->first_slopes + (size_t)f * size, s->series, size);
    return 1;
}

/* ---- Lanes ---- */

/* The next series, or NULL, as coordinates or at the samples; the sum of squares that coordinates leave of it. */
static double lay_out_series(const Lockstep *s, const double *series, double *out) {
    if (!s->directed) return compress(&s->record, series, out);
    memcpy(out, series, s->n_rows * sizeof(double));
    return 0.0;
}

/* How far from the reference a lane's search is, if it went to the point just computed. */
static void keep_off(const Lockstep *s, LaneFit *fit, double squares, double off, const double *gradient) {
    if (!s->reference || fit->search.value != 0.5 * squares) return;
    fit->off = off;
    for (int f = 0; f < s->free.n; f++) fit->off_gradient[s->free.variable[f]] = gradient[f];
}

/* The same at the end of the search, also where its last step is foretold. */
static double off_at_end(const LaneFit *fit) {
    const Search *search = &fit->search;
    double off = fit->off;
    for (int i = 0; i < search->n && search->foretold; i++) {
        double row = 2.0 * fit->off_gradient[i];
        for (int j = 0; j < search->n; j++) row += fit->normal[i * search->n + j] * search->step[j];
        off += search->step[i] * row;
    }
    return fmax(off, 0.0);
}

static void add_curvature(const Lockstep *s, double *normal) {
    const int n = s->free.n;
    for (int i = 0; i < n * n && s->batch->curvature; i++) normal[i] += s->batch->curvature[i];
}

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
    add_curvature(s, fit->at.normal);
    take_value(&fit->search, 0.5 * squares);
    keep_off(s, fit, squares, s->first_off, s->first_off_gradient);
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
    add_curvature(s, fit->at.normal);
    take_value(&fit->search, 0.5 * s->squares[lane]);
    double gradient[MOST_FREE];
    for (int f = 0; f < n && s->reference; f++) gradient[f] = s->off_gradient[f][lane];
    keep_off(s, fit, s->squares[lane], s->off[lane], gradient);
}

/* The lane's next point is foretold by the batch's first. */
static void foretell_from_first(Lockstep *s, int lane) {
    for (int i = 0; i < s->n_kept; i++) s->kept[i][lane] = s->first_kept[i];
    for (int f = 0; f < s->free.n; f++) s->last.x[f][lane] = s->first[f];
    s->last_omega[lane] = s->batch->guess[0];
}

/* Put the next series into a lane, at its first point. */
static void load_lane(Lockstep *s, int lane) {
    const Batch *batch = s->batch;
    const int n = s->free.n, np = batch->model->n_parameters;
    LaneFit *fit = &s->fits[lane];
    fit->series = s->next++;
    const double *given = batch->values + (size_t)fit->series * (np + 2);
    const double *series = batch->series + (size_t)fit->series * batch->n_samples;
    s->missed[lane] = lay_out_series(s, series, s->series);
    s->series_of[lane] = series;
    for (int i = 0; i < s->n_rows && !s->directed; i++) s->data[i][lane] = s->series[i];
    foretell_from_first(s, lane);
    for (int i = 0; i < np + 2; i++) s->values[i][lane] = given[i];
    for (int f = 0; f < n; f++) {
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

/* Keep what a lane's search came to; the fits that did not end at a minimum are left, but for those that may not go on. */
static void keep_result(const Lockstep *s, int lane, BatchResult *result) {
    const LaneFit *fit = &s->fits[lane];
    const size_t n = s->free.n;
    const int spent = fit->search.stalled || fit->outcome.evaluations >= s->problem.options.most_evaluations;
    if (fit->outcome.converged != STATIONARY && !(fit->outcome.converged == NOT_STATIONARY && spent)) return;
    result->alone[fit->series] = 0;
    memcpy(result->variables + fit->series * n, fit->x, n * sizeof(double));
    result->squares[fit->series] = 2.0 * fit->search.value;
    if (s->reference) result->off[fit->series] = off_at_end(fit);
    result->converged[fit->series] = fit->outcome.converged;
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
        while (s->next < s->batch->n_series && !result->alone[s->next]) s->next++;
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
            if (found[l]) take_lane_value(s, l);
            else if (s->again && fit->search.stage == TRIES) { /* a shorter step may do */
                foretell_from_first(s, l);
                take_value(&fit->search, INFINITY);
            } else fit->series = -1;
            if (fit->series >= 0) fit->at = next_point(&fit->search);
            fill_lane(s, l, result);
        }
    }
}

/* ---- The batch ---- */

/* Memory for the panels, in one piece; 0 where there is none. */
static int open_lockstep(Lockstep *s, void **memory) {
    const size_t n = s->free.n, panels = s->record.n_panels, nodes = panels * LN;
    const size_t data = s->directed ? 0 : panels * TERMS, rows = s->n_rows = s->directed ? (size_t)s->batch->n_samples : data;
    const size_t kept = s->n_kept = s->directed ? nodes + 2 * panels + s->n_half_swings : nodes * (1 + n);
    const size_t of_each = kept + data + (1 + n) * TERMS;
    const size_t numbers = kept + rows * (3 + n) + WIDTH * search_room(s->problem.n_variables);
    *memory = malloc((of_each * WIDTH + numbers + WIDTH) * sizeof(double));
    if (!*memory) return 0;
    Each *room = (Each *)(((size_t)*memory + sizeof(Each) - 1) / sizeof(Each) * sizeof(Each));
    memset(room, 0, of_each * sizeof(Each));
    s->kept = s->last.u = room;
    s->last.changes = s->angles_from = room + nodes;
    s->velocities_from = s->angles_from + panels;
    s->durations = s->velocities_from + panels;
    s->data = room + kept;
    s->angles = s->data + data;
    s->first_kept = (double *)(s->angles + (1 + n) * TERMS);
    s->first_angles = s->first_kept + kept;
    s->first_slopes = s->first_angles + rows;
    s->series = s->first_slopes + rows * n;
    double *searches = s->series + 2 * rows;
    for (int l = 0; l < WIDTH; l++) s->fits[l].room = searches + l * search_room(s->problem.n_variables);
    s->reference = s->batch->reference ? s->series + rows : NULL;
    if (s->reference) s->reference_missed = lay_out_series(s, s->batch->reference, s->reference);
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
        s->n_half_swings = (int)(SPARE_PANELS * (seconds / s->half_swing + 3.0));
        s->record = (LockstepRecord){.n_panels = s->n_half_swings * PANELS_OF(s->parts), .h = longest};
    } else ready = open_lockstep_record(&s->record, batch->times, batch->n_samples, longest);
    const int enough = ready && open_lockstep(s, &memory) && solve_first(s, first);
    if (enough) run_lanes(s, result);
    close_lockstep_record(&s->record);
    free(memory);
    return enough;
}

static int any_alone(const Batch *batch, const BatchResult *result) {
    for (int k = 0; k < batch->n_series; k++)
        if (result->alone[k]) return 1;
    return 0;
}

static int fit_in_lockstep(const Batch *batch, const SearchOptions *options, BatchResult *result) {
    const int np = batch->model->n_parameters, n = batch->n_samples;
    int directed, timed;
    for (int k = 0; k < batch->n_series; k++) result->alone[k] = 1;
    FreeSlots slots;
    if (!batch->n_series || n < 2 || !model_is_for_lockstep(batch->model, &directed, &timed) || !find_free_slots(batch, &slots)) return DONE;
    void *memory = malloc(sizeof(Lockstep) + sizeof(Each));
    if (!memory) return NO_MEMORY;
    Lockstep *s = (Lockstep *)(((size_t)memory + sizeof(Each) - 1) / sizeof(Each) * sizeof(Each));
    memset(s, 0, sizeof *s);
    s->batch = batch;
    s->free = slots;
    s->directed = directed;
    s->timed = timed;
    s->problem = (LeastSquares){NULL, NULL, batch->n_variables, batch->bounds, *options};
    s->system.model = batch->model;
    s->system.coarseness = batch->coarseness;
    for (int l = 0; l < WIDTH; l++) {
        s->fits[l].series = -1;
        s->series_of[l] = batch->series;
    }
    s->reference_of = batch->reference ? batch->reference : batch->series;
    const double seconds = batch->times[n - 1] - batch->times[0];
    const double frequency = swing_frequency(batch->guess[0], batch->guess[np], batch->guess[np + 1]);
    double h = PANEL_PHASE * pow(batch->coarseness, 1.0 / LOCKSTEP_ORDER) / frequency;
    for (int attempt = 0; attempt < LENGTHS; attempt++, h *= SHORTER) {
        if (!(seconds / h * LN * (2 + slots.n) < MOST_NUMBERS)) break;
        s->half_swing = PI / frequency;
        s->next = 0;
        if (!fit_with_panels(s, h, batch->guess, result)) continue;
        if (s->again || !any_alone(batch, result)) break;
        s->again = 1; /* those that came where panels are too long */
        h *= MUCH_SHORTER;
    }
    free(memory);
    return DONE;
}
