/* Trajectories of one pendulum, exact at reversals, with their sensitivities: swing_trajectory of interface.h. */
#ifndef TRAJECTORY_H
#define TRAJECTORY_H
#include "system.h"

/* Panels that a half-swing of this model usually takes, at most. */
static double usual_panels(const Model *m);

/* Whether a half-swing of this model may take many panels. */
static int takes_many_panels(const Model *m);
#endif
