#include "segments.h"

#include <stdlib.h>

#include "events.h"

#define GROUPS (SEGMENTS / WIDTH)
#define LEAST_SAMPLES 8       /* of a segment */
#define BAND 0.1              /* of the spread: what lies closer to the middle is on no side */
#define START_PHASE 1.5       /* rad of the swing to either side that tell where a segment starts */
#define LOCAL 3               /* terms of a harmonic about a mean */
#define SEGMENT_PANEL 1.2     /* rad of the swing that a panel takes at most, tried first */
#define SHORTER_PANEL 0.75    /* it is tried again */
#define PANEL_LENGTHS 4       /* that are tried */
#define MOST_SEGMENT_NUMBERS 4e5 /* of the solutions kept, for each segment */
#define MOST_STEPS 8          /* Gauss's and Newton's, none of them shortened */
/* Of the sum of squares: a step is the last that gains less and after which another, were steps to shrink on as they did, would
 * gain less than REST. J'J from before it is that after it: standard errors differed by less than 1e-7 of themselves. */
#define SETTLED 1e-9
#define REST 1e-16

/* The samples, and what their sensor is taken for. */
typedef struct {
    const FitProblem *problem;
    const Model *model;
    int n_samples, each, left; /* of the record, of a segment, behind the last one */
    double spacing;            /* s */
} Cut;

/* The segments of a fit under way: WIDTH in each group's lanes. */
typedef struct {
    Cut cut;
    int n, n_panels; /* of a segment; one more, of the last one only, where samples are left */
    double h[2];     /* s: panels are of one sample more or less */
    int longer;      /* panels of the former kind, which come first */
    int n_all;       /* free values: the variables' and the segments' starts */
    Batch batch;
    Lockstep *group[GROUPS];
    Each *end[GROUPS]; /* angle and velocity, then for each free value their changes */
} Segments;

/* ---- What they are for ---- */

static int is_timeless(const Model *m) {
    for (int k = 0; k < m->n_motions; k++)
        if (EFFECTS[m->motions[k].row].timed) return 0;
    return 1;
}

/* Whether this is for the problem; how its record is cut. */
static int cut_record(const FitProblem *problem, Cut *cut) {
    const Model *m = problem->models;
    const int n = problem->n_samples[0];
    const double *times = problem->times[0];
    int directed;
    if (problem->n_swings != 1 || problem->known.precision || n < SEGMENTS * LEAST_SAMPLES) return 0;
    if (!model_is_for_lockstep(m, &directed) || directed || !is_timeless(m)) return 0;
    *cut = (Cut){problem, m, n, n / SEGMENTS, n % SEGMENTS, (times[n - 1] - times[0]) / (n - 1)};
    for (int i = 0; i < n; i++)
        if (!(fabs(times[i] - times[0] - i * cut->spacing) < 1e-9 * cut->spacing)) return 0;
    return 1;
}

/* The free values of a segment: the parameters that are variables, then its start; 0 where they are too many. */
static int lay_out_free(const Cut *cut, FreeSlots *free) {
    const int np = cut->model->n_parameters, *variable_of = cut->problem->variable_of;
    free->n = 0;
    for (int i = 0; i < np + 2; i++) {
        if (i < np && variable_of[i] < 0) continue;
        if (free->n == MOST_FREE) return 0;
        free->value[free->n] = i;
        free->variable[free->n] = variable_of[i];
        free->moves[free->n++] = i >= np || is_of_motion(cut->model, i);
    }
    return cut->problem->n_variables <= MOST_FREE;
}

/* ---- Memory and panels ---- */

