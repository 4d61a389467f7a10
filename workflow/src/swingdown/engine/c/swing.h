/* What the engine is given and what it reports: shared by the integrator, the fitter and their callers. */
#ifndef SWING_H
#define SWING_H

/* An effect of the model: its row in the table EFFECTS, and where its parameters and its states begin. */
typedef struct {
    int row, first_parameter, first_state;
} Part;

/* A pendulum model. Parameter 0 is omega_n. motions: what changes the motion or has states; sensors and clocks: what
 * changes the reading, in the order in which they act. */
typedef struct {
    int n_motions, n_sensors, n_clocks, n_parameters, n_states;
    const Part *motions, *sensors, *clocks;
    int play;        /* parameter that is the width of play before the sensors, or -1 */
    double duration; /* s */
} Model;

enum { DONE = 0, LOST_ACCURACY = 1, RAN_AWAY = 2, CLOCK_RUNS_BACK = 3, TOO_LARGE = 4, NO_MEMORY = 5 };
enum { MAX_PARAMETERS = 48, MAX_SWITCHES = 12, MAX_STATES = 5, MAX_PARTS = 32 };

typedef struct {
    int status;
    int panels;         /* accepted */
    int rejected;       /* tried and shortened */
    int evaluations;    /* of the whole right-hand side at all nodes */
    int reversals;
    double error;       /* estimated angle error summed over the panels, rad */
    double stuck_after; /* s; time of the last sticking, or -1 */
} Report;

/* Angles read at times[0..n-1] (s, increasing; the release is at times[0]) from release angle and velocity; with
 * slopes, also their derivatives by the n_free free values (index of a parameter, RELEASE_ANGLE or RELEASE_VELOCITY),
 * one row of n each. On failure the rest is NaN and the status says why; more panels than `pace` a second (and
 * some more) are a failure: infinite where a trajectory may take as long as it needs. */
enum { RELEASE_ANGLE = -1, RELEASE_VELOCITY = -2 };
int swing_trajectory(const Model *m, const double *p, double release_angle, double release_velocity,
                     const double *times, int n, double pace, int n_free, const int *free_values,
                     double *angles, double *slopes, Report *report);

/* Panels that a half-swing of this model usually takes, at most. */
double usual_panels(const Model *m);
#endif
