/* What segments are for, how a record is cut into them, and where they start: as the series itself shows. */
#include <stdlib.h>

#include "events.h"
#include "segments.h"

#define LEAST_SAMPLES 8 /* of a segment */
#define BAND 0.1        /* of the spread: what lies closer to the middle is on no side */
#define START_PHASE 1.5 /* rad of the swing to either side that tell where a segment starts */
#define LOCAL 3         /* terms of a harmonic about a mean */

/* Whether this is for the problem; how its record is cut. */
static int cut_record(const FitProblem *problem, Cut *cut) {
    const Model *m = problem->models;
    const int n = problem->n_samples[0];
    const double *times = problem->times[0];
    int directed, timed;
    if (problem->n_swings != 1 || problem->known.precision || n <= SEGMENTS * LEAST_SAMPLES) return 0;
    if (!model_is_for_lockstep(m, &directed, &timed) || timed) return 0;
    const int shared = directed ? n - 1 : n; /* a directed segment's last sample is the next one's first */
    *cut = (Cut){problem, m, directed, n, shared / SEGMENTS, shared % SEGMENTS, (times[n - 1] - times[0]) / (n - 1)};
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

/* ---- Starts ---- */

/* What the series shows by its middle crossings; 0 where there are fewer than two. A crossing goes from one side of a band about the
 * mean to the other; their times lie about a line, however far off the middle is. */
static int look_at(const Cut *cut, Seen *seen) {
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
    const double middle = sqrt(2.0) * spread; /* amplitude, rad */
    seen->half_swing = (k * sum_kt - sum_k * sum_t) / (k * sum_kk - sum_k * sum_k) * cut->spacing;
    seen->frequency = PI / seen->half_swing / swing_frequency(1.0, middle, 0.0);
    return k > 1.0 && middle < PI;
}

/* A harmonic about a mean, through the samples within `reach` of its own: phase (rad) a sample, and its terms at each of them. */
typedef struct {
    double phase;
    int reach;
    double (*terms)[LOCAL]; /* those at its own in the middle */
} Harmonic;

/* 0 where there is no memory. */
static int open_harmonic(const Cut *cut, const Seen *seen, Harmonic *harmonic) {
    const double phase = PI / seen->half_swing * cut->spacing;
    const int reach = (int)fmin(cut->each, fmax(3.0, START_PHASE / phase));
    *harmonic = (Harmonic){phase, reach, malloc((2 * (size_t)reach + 1) * sizeof(double[LOCAL]))};
    for (int i = -reach; i <= reach && harmonic->terms; i++) {
        double *term = harmonic->terms[reach + i];
        term[0] = 1.0;
        sine_cosine(i * phase, &term[1], &term[2]);
    }
    return harmonic->terms != NULL;
}

/* Value and slope (a second) of the series at sample `at`, of the harmonic about it; 0 where there is none. */
static int local_harmonic(const Cut *cut, int at, const Harmonic *harmonic, double *value, double *slope) {
    const double *y = cut->problem->angles[0];
    const int reach = harmonic->reach, first = at > reach ? at - reach : 0, last = at + reach < cut->n_samples ? at + reach : cut->n_samples - 1;
    double a[LOCAL * LOCAL] = {0.0}, b[LOCAL] = {0.0};
    for (int i = first; i <= last; i++) {
        const double *term = harmonic->terms[reach + i - at];
        for (int r = 0; r < LOCAL; r++) {
            b[r] += term[r] * y[i];
            for (int c = 0; c <= r; c++) a[r * LOCAL + c] += term[r] * term[c];
        }
    }
    if (last - first < LOCAL || !factorise(LOCAL, a)) return 0;
    substitute(LOCAL, a, b);
    *value = b[0] + b[2];
    *slope = b[1] * harmonic->phase / cut->spacing;
    return 1;
}

/* Where segment l starts; 0 where the series does not show it. */
static int set_start(Segments *s, int l, double frequency, const Harmonic *harmonic) {
    const Cut *cut = &s->cut;
    const FitProblem *problem = cut->problem;
    const int np = cut->model->n_parameters, *variable_of = problem->variable_of, lane = l % WIDTH;
    Lockstep *group = s->group[l / WIDTH];
    double th, v;
    for (int i = 0; i < np; i++) {
        const int at = variable_of[i];
        const double wanted = i ? 0.0 : frequency;
        group->values[i][lane] = at < 0 ? problem->values[i] : fmin(fmax(wanted, problem->bounds.lower[at]), problem->bounds.upper[at]);
    }
    set_sensors(group, lane);
    if (!local_harmonic(cut, l * cut->each, harmonic, &th, &v)) return 0;
    const int given = l == 0 && variable_of[np] < 0, pushed = l == 0 && variable_of[np + 1] < 0;
    group->values[np][lane] = given ? problem->values[np] : (th - group->zero[lane]) / group->gain[lane];
    group->values[np + 1][lane] = pushed ? problem->values[np + 1] : v / group->gain[lane];
    return 1;
}

/* Where the search starts: the frequency and the segments' starts as the series shows them, all other variables as near to zero as
 * they may be. */
static int set_starts(Segments *s, const Seen *seen) {
    Harmonic harmonic;
    int good = open_harmonic(&s->cut, seen, &harmonic);
    for (int l = 0; l < s->count && good; l++) good = set_start(s, l, seen->frequency, &harmonic);
    free(harmonic.terms);
    return good;
}