/* Panels of whole numbers of samples, none longer than that; the samples that are left are one more. */
static int share_segment(Segments *s, double longest, LockstepRecord *record) {
    const int whole = (int)(longest / s->cut.spacing);
    if (whole < 1) return 0;
    s->n_panels = (s->cut.each + whole - 1) / whole;
    const int few = s->cut.each / s->n_panels, kinds = 3;
    s->longer = s->cut.each % s->n_panels;
    s->h[0] = (few + 1) * s->cut.spacing;
    s->h[1] = few * s->cut.spacing;
    *record = (LockstepRecord){.n_panels = s->n_panels + (s->cut.left > 0)};
    record->panels = malloc(record->n_panels * sizeof(PanelSamples));
    record->bases = malloc(kinds * sizeof(SampleBasis));
    const int sizes[] = {few + 1, few, s->cut.left};
    const size_t samples = 2 * (size_t)few + 1 + s->cut.left;
    record->memory = malloc((samples * (BASIS_ROW + TERMS) + few + 1 + SEGMENTS) * sizeof(double));
    if (!record->panels || !record->bases || !record->memory) return 0;
    double *room = record->memory, *positions = room + samples * (BASIS_ROW + TERMS);
    for (int kind = 0; kind < kinds; kind++) {
        SampleBasis *basis = &record->bases[kind];
        basis->n_samples = sizes[kind];
        basis->by_sample = room;
        basis->by_column = room + (size_t)sizes[kind] * BASIS_ROW;
        room += (size_t)sizes[kind] * (BASIS_ROW + TERMS);
        if (!sizes[kind] || (kind == 0 && !s->longer)) continue;
        for (int i = 0; i < sizes[kind]; i++) positions[i] = 2.0 * i / sizes[kind] - 1.0;
        set_up_basis(basis, positions);
    }
    for (int k = 0, next = 0; k < record->n_panels; k++) {
        const int kind = k == s->n_panels ? 2 : k >= s->longer;
        record->panels[k] = (PanelSamples){next, &record->bases[kind]};
        next += sizes[kind];
    }
    return 1;
}

/* Room for the groups; 0 where there is none. */
static int open_groups(Segments *s, const LockstepRecord *record, const FreeSlots *free, void **memory) {
    const size_t n = free->n, panels = record->n_panels, nodes = panels * LN, rows = panels * TERMS;
    const size_t of_each = nodes * (1 + n) + rows + (1 + n) * TERMS + 2 * (1 + n);
    const size_t own = (sizeof(Lockstep) + sizeof(Each) - 1) / sizeof(Each);
    *memory = malloc((GROUPS * (own + of_each) + 1) * sizeof(Each) + rows * sizeof(double));
    if (!*memory) return 0;
    Each *room = (Each *)(((size_t)*memory + sizeof(Each) - 1) / sizeof(Each) * sizeof(Each));
    for (int g = 0; g < GROUPS; g++) {
        Lockstep *group = s->group[g] = (Lockstep *)room;
        memset(group, 0, sizeof *group);
        room += own;
        group->batch = &s->batch;
        group->free = *free;
        group->record = *record;
        group->system.model = s->cut.model;
        group->system.most_error = 1.0;
        group->last.u = room;
        group->last.changes = room + nodes;
        group->data = room + nodes * (1 + n);
        group->angles = group->data + rows;
        s->end[g] = group->angles + (1 + n) * TERMS;
        room += of_each;
    }
    double *coordinates = (double *)room;
    const double *series = s->cut.problem->angles[0];
    for (int l = 0; l < SEGMENTS; l++) {
        Lockstep *group = s->group[l / WIDTH];
        group->missed[l % WIDTH] = compress(record, series + (size_t)l * s->cut.each, coordinates);
        for (size_t i = 0; i < rows; i++) group->data[i][l % WIDTH] = coordinates[i];
    }
    return 1;
}

/* ---- Starts ---- */

/* The angular frequency (rad/s) of small swings, by the middle crossings of the series; 0 where there are fewer than two. A crossing
 * goes from one side of a band about the mean to the other; their times lie about a line, however far off the middle is. */
static double frequency_seen(const Cut *cut) {
    const double *y = cut->problem->angles[0];
    const int n = cut->n_samples;
    double sum = 0.0, squares = 0.0, k = 0.0, sum_k = 0.0, sum_t = 0.0, sum_kk = 0.0, sum_kt = 0.0;
    for (int i = 0; i < n; i++) sum += y[i];
    const double mean = sum / n;
    for (int i = 0; i < n; i++) squares += (y[i] - mean) * (y[i] - mean);
    const double spread = sqrt(squares / n);
    for (int i = 0, before = -1; i < n; i++) {
        const double here = y[i] - mean;
        if (!(fabs(here) > BAND * spread)) continue;
        const double there = before < 0 ? here : y[before] - mean;
        if (here * there < 0.0) {
            const double t = before + (i - before) * there / (there - here);
            sum_k += k;
            sum_t += t;
            sum_kk += k * k;
            sum_kt += k++ * t;
        }
        before = i;
    }
    const double half_swing = (k * sum_kt - sum_k * sum_t) / (k * sum_kk - sum_k * sum_k) * cut->spacing;
    const double middle = sqrt(2.0) * spread; /* amplitude, rad */
    return k > 1.0 && middle < PI ? PI / half_swing / swing_frequency(1.0, middle, 0.0) : 0.0;
}

