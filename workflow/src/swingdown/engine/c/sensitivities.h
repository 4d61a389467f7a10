/* Sensitivities: the exact derivatives of the motion by each free value, along panels (variational equations, solved with
 * the panel's own inverse) and across events (saltation: Leine and Nijmeijer, Dynamics and Bifurcations of Non-Smooth
 * Mechanical Systems, 2004). */
#ifndef SENSITIVITIES_H
#define SENSITIVITIES_H
#include "dense_output.h"

/* Of angle, velocity and states by each free value, now and along the panel; the one after the last is room for OWN_RATE. */
typedef struct {
    int n;
    const int *by; /* parameter, RELEASE_ANGLE or RELEASE_VELOCITY */
    double th[MAX_PARAMETERS + 1], v[MAX_PARAMETERS + 1], z[MAX_PARAMETERS + 1][MAX_STATES];
    MotionCurve curve[MAX_PARAMETERS + 1];
    double lead[MAX_PARAMETERS], last_rates[BLOCKS]; /* where there are broken powers: see sensitivities.c */
} Sensitivities;

/* No free value: the motion's own rates, which change as its sensitivities do, and are known. */
enum { OWN_RATE = -3 };
static inline int free_value(const Sensitivities *d, int f) { return f < d->n ? d->by[f] : OWN_RATE; }

/* At the release; where the model has states also their initial values, into x. */
static void set_release(const System *s, PhasePoint *x, Sensitivities *d);

/* Along the solved and linearised panel, of which the motion follows the part up to x_end. */
static void propagate(System *s, const Panel *panel, Sensitivities *d, double x_end);

/* At a position of that panel. */
static void move_to(const System *s, const Panel *panel, Sensitivities *d, double x);

/* At a reversal that ends that panel. */
static void come_to_rest(System *s, const PhasePoint *x, Sensitivities *d);

/* The rates jump from `before` to `after` at an event that comes `later[f]` for a change of free value f: saltation. */
static void saltate(Sensitivities *d, int n_states, const double *before, const double *after, const double *later);

/* Cross a switch other than the reversal; where the rates jump there, so do the sensitivities. */
static void cross_switch(System *s, const PhasePoint *x, int k, Sensitivities *d);
#endif
