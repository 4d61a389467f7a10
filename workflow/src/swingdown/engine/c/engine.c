/* The engine as one translation unit, so that the compiler sees through all of it; only what interface.h declares is
 * seen from outside. In the order in which one may read it: the system of equations, a panel of it, what happens on a
 * panel, a trajectory of panels, and the fits. */
#include "system.c"
#include "states.c"
#include "panel.c"
#include "linearise.c"
#include "dense_output.c"
#include "events.c"
#include "sensitivities.c"
#include "reading.c"
#include "record.c"
#include "trajectory.c"
#include "least_squares.c"
#include "lockstep_panel.c"
#include "lockstep_record.c"
#include "lockstep_point.c"
#include "lockstep.c"
#include "swings.c"
