/* An effect of the catalogue as compiled code: what the functions generated from its formulas (engine/generate.py) read
 * and write, and the sine and cosine they call. */
#ifndef EFFECT_H
#define EFFECT_H
#include "interface.h"
#include "lane_types.h"

/* Points of a motion: arrays of n; z has a row of `stride` for each state, counted from the effect's own first. */
typedef struct {
    int n, stride;
    const double *th, *v, *a, *t, *sn, *cs, *z; /* angle, velocity, acceleration, time, sine and cosine, states */
    double omega_n, duration, direction;
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

/* Sine and cosine that compilers vectorise and that give the same bits on every machine: reduce by whole turns,
 * take a quarter of the angle (Cephes polynomials on +-pi/4), double twice. Adding `big`, 1.5 * 2^52, rounds to whole
 * numbers. */
#define DEFINE_SINE_COSINE(name, Real) \
static inline __attribute__((always_inline)) void name(Real x, Real *s, Real *c) {                                              \
    const double big = 6755399441055744.0;                                                                                      \
    Real turns = x * 0.15915494309189535 + big;                                                                                 \
    turns -= big;                                                                                                               \
    Real z = ((x - turns * 6.28318530717958623) - turns * 2.44929359829470635e-16) * 0.25;                                      \
    Real zz = z * z;                                                                                                            \
    Real ps = ((((1.58962301576546568060e-10 * zz - 2.50507477628578072866e-8) * zz + 2.75573136213857245213e-6) * zz           \
                  - 1.98412698295895385996e-4) * zz + 8.33333333332211858878e-3) * zz - 1.66666666666666307295e-1;              \
    Real pc = ((((-1.13585365213876817300e-11 * zz + 2.08757008419747316778e-9) * zz - 2.75573141792967388112e-7) * zz          \
                  + 2.48015872888517045348e-5) * zz - 1.38888888888730564116e-3) * zz + 4.16666666666665929218e-2;              \
    Real s0 = z + z * zz * ps, c0 = 1.0 - 0.5 * zz + zz * zz * pc;                                                              \
    Real s1 = 2.0 * s0 * c0, c1 = 1.0 - 2.0 * s0 * s0;                                                                          \
    *s = 2.0 * s1 * c1;                                                                                                         \
    *c = 1.0 - 2.0 * s1 * s1;                                                                                                   \
}
DEFINE_SINE_COSINE(sine_cosine, double)
DEFINE_SINE_COSINE(sines_cosines, Each)
static inline double sine(double x) { double s, c; sine_cosine(x, &s, &c); return s; }
static inline double cosine(double x) { double s, c; sine_cosine(x, &s, &c); return c; }
static inline Each sines(Each x) { Each s, c; sines_cosines(x, &s, &c); return s; }
static inline Each cosines(Each x) { Each s, c; sines_cosines(x, &s, &c); return c; }
#endif
