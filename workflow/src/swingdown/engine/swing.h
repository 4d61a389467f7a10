/* What the engine is given and what it reports: shared by the integrator, the fitter and their callers. */
#ifndef SWING_H
#define SWING_H

/* A pendulum model: rows of the table EFFECTS, each with the index of its first parameter. Parameter 0 is omega_n. */
typedef struct {
    int n_torques, n_sensors, n_clocks, n_parameters;
    const int *torques, *torque_first;
    const int *sensors, *sensor_first;
    const int *clocks, *clock_first;
    double duration; /* s */
} Model;

enum { DONE = 0, LOST_ACCURACY = 1, RAN_AWAY = 2, CLOCK_RUNS_BACK = 3, TOO_LARGE = 4, NO_MEMORY = 5 };
enum { MAX_PARAMETERS = 64, MAX_SWITCHES = 16 };

typedef struct {
    int status;
    int panels;         /* accepted */
    int rejected;       /* tried and shortened */
    int evaluations;    /* of the whole right-hand side at N points */
    int reversals;
    double error;       /* estimated angle error summed over the panels, rad */
    double stuck_after; /* s; time of the last sticking, or -1 */
} Report;

/* Angles read at times[0..n-1] (s, increasing; the release is at times[0]) from release angle and velocity; with
 * slopes, also their derivatives by the n_free free values (index of a parameter, RELEASE_ANGLE or RELEASE_VELOCITY),
 * one row of n each. On failure the rest is NaN and the status says why. */
enum { RELEASE_ANGLE = -1, RELEASE_VELOCITY = -2 };
int swing_trajectory(const Model *m, const double *p, double release_angle, double release_velocity,
                     const double *times, int n, int n_free, const int *free_values,
                     double *angles, double *slopes, Report *report);
#endif
