/* The equations of motion of one pendulum: accelerations and states' rates with all signs frozen, so smooth. */
#ifndef SYSTEM_H
#define SYSTEM_H
#include "effect.h"
#include "lanes.h"

#define PI 3.141592653589793
#define BLOCKS (1 + MAX_STATES) /* rates: row 0 the acceleration, 1 + k that of state k */

typedef struct {
    const Model *model;
    const double *p;           /* the model's parameters */
    double direction;          /* of the velocity, frozen: 1 or -1; 0 before the first motion from rest */
    double largest_angle;      /* so far, rad */
    double coarseness;         /* of errors, over the usual limits */
    double sign[MAX_SWITCHES]; /* frozen, of every other argument of an abs() or sign() in the model */
    int first_sign[MAX_EFFECTS], n_switches;
    int timed, inertial, fractional_power, localised; /* any effect is (effect.h) */
    int piece;                                        /* of the model's input, frozen as signs are */
    int stuck;                                        /* friction holds the pendulum: no acceleration */
    int lags;                                         /* states that are first-order lags */
    /* Blocks of unknowns: the acceleration, then the rates of the collocated states; row: of a block among all rates.
     * method[k].of: for a COLLOCATED and an INTEGRATED state its block. */
    int blocks, row[BLOCKS];
    StateMethod method[MAX_STATES];
    /* of the states that are linear in themselves, in the present direction (effect.h): per second, or per radian */
    double relaxation[MAX_STATES], drive[MAX_STATES], gain[MAX_STATES];
    double relaxation_by[MAX_STATES][MAX_PARAMETERS], drive_by[MAX_STATES][MAX_PARAMETERS];
} System;

/* A point of the motion in phase space: time, angle, velocity, states. */
typedef struct {
    double t, th, v, z[MAX_STATES];
} PhasePoint;

/* At most N points of a motion; a: what the states' equations take for the acceleration; z: a row of N for each state. */
typedef struct {
    int n;
    const double *th, *v, *a, *t, *z;
} MotionPoints;

/* Lay out the unknowns and switches of a model; 0 where it has more of anything than the engine takes. */
static int set_up_system(System *s, const Model *model, const double *p, int n_free);

/* Accelerations and states' rates, a row of N each; share: of the torque that accelerates, 1 / (1 + added inertia). */
static void right_hand_side(const System *s, const MotionPoints *at, double *out, double *share);

/* The acceleration at one point for one direction of motion, and where wanted all rates in `out`, those of the states with
 * the acceleration found first. */
static double rates_at(System *s, const PhasePoint *x, double direction, double *out);

/* The piece of the input that acts from a time (s) on, put into the system; until when it does (infinite without an input). */
static double choose_piece(System *s, double t);

/* The input and its first three derivatives by time at n times, rows of N. */
#define INPUT_ROWS 4
static void sample_input(const System *s, int n, const double *t, double *out);

/* The arguments of abs() and sign(), a row of N each; the same at one point. */
static void switch_values(const System *s, const MotionPoints *at, double *out);
static void switches_at(const System *s, const PhasePoint *x, double *out);
#endif
