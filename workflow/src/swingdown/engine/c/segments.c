#include "segments.h"

#include <stdlib.h>

#include "events.h"

#define SEGMENT_PANEL 1.2        /* rad of the swing that a panel takes at most, tried first */
#define SHORTER_PANEL 0.75       /* it is tried again */
#define PANEL_LENGTHS 4          /* that are tried */
#define MOST_SEGMENT_NUMBERS 4e5 /* of the solutions kept, for each segment */
#define MOST_STEPS 8             /* Gauss's and Newton's, none of them shortened */

/* Of the sum of squares: a step is the last that gains less than `last` and after which another, were steps to shrink on as they
 * did, would gain less than `rest`. J'J from before it is that after it: of smooth motions standard errors differed by less than
 * 1e-7 of themselves. After the last of a directed motion comes one by whole trajectories. */
typedef struct {
    double last, rest;
} Settled;
static const Settled SMOOTH_SETTLED = {1e-9, 1e-16}, DIRECTED_SETTLED = {1e-6, 1e-11};

/* ---- Memory ---- */

static inline size_t in_lanes(size_t bytes) { return (bytes + sizeof(Each) - 1) / sizeof(Each); }

static void load_series(Segments *s, double *coordinates) {
    const double *series = s->cut.problem->angles[0];
    for (int l = 0; l < s->count; l++) {
        Lockstep *group = s->group[l / WIDTH];
        const double *own = series + (size_t)l * s->cut.each;
        const int lane = l % WIDTH;
        group->series_of[lane] = own;
        if (s->cut.directed) continue;
        group->missed[lane] = compress(&group->record, own, coordinates);
        for (int i = 0; i < group->record.n_panels * TERMS; i++) group->data[i][lane] = coordinates[i];
    }
}

/* Room for the groups; 0 where there is none. */
static int open_groups(Segments *s, const LockstepRecord *record, const FreeSlots *free, void **memory) {
    const int directed = s->cut.directed, groups = (s->count + WIDTH - 1) / WIDTH;
    const size_t n = free->n, panels = record->n_panels, nodes = panels * LN, rows = directed ? 0 : panels * TERMS;
    const size_t kept = directed ? nodes + 3 * panels : nodes * (1 + n), ends = 2 * (1 + n), own = in_lanes(sizeof(Lockstep));
    const size_t read = directed ? (1 + n) * (s->cut.each + 1) : rows;
    const size_t of_each = kept + rows + (1 + n) * TERMS + ends;
    *memory = malloc((groups * (own + of_each) + 1) * sizeof(Each) + read * sizeof(double));
    if (!*memory) return 0;
    Each *room = (Each *)(in_lanes((size_t)*memory) * sizeof(Each));
    double *shared = (double *)(room + groups * (own + of_each));
    for (int g = 0; g < groups; g++) {
        Lockstep *group = s->group[g] = (Lockstep *)room;
        memset(group, 0, sizeof *group);
        room += own;
        group->batch = &s->batch[g == GROUPS];
        group->free = *free;
        group->record = *record;
        group->system.model = s->cut.model;
        group->system.most_error = group->system.coarseness = 1.0;
        group->last.u = room;
        group->last.changes = group->angles_from = room + nodes;
        group->velocities_from = group->angles_from + panels;
        group->durations = group->velocities_from + panels;
        group->reference_of = s->cut.problem->angles[0];
        group->timed = directed; /* a pendulum that friction holds is declined, and not read at rest */
        group->data = room + kept;
        group->angles = group->data + rows;
        s->end[g] = group->angles + (1 + n) * TERMS;
        group->first_angles = shared;
        group->first_slopes = shared + s->cut.each + 1;
        if (directed) memset(group->last.u, 0, kept * sizeof(Each));
        memset(group->angles, 0, (1 + n) * TERMS * sizeof(Each)); /* slopes of what does not move are read, times zero */
        room += of_each;
    }
    load_series(s, shared);
    return 1;
}

