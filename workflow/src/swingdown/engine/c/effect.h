/* An effect of the catalogue as compiled code: what the functions generated from its formulas (engine/generate.py) read
 * and write. */
#ifndef EFFECT_H
#define EFFECT_H
#include "elementary.h"
#include "interface.h"

/* Points of a motion: arrays of n; z has a row of `stride` for each state, counted from the effect's own first. */
typedef struct {
    int n, stride;
    const double *th, *v, *a, *t, *sn, *cs, *z; /* angle, velocity, acceleration, time, sine and cosine, states */
    double omega_n, duration, direction;
    const double *u; /* the input and its first three derivatives by time, rows of `stride`; of a model that is driven */
} Points;

/* Partial derivatives of a formula's outputs, rows of `stride`.
 * Outputs: 0 torque (or the reading), 1 inertia, 2 + k the rate of state k.
 * Inputs: 0 theta (time, for a clock), 1 thetadot, 2 thetaddot, 3 + k state k; then the model's parameters. */
typedef struct {
    double *by_input, *by_parameter;
    int n_inputs, n_parameters, stride;
} Partials;
/* in a function that has its Partials as d */
#define PARTIAL(output, input) (d->by_input + ((output) * d->n_inputs + (input)) * d->stride)
#define PARTIAL_BY_PARAMETER(output, k) (d->by_parameter + ((output) * d->n_parameters + (k)) * d->stride)

/* sign: the frozen signs of the arguments of abs() and sign() in the effect's formulas. out: rows of `stride`, outputs as
 * above, added to. */
typedef void (*Formula)(const Points *q, const double *p, const double *sign, double *out, PlacedEffect at);
typedef void (*FormulaPartials)(const Points *q, const double *p, const double *sign, const Partials *d, PlacedEffect at);

/* The same for fits side by side, a lane each (lockstep.h), at its LOCKSTEP_NODES points: the torque alone, and with its
 * derivatives; by_parameter: rows of LOCKSTEP_NODES, omega_n's and the effect's own. All are added to, but by the effect's own. */
typedef struct {
    const Each *th, *v, *t, *sn, *cs;
    Each omega_n, direction;
    double duration;
} LockstepPoints;
typedef void (*LockstepFormula)(const LockstepPoints *q, const Each *p, Each *torque);
typedef void (*LockstepPartials)(const LockstepPoints *q, const Each *p, Each *torque, Each *by_angle, Each *by_velocity,
                                 Each *by_omega, Each *by_own);

/* How a state is found on a panel; the generator tells from its formula.
 * COLLOCATED: its rate is an unknown at the nodes, as the acceleration is.
 * INTEGRATED: its rate is the collocated state `of`, so it is integrated twice, as the angle is.
 * LAG: first-order lag, z' = input - relaxation z, and nothing but readings depends on it: found exactly once the motion
 * is known. Its input rises by `gain` a radian.
 * RATE_INDEPENDENT: z' = (drive - relaxation z) theta', hysteresis that knows the path but not the speed: a closed form
 * in the angle from one reversal to the next, towards the equilibrium drive / relaxation. */
enum StateKind { COLLOCATED, INTEGRATED, LAG, RATE_INDEPENDENT };
typedef struct {
    int kind, of;
} StateMethod;

/* Where an effect can change all at once, so that the nodes may pass over it. */
enum Localised { NOWHERE = 0, IN_VELOCITY_OR_TIME = 1, IN_ANGLE = 2 };

typedef struct {
    /* linear: of state k rows 3k relaxation, 3k + 1 drive, 3k + 2 gain */
    Formula motion, reading, initial, switches, linear;
    FormulaPartials motion_partials, reading_partials, initial_partials, linear_partials;
    StateMethod method[MAX_STATES];
    int n_parameters, n_states, n_switches;
    /* names t; adds inertia; has a broken power of the speed, which no polynomial follows well; a Localised */
    int timed, inertial, fractional_power, localised;
    LockstepFormula lockstep; /* NULL where the formulas are not for it */
    LockstepPartials lockstep_partials;
    int directed, affine; /* the motion has the velocity's sign; the reading is affine in the angle, and in nothing else */
} Effect;
#endif
