/* What the instruments make of the motion: the clock that stamps the samples, play, and the sensors. */
#ifndef READING_H
#define READING_H
#include "system.h"

/* The free values, and the slopes by them of n samples, a row each. */
typedef struct {
    int n_free;
    const int *free_values;
} FreeValues;

/* The true times of the samples, from the first, and where wanted their slopes; 0 where the clock runs back. */
static int true_times(const InitialValueProblem *problem, const FreeValues *free, double *out, double *slopes);

/* Angles of n samples become what the sensors read, one after the other, with the slopes by the chain rule. states: their
 * rows with their slopes, where a sensor reads states. */
typedef struct {
    double *angles, *slopes;
    const double *states, *state_slopes;
} Readings;
static void read_sensors(const InitialValueProblem *problem, const FreeValues *free, const Readings *readings);

/* Play between the pendulum and its sensor: the reading follows only when pushed, a half width behind. */
typedef struct {
    int parameter; /* index of the width, or -1 */
    double reading, slope[MAX_PARAMETERS];
} Play;

/* The angle, with its slopes each `stride` further, pushes the reading where it is more than `half` the width away. */
static void push_play(Play *play, double half, double th, const FreeValues *free, const double *slopes, size_t stride);
#endif
