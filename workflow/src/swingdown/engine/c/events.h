/* Events: reversals, switches of the model's other signs, sticking and breakaway. */
#ifndef EVENTS_H
#define EVENTS_H
#include "dense_output.h"

/* What ends a panel, and at which position in (-1, 1]; 2 where nothing does. Other kinds are the number of a switch. */
enum { REVERSAL = -1, NOTHING = -2 };
#define NEVER 2.0
typedef struct {
    double position;
    int kind;
} Event;

/* Freeze each switch's sign at the side it starts on; exactly on it, at the side it moves to. */
static void freeze_signs(System *s, const PhasePoint *here);

/* The first event on the solved panel; of a stuck pendulum the breakaway counts as a reversal. */
static Event first_event(System *s, const Panel *panel);

/* Accelerations at rest, were the pendulum to move forwards or backwards. Friction holds it where up <= 0 <= down; up > down
 * is no friction: it drives. */
typedef struct {
    double up, down;
} Freed;
static Freed freed_at(System *s, const PhasePoint *x);

/* Which way the pendulum leaves rest: 1, -1, or 0 where friction holds it. came: the direction it moved in before, or 0. */
static int leaves_rest(const Freed *freed, double came);

/* Of a panel at rest: how far its length is from following what might free the pendulum, over the limit. */
static double hold_ratio(System *s, const Panel *panel);
#define HOLD_TRUNCATION 1e-8 /* last two Legendre coefficients against the size: it tells when the pendulum breaks away */

/* Time (s) to the next reversal if the motion from here were harmonic with angular frequency omega. */
static double time_to_reversal(double direction, double v, double a, double omega);

/* Angular frequency (rad/s) of the undamped swing through here, by the arithmetic-geometric mean. */
static double swing_frequency(double omega_n, double th, double v);
#endif