/* Value and slope (a second) of a series at sample `at`, of the harmonic about a mean through those within `reach` samples; 0 where there
 * is none. phase: rad a sample. */
static int local_harmonic(const Cut *cut, int at, int reach, double phase, double *value, double *slope) {
    const double *y = cut->problem->angles[0];
    const int first = at > reach ? at - reach : 0, last = at + reach < cut->n_samples ? at + reach : cut->n_samples - 1;
    double a[LOCAL * LOCAL] = {0.0}, b[LOCAL] = {0.0};
    for (int i = first; i <= last; i++) {
        double term[LOCAL] = {1.0};
        sine_cosine((i - at) * phase, &term[1], &term[2]);
        for (int r = 0; r < LOCAL; r++) {
            b[r] += term[r] * y[i];
            for (int c = 0; c <= r; c++) a[r * LOCAL + c] += term[r] * term[c];
        }
    }
    if (last - first < LOCAL || !factorise(LOCAL, a)) return 0;
    substitute(LOCAL, a, b);
    *value = b[0] + b[2];
    *slope = b[1] * phase / cut->spacing;
    return 1;
}

/* Where the search starts: the frequency and the segments' starts as the series shows them, all other variables as near to zero as
 * they may be. */
static int set_starts(Segments *s, double frequency) {
    const Cut *cut = &s->cut;
    const FitProblem *problem = cut->problem;
    const int np = cut->model->n_parameters, *variable_of = problem->variable_of;
    const int reach = (int)fmin(cut->each, fmax(3.0, START_PHASE / (frequency * cut->spacing)));
    for (int l = 0; l < SEGMENTS; l++) {
        Lockstep *group = s->group[l / WIDTH];
        const int lane = l % WIDTH;
        double th, v;
        for (int i = 0; i < np; i++) {
            const int at = variable_of[i];
            const double wanted = i ? 0.0 : frequency;
            group->values[i][lane] = at < 0 ? problem->values[i] : fmin(fmax(wanted, problem->bounds.lower[at]), problem->bounds.upper[at]);
        }
        set_sensors(group, lane);
        if (!local_harmonic(cut, l * cut->each, reach, frequency * cut->spacing, &th, &v)) return 0;
        const int given = l == 0 && variable_of[np] < 0, pushed = l == 0 && variable_of[np + 1] < 0;
        group->values[np][lane] = given ? problem->values[np] : (th - group->zero[lane]) / group->gain[lane];
        group->values[np + 1][lane] = pushed ? problem->values[np + 1] : v / group->gain[lane];
    }
    return 1;
}

/* ---- A point ---- */

/* The samples behind the last segment, which count for that one alone. */
static Which read_left(Lockstep *s, int is_last, int k, LockstepPanel *panel, Each *th, Each *v, Which which) {
    const int n = s->free.n;
    const Each squares = s->squares;
    Each gradient[MOST_FREE], normal[MOST_FREE * MOST_FREE];
    Which last = {0};
    last[WIDTH - 1] = is_last ? -1 : 0;
    memcpy(gradient, s->gradient, n * sizeof(Each));
    memcpy(normal, s->normal, (size_t)n * n * sizeof(Each));
    const Which good = solve_lockstep(&s->system, panel, which & last);
    follow_panel(s, k, panel, th, v);
    read_lockstep(s, s->record.panels[k].basis, s->angles);
    add_lockstep_normal(s, k);
    s->squares = choose(last, s->squares, squares);
    for (int f = 0; f < n; f++) {
        s->gradient[f] = choose(last, s->gradient[f], gradient[f]);
        for (int g = 0; g <= f; g++) s->normal[f * n + g] = choose(last, s->normal[f * n + g], normal[f * n + g]);
    }
    return which & (good | ~last);
}

