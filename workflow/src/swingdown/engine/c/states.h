/* States that need no unknowns of their own, for their equations are linear in themselves: rate-independent ones, a
 * closed form in the angle, and first-order lags, solved once the motion is known. */
#ifndef STATES_H
#define STATES_H
#include "system.h"

/* A state along a panel: a polynomial and, of a LAG, a transient that fades from its start,
 * (transient[0] + transient[1] t) exp(-relaxation t). */
typedef struct {
    double poly[N + 2], transient[2];
} StateCurve;

/* Dense output: angle, velocity and states along a panel, as polynomials in the position, -1 to 1. */
typedef struct {
    double th[N + 2], v[N + 2];
    StateCurve state[MAX_STATES];
} MotionCurve;

/* The coefficients of the states' linear equations in the present direction, with their derivatives. */
static void set_linear_states(System *s);

/* Where a rate-independent state would settle. */
static inline double equilibrium(const System *s, int k) { return s->drive[k] / s->relaxation[k]; }

/* What is left, at an angle, of a rate-independent state's distance from its equilibrium at the start of a panel: also
 * its derivative by its value there. */
static inline double remainder_at(const System *s, const PhasePoint *start, int k, double th) {
    return exponential(-s->relaxation[k] * (th - start->th));
}

static inline double rate_independent_at(const System *s, const PhasePoint *start, int k, double remaining) {
    return equilibrium(s, k) + (start->z[k] - equilibrium(s, k)) * remaining;
}

/* A rate-independent state at N angles, and what remains there of its start. */
static void rate_independent(const System *s, const PhasePoint *start, int k, const double *th, double *remaining, double *z);

/* Its derivative at an angle by a parameter, its value and angle at the panel's start held. */
static double rate_independent_by(const System *s, const PhasePoint *start, int k, int parameter, double th, double remaining);

/* z' = input - relaxation z from z0, with `input` at the nodes: exact for the polynomial through them. Where it settles
 * within a small part of the panel, a polynomial that satisfies the equation, and what is left of the start is a
 * transient; there the part of `input` that is gain times the angle th, which has a higher degree, is taken as it is. */
typedef struct {
    double relaxation, gain, h, z0;
    const double *inverse; /* of the equation at the nodes, where the lag is slow */
    const double *input, *th, *th_poly;
} LagProblem;
static void solve_lag(const LagProblem *lag, StateCurve *out);

/* Whether a lag settles within a small part of a panel of length h; else its inverse is needed: 0 where there is none. */
#define TIME_CONSTANTS 12.0
static inline int is_quick(double relaxation, double h) { return !(relaxation * h < TIME_CONSTANTS); }
static int invert_lag(double relaxation, double h, double *inverse);

/* A state's transient, and its whole rate at a position of the panel. */
static double transient_after(const StateCurve *state, double relaxation, double after);
static double state_rate(const StateCurve *state, double relaxation, double h, double x);
static void sample_state(const StateCurve *state, double relaxation, double h, const double *x, int n, double *out);
#endif
