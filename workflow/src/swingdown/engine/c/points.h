/* What the generated functions of the catalogue read and write, and the sine and cosine they call. */
#ifndef POINTS_H
#define POINTS_H
#include "swing.h"

/* Points of a motion: arrays of n; z has a row of `stride` for each state, counted from the effect's own first. */
typedef struct {
    int n, stride;
    const double *th, *v, *a, *t, *sn, *cs, *z;
    double omega_n, duration, direction;
} Points;

/* Outputs are rows of `stride`: 0 torque (or the reading), 1 inertia, 2 + k the rate of state k.
 * Inputs of the derivatives: 0 theta (time, for a clock), 1 thetadot, 2 thetaddot, 3 + k state k; then the parameters. */
typedef struct {
    double *by, *by_parameter;
    int n_inputs, n_parameters, stride;
} Slopes;
#define BY(o, i) (d->by + ((o) * d->n_inputs + (i)) * d->stride)
#define BY_PARAMETER(o, k) (d->by_parameter + ((o) * d->n_parameters + (k)) * d->stride)

typedef void (*Values)(const Points *q, const double *p, const double *sign, double *out, Part at);
typedef void (*Derivatives)(const Points *q, const double *p, const double *sign, const Slopes *d, Part at);

/* How a state is found on a panel; the generator tells from its formula.
 * RATE: its rate is an unknown at the nodes, as the acceleration is. POSITION: its rate is the state `of`, so it is
 * integrated twice, as the angle is. FOLLOWER: z' = r + pull z, with r rising by `lead` a radian, and nothing but readings
 * depends on it: found exactly once the motion is known. ALONG: z' = (push + pull z) theta', a closed form in the angle from one reversal to the next. */
enum { RATE, POSITION, FOLLOWER, ALONG };
typedef struct {
    int kind, of;
} Manner;

typedef struct {
    Values motion, reading, initial, switches, linear; /* linear: of state k rows 3k pull, 3k + 1 push, 3k + 2 lead */
    Derivatives motion_slopes, reading_slopes, initial_slopes, linear_slopes;
    Manner manner[MAX_STATES];
    int n_parameters, n_states, n_switches;
    /* names t; adds inertia; has a broken power of the speed, which no polynomial follows well; can be as narrow in the
     * angle or the velocity as its parameters say */
    int timed, inertial, rough, sharp;
} Effect;

/* Sine and cosine that compilers vectorise and that give the same bits on every machine: reduce by whole turns,
 * take a quarter of the angle (Cephes polynomials on +-pi/4), double twice. */
static inline __attribute__((always_inline)) void sine_cosine(double x, double *s, double *c) {
    const double big = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to whole numbers */
    double turns = x * 0.15915494309189535 + big;
    turns -= big;
    double z = ((x - turns * 6.28318530717958623) - turns * 2.44929359829470635e-16) * 0.25;
    double zz = z * z;
    double ps = ((((1.58962301576546568060e-10 * zz - 2.50507477628578072866e-8) * zz + 2.75573136213857245213e-6) * zz
                  - 1.98412698295895385996e-4) * zz + 8.33333333332211858878e-3) * zz - 1.66666666666666307295e-1;
    double pc = ((((-1.13585365213876817300e-11 * zz + 2.08757008419747316778e-9) * zz - 2.75573141792967388112e-7) * zz
                  + 2.48015872888517045348e-5) * zz - 1.38888888888730564116e-3) * zz + 4.16666666666665929218e-2;
    double s0 = z + z * zz * ps, c0 = 1.0 - 0.5 * zz + zz * zz * pc;
    double s1 = 2.0 * s0 * c0, c1 = 1.0 - 2.0 * s0 * s0;
    *s = 2.0 * s1 * c1;
    *c = 1.0 - 2.0 * s1 * s1;
}
static inline double sine(double x) { double s, c; sine_cosine(x, &s, &c); return s; }
static inline double cosine(double x) { double s, c; sine_cosine(x, &s, &c); return c; }
#endif