/* Sums of squares and slopes of a group at its values, and where its segments end; 0 where one cannot be computed. */
static int evaluate_group(const Segments *all, int g, int has_last) {
    Lockstep *s = all->group[g];
    LockstepPanel panel;
    Each th[MOST_FREE], v[MOST_FREE], step[MOST_FREE], *end = all->end[g];
    Which which = (Which)(each(0.0) == each(0.0));
    const int n = s->free.n;
    for (int l = 0; l < WIDTH; l++) set_sensors(s, l);
    start_lockstep(s, &panel, th, v);
    panel.t = each(0.0); /* nothing depends on it */
    for (int f = 0; f < n; f++) {
        const Each x = s->values[s->free.value[f]];
        step[f] = x - s->last.x[f];
        s->last.x[f] = x;
    }
    for (int k = 0; k < all->n_panels; k++) {
        panel.h = each(all->h[k >= all->longer]);
        guess_lockstep(s, k, has_last, step, &panel);
        which &= solve_lockstep(&s->system, &panel, which);
        follow_panel(s, k, &panel, th, v);
        read_lockstep(s, s->record.panels[k].basis, s->angles);
        add_lockstep_normal(s, k);
    }
    end[0] = panel.th;
    end[1] = panel.v;
    for (int f = 0; f < n; f++) {
        end[2 + 2 * f] = th[f];
        end[3 + 2 * f] = v[f];
    }
    if (all->cut.left) {
        panel.h = each(all->cut.left * all->cut.spacing);
        guess_lockstep(s, all->n_panels, has_last, step, &panel);
        which = read_left(s, g == GROUPS - 1, all->n_panels, &panel, th, v, which);
    }
    which &= (Which)(s->squares < INFINITY);
    for (int l = 0; l < WIDTH; l++)
        if (!which[l]) return 0;
    return 1;
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
    double weighed[MOST_FREE][MOST_FREE + 1]; /* its own J'J times the chain, less in the last column J'r */
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
    double moved[SEGMENTS][MOST_FREE];
    Chain chain;
    begin_chain(s, chain);
    for (int l = 0; l < SEGMENTS; l++) {
        for (int f = 0; f < all; f++) {
            moved[l][f] = chain[f][n];
            for (int c = 0; c < n; c++) moved[l][f] += chain[f][c] * step[c];
        }
        if (l < SEGMENTS - 1) extend_chain(s, l, chain);
    }
    for (int l = 0; l < SEGMENTS; l++)
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
    double step[MOST_FREE], fall = INFINITY;
    for (int k = 1; k <= MOST_STEPS; k++) {
        Condensed at = {0.0};
        Chain chain;
        for (int g = 0; g < GROUPS; g++)
            if (!evaluate_group(s, g, k > 1)) return k > 1 ? 0 : TOO_LONG;
        begin_chain(s, chain);
        for (int l = 0; l < SEGMENTS; l++) {
            condense(s, l, chain, &at);
            if (l < SEGMENTS - 1) extend_chain(s, l, chain);
        }
        if (!solve_condensed(&at, n, step)) return 0;
        const double before = fall;
        fall = 0.0;
        for (int i = 0; i < n; i++) fall -= at.gradient[i] * step[i];
        take_step(s, step);
        const double least = fmin(SETTLED, REST * before / fall) * at.squares;
        if (!(fall < least && at.gaps < SETTLED * at.squares)) continue;
        memcpy(normal, at.normal, (size_t)n * n * sizeof(double));
        return k;
    }
    return 0;
}

static int search_in_segments(const FitProblem *problem, double *x, double *normal) {
    Segments s = {.n = problem->n_variables};
    FreeSlots free_values;
    if (!cut_record(problem, &s.cut) || !lay_out_free(&s.cut, &free_values)) return 0;
    const double frequency = frequency_seen(&s.cut);
    if (!(frequency > 0.0)) return 0;
    s.n_all = free_values.n;
    s.batch = (Batch){.model = s.cut.model};
    double longest = SEGMENT_PANEL / frequency;
    int evaluations = TOO_LONG;
    for (int k = 0; k < PANEL_LENGTHS && evaluations == TOO_LONG; k++, longest *= SHORTER_PANEL) {
        if (!(s.cut.each * s.cut.spacing / longest * LN * (2 + s.n_all) < MOST_SEGMENT_NUMBERS)) break;
        LockstepRecord record = {0};
        void *memory = NULL;
        evaluations = 0;
        if (share_segment(&s, longest, &record) && open_groups(&s, &record, &free_values, &memory) && set_starts(&s, frequency))
            evaluations = descend(&s, normal);
        if (evaluations > 0 && !read_variables(&s, x)) evaluations = 0;
        close_lockstep_record(&record);
        free(memory);
    }
    return evaluations > 0 ? evaluations : 0;
}
