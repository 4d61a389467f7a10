/* Sensitivities: the exact derivatives of the motion by each free value, along panels (variational equations, solved with
 * the panel's own inverse) and across events (saltation: Leine and Nijmeijer, Dynamics and Bifurcations of Non-Smooth
 * Mechanical Systems, 2004). */
#ifndef SENSITIVITIES_H
#define SENSITIVITIES_H
#include "dense_output.h"

/* Of angle, velocity and states by each free value, now and along the panel. */
typedef struct {
    int n;
    const int *by; /* parameter, RELEASE_ANGLE or RELEASE_VELOCITY */
    double th[MAX_PARAMETERS], v[MAX_PARAMETERS], z[MAX_PARAMETERS][MAX_STATES];
    MotionCurve curve[MAX_PARAMETERS];
} Sensitivities;

/* At the release; where the model has states also their initial values, into x. */
static void set_release(const System *s, PhasePoint *x, Sensitivities *d);

/* Along the solved and linearised panel. */
static void propagate(const System *s, const Panel *panel, Sensitivities *d);

/* At a position of that panel. */
static void move_to(const System *s, const Panel *panel, Sensitivities *d, double x);

/* The rates jump from `before` to `after` at an event that comes `later[f]` for a change of free value f: saltation. */
static void saltate(Sensitivities *d, int n_states, const double *before, const double *after, const double *later);

/* Cross a switch other than the reversal; where the rates jump there, so do the sensitivities. */
static void cross_switch(System *s, const PhasePoint *x, int k, Sensitivities *d);
#endif
