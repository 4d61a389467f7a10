/* Least squares for swings and for any other residual: Levenberg-Marquardt with Marquardt's scaling, Nielsen's damping (Madsen,
 * Nielsen and Tingleff, Methods for Non-Linear Least Squares Problems, 2004), a trust radius that keeps the first steps
 * short, and an active set of bounds. */
#ifndef LEAST_SQUARES_H
#define LEAST_SQUARES_H
#include <stddef.h>

#include "interface.h"

/* A minimum found before: a search that comes to the same place need not follow it to the end again. */
typedef struct {
    const double *x, *normal;
    double value; /* half its sum of squares */
} KnownMinimum;

/* A step that is proposed; predicted: reduction, of half the sum of squares; relative: to it. */
typedef struct {
    int solvable;
    double size, predicted, relative;
    int without_slopes, motionless;
} Proposal;

/* What a search waits for: the value and slopes where it starts, or at a step that it tries; the slopes of a step taken
 * without them. */
enum Stage { STARTS, PROPOSES, TRIES, WANTS_SLOPES, OVER };

/* Where a search is, and the step it tries. normal: J'J; damping multiplies the scale (Marquardt's). */
typedef struct {
    const LeastSquares *problem;
    const KnownMinimum *known; /* or NULL */
    int n;
    double *x, *gradient, *normal, value;
    double *trial, *trial_gradient, *trial_normal;
    double *step, *cholesky;
    double *scale; /* J'J's diagonal, falling no faster than by half: a variable whose column fades does not run off */
    unsigned char active[MAX_VARIABLES]; /* a bound that the variable is on and would cross */
    double damping, growth; /* Nielsen's: growth multiplies the damping after a step that does not gain */
    double trust_radius;    /* of a step, in units of the residuals; -1 before the first */
    int skip_last_slopes;   /* a last step may be taken without them */
    int foretold;           /* the last step was, and x and value are there, all else at the point before */
    enum Stage stage;
    Proposal proposal;
    double looked_value;    /* and evaluations, when it was last looked whether the search gets on */
    int looked_at, stalled;
    double gain, fall; /* of the step taken: over what was predicted, and over the sum of squares */
    SearchOutcome *outcome;
} Search;

/* A point at which a search wants half the sum of squares and, where there is room for them, J'r and J'J; x: NULL at its end. */
typedef struct {
    const double *x;
    double *gradient, *normal;
} Point;

/* A search step by step, so that several go on side by side: begin_search, then next_point and take_value in turn. room: for
 * search_room doubles. normal_at_end: J'J is wanted at the very end; else a step whose predicted reduction is below the
 * tolerance, which ends the search, is taken without slopes and leaves those of the point before. */
static size_t search_room(int n);
static void begin_search(Search *s, const LeastSquares *problem, const KnownMinimum *known, int normal_at_end, double *room, double *x,
                         double *normal, SearchOutcome *outcome);
static Point next_point(Search *s);
static void take_value(Search *s, double found);

/* Half the least sum of squares from x, in place, by the problem's own cost. */
static double search(const LeastSquares *problem, const KnownMinimum *known, int normal_at_end, double *x, double *normal,
                     SearchOutcome *outcome);
#endif
