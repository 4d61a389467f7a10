/* Of fits side by side whose motion depends on the velocity's sign: where each lane's swing is, and how its samples are read. */
#ifndef LOCKSTEP_SWINGS_H
#define LOCKSTEP_SWINGS_H
#include "lockstep.h"

/* Where each lane's swing is. */
typedef struct {
    LockstepPanel panel;
    Each th[MOST_FREE], v[MOST_FREE]; /* changes of the panel's start */
    Each duration;                    /* of a half-swing, s: that expected of this one */
    Each since;                       /* s: the time of the last reversal, or of the release */
    int part[WIDTH], sample[WIDTH];   /* panel of the half-swing; the next sample */
    int half[WIDTH], released[WIDTH]; /* the half-swing, and whether it began with the release */
} Swing;

/* A panel's angle and velocity as coefficients of the powers of the position. */
typedef struct {
    Each th[LN + 2], v[LN + 1];
} Course;

static inline __attribute__((always_inline)) Each value_of(const Each *c, int degree, Each x) {
    Each value = c[degree];
    UNROLL
    for (int k = degree - 1; k >= 0; k--) value = value * x + c[k];
    return value;
}

/* Read the samples up to the time `end` and add them to the sum of squares, J'r and J'J. */
static void read_swings(Lockstep *s, Swing *w, Which which, const Course *course, const Each (*changes)[LN + 2], Each end, int has_last);

/* Friction holds a lane's pendulum where it is, and all samples left read the same. */
static void read_at_rest(Lockstep *s, Swing *w, int l, int has_last);
#endif
