/* One fit in the processor's vector lanes: the record is cut into SEGMENTS of as many samples, each followed from a start of its own,
 * all side by side as if they were fits (lockstep.h), and the least squares are solved under the condition that each segment ends where
 * the next begins (multiple shooting: Bock, in Numerical Treatment of Inverse Problems in Differential and Integral Equations,
 * 1983). The data themselves tell where segments start, so a motion that is near its end out of step with its guess does not mislead.
 *
 * This is for a single swing of equally spaced samples whose motion is smooth and depends on no time; all else is declined, and so is
 * whatever does not go straight to a minimum within the bounds. */
#ifndef SEGMENTS_H
#define SEGMENTS_H
#include "lockstep.h"

#define SEGMENTS 8 /* on every machine, for the same bits */

/* The least sum of squares: the variables and J'J there (n by n); the evaluations it took, or 0 where it declined. */
static int search_in_segments(const FitProblem *problem, double *x, double *normal);
#endif