/* Those of the last group that have no segment do as its first. */
static void fill_lanes(Segments *s) {
    for (int l = s->count; l % WIDTH; l++) {
        Lockstep *group = s->group[l / WIDTH];
        for (int i = 0; i < s->cut.model->n_parameters + 2; i++) group->values[i][l % WIDTH] = group->values[i][0];
        group->series_of[l % WIDTH] = group->series_of[0];
    }
}

/* ---- Steps ---- */

/* How a segment's free values change by the variables, a row each, and, in the column behind, what brings its start to the end of
 * the segment before. */
typedef double Chain[MOST_FREE][MOST_FREE + 1];

static void begin_chain(const Segments *s, Chain chain) {
    const FreeSlots *free = &s->group[0]->free;
    memset(chain, 0, sizeof(Chain));
    for (int f = 0; f < free->n; f++)
        if (free->variable[f] >= 0) chain[f][free->variable[f]] = 1.0;
}

/* From segment l to the next. */
static void extend_chain(const Segments *s, int l, Chain chain) {
    const int n = s->n, all = s->n_all, np = s->cut.model->n_parameters, lane = l % WIDTH;
    const Each *end = s->end[l / WIDTH];
    const Lockstep *next = s->group[(l + 1) / WIDTH];
    double found[2][MOST_FREE + 1];
    for (int r = 0; r < 2; r++)
        for (int c = 0; c <= n; c++) {
            double sum = c < n ? 0.0 : end[r][lane] - next->values[np + r][(l + 1) % WIDTH];
            for (int f = 0; f < all; f++) sum += end[2 + 2 * f + r][lane] * chain[f][c];
            found[r][c] = sum;
        }
    for (int r = 0; r < 2; r++) memcpy(chain[all - 2 + r], found[r], (n + 1) * sizeof(double));
}

/* The normal equations of a step: J'J, J'r and, of the gaps between segments, what closing them adds to the sum of squares. */
typedef struct {
    double squares, gaps, gradient[MOST_FREE], normal[MOST_FREE * MOST_FREE];
} Condensed;

/* Add segment l. */
static void condense(const Segments *s, int l, Chain chain, Condensed *to) {
    const int n = s->n, all = s->n_all, lane = l % WIDTH;
    const Lockstep *group = s->group[l / WIDTH];
    double weighed[MOST_FREE][MOST_FREE + 1]; /* its own J'J times the chain */
    for (int f = 0; f < all; f++)
        for (int c = 0; c <= n; c++) {
            double sum = 0.0;
            for (int g = 0; g < all; g++) sum += group->normal[f > g ? f * all + g : g * all + f][lane] * chain[g][c];
            weighed[f][c] = sum;
        }
    to->squares += group->squares[lane];
    for (int f = 0; f < all; f++) {
        const double own = group->gradient[f][lane], shift = chain[f][n];
        to->squares += 2.0 * own * shift + shift * weighed[f][n];
        to->gaps += shift * weighed[f][n];
        for (int r = 0; r < n; r++) {
            to->gradient[r] += chain[f][r] * (own + weighed[f][n]);
            for (int c = 0; c < n; c++) to->normal[r * n + c] += chain[f][r] * weighed[f][c];
        }
    }
}

/* Gauss's and Newton's step, into `step`; 0 where there is none. */
static int solve_condensed(const Condensed *at, int n, double *step) {
    double a[MOST_FREE * MOST_FREE];
    memcpy(a, at->normal, (size_t)n * n * sizeof(double));
    for (int i = 0; i < n; i++) step[i] = -at->gradient[i];
    if (!factorise(n, a)) return 0;
    substitute(n, a, step);
    return 1;
}

/* Move all segments by the step. */
static void take_step(Segments *s, const double *step) {
    const int n = s->n, all = s->n_all;
    double moved[SEGMENTS + 1][MOST_FREE];
    Chain chain;
    begin_chain(s, chain);
    for (int l = 0; l < s->count; l++) {
        for (int f = 0; f < all; f++) {
            moved[l][f] = chain[f][n];
            for (int c = 0; c < n; c++) moved[l][f] += chain[f][c] * step[c];
        }
        if (l < s->count - 1) extend_chain(s, l, chain);
    }
    for (int l = 0; l < s->count; l++)
        for (int f = 0; f < all; f++) s->group[l / WIDTH]->values[s->group[0]->free.value[f]][l % WIDTH] += moved[l][f];
}

