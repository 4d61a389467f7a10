/* Least squares for swings and for any other residual: Levenberg-Marquardt with Marquardt's scaling, Nielsen's damping (Madsen,
 * Nielsen and Tingleff, Methods for Non-Linear Least Squares Problems, 2004), a trust radius that keeps the first steps
 * short, and an active set of bounds. */
#ifndef LEAST_SQUARES_H
#define LEAST_SQUARES_H
#include "interface.h"

/* A minimum found before: a search that comes to the same place need not follow it to the end again. */
typedef struct {
    const double *x, *normal;
    double value; /* half its sum of squares */
} KnownMinimum;

/* Half the least sum of squares from x, in place. normal_at_end: J'J is wanted at the very end; else a step whose predicted
 * reduction is below the tolerance, which ends the search, is taken without slopes and leaves those of the point before. */
static double search(const LeastSquares *problem, const KnownMinimum *known, int normal_at_end, double *x, double *normal,
                     SearchOutcome *outcome);
#endif
