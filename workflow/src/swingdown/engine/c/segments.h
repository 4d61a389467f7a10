/* One fit in the processor's vector lanes: the record is cut into SEGMENTS of as many samples, each followed from a start of its own,
 * all side by side as if they were fits (lockstep.h), and the least squares are solved under the condition that each segment ends where
 * the next begins (multiple shooting: Bock, in Numerical Treatment of Inverse Problems in Differential and Integral Equations,
 * 1983). The data themselves tell where segments start, so a motion that is near its end out of step with its guess does not mislead.
 *
 * This is for a single swing of equally spaced samples whose motion is for lockstep and depends on no time; all else is declined, and
 * so is whatever does not go straight to a minimum within the bounds. */
#ifndef SEGMENTS_H
#define SEGMENTS_H
#include "lockstep.h"

#define SEGMENTS 8 /* on every machine, for the same bits */
#define GROUPS (SEGMENTS / WIDTH)

/* The samples, and how they are shared out. */
typedef struct {
    const FitProblem *problem;
    const Model *model;
    int directed;              /* the motion depends on the velocity's sign */
    int n_samples, each, left; /* of the record, of a segment, behind the last one */
    double spacing;            /* s */
} Cut;

/* The segments of a fit under way: WIDTH in each group's lanes, and one more where a directed motion leaves samples. */
typedef struct {
    Cut cut;
    int count, n, n_all; /* segments; variables; free values, theirs and the segments' starts */
    int n_panels;        /* of a smooth segment; one more, of the last one only, where samples are left */
    double h[2];         /* s: its panels are of one sample more or less */
    int longer;          /* panels of the former kind, which come first */
    Batch batch[2];      /* of the segments, and of the one that is left */
    Lockstep *group[GROUPS + 1];
    Each *end[GROUPS + 1]; /* angle and velocity, then for each free value their changes */
} Segments;

/* What a series shows at a glance: s between its middle crossings; rad/s, of small swings. */
typedef struct {
    double half_swing, frequency;
} Seen;

static inline int all_of(Which which, int lanes) {
    for (int l = 0; l < lanes; l++)
        if (!which[l]) return 0;
    return 1;
}

/* The least sum of squares: the variables and J'J there (n by n); the evaluations it took, or 0 where it declined. directed: then
 * the samples' slopes beside a reversal are a little coarse, and what is found is a step off the minimum. */
static int search_in_segments(const FitProblem *problem, double *x, double *normal, int *directed);
#endif