/* The variables of the first segment; whether no bound holds them. */
static int read_variables(const Segments *s, double *x) {
    const FreeSlots *free = &s->group[0]->free;
    const Bounds *bounds = &s->cut.problem->bounds;
    int within = 1;
    for (int f = 0; f < free->n; f++) {
        const int at = free->variable[f];
        if (at < 0) continue;
        x[at] = s->group[0]->values[free->value[f]][0];
        within &= x[at] > bounds->lower[at] && x[at] < bounds->upper[at];
    }
    return within;
}

/* To the minimum; the evaluations, 0 where it is not reached, or TOO_LONG where the panels were. */
#define TOO_LONG -1
static int descend(Segments *s, double *normal) {
    const int n = s->n;
    const Settled *settled = s->cut.directed ? &DIRECTED_SETTLED : &SMOOTH_SETTLED;
    double step[MOST_FREE], fall = INFINITY, squares = INFINITY;
    for (int k = 1; k <= MOST_STEPS; k++) {
        Condensed at = {0};
        Chain chain;
        fill_lanes(s);
        for (int g = 0; g * WIDTH < s->count; g++)
            if (!(s->cut.directed ? evaluate_directed(s, g, k > 1) : evaluate_smooth(s, g, k > 1))) return k > 1 ? 0 : TOO_LONG;
        begin_chain(s, chain);
        for (int l = 0; l < s->count; l++) {
            condense(s, l, chain, &at);
            if (l < s->count - 1) extend_chain(s, l, chain);
        }
        if (at.squares > 2.0 * squares || !solve_condensed(&at, n, step)) return 0;
        squares = at.squares;
        const double before = fall;
        fall = 0.0;
        for (int i = 0; i < n; i++) fall -= at.gradient[i] * step[i];
        take_step(s, step);
        const double least = fmin(settled->last, settled->rest * before / fall) * at.squares;
        if (!(fall < least && at.gaps < settled->last * at.squares)) continue;
        memcpy(normal, at.normal, (size_t)n * n * sizeof(double));
        return k;
    }
    return 0;
}

static int search_in_segments(const FitProblem *problem, double *x, double *normal, int *directed) {
    Segments s = {.n = problem->n_variables};
    FreeSlots free_values;
    Seen seen;
    if (!cut_record(problem, &s.cut) || !lay_out_free(&s.cut, &free_values) || !look_at(&s.cut, &seen)) return 0;
    s.count = SEGMENTS + (s.cut.directed && s.cut.left);
    s.n_all = free_values.n;
    *directed = s.cut.directed;
    s.batch[0] = (Batch){.model = s.cut.model, .times = problem->times[0], .n_samples = s.cut.each + 1};
    s.batch[1] = (Batch){.model = s.cut.model, .times = problem->times[0], .n_samples = s.cut.left + 1};
    double longest = SEGMENT_PANEL / seen.frequency;
    int evaluations = TOO_LONG;
    for (int k = 0; k < PANEL_LENGTHS && evaluations == TOO_LONG; k++, longest *= SHORTER_PANEL) {
        if (!(s.cut.each * s.cut.spacing / longest * LN * (2 + s.n_all) < MOST_SEGMENT_NUMBERS)) break;
        LockstepRecord record = {0};
        void *memory = NULL;
        evaluations = 0;
        const int shared = s.cut.directed ? share_directed(&s, longest, &seen, &record) : share_smooth(&s, longest, &record);
        if (shared && open_groups(&s, &record, &free_values, &memory)) {
            set_half_swings(&s, longest, &seen);
            if (set_starts(&s, &seen)) evaluations = descend(&s, normal);
        }
        if (evaluations > 0 && !read_variables(&s, x)) evaluations = 0;
        close_lockstep_record(&record);
        free(memory);
    }
    return evaluations > 0 ? evaluations : 0;
}
