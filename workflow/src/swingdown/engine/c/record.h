/* The record: the samples of a trajectory, filled panel by panel from the dense output. */
#ifndef RECORD_H
#define RECORD_H
#include "reading.h"
#include "sensitivities.h"

/* Of every sample: true time, position on its panel, velocity, the clock's slopes, the states that sensors read and their
 * slopes; in one piece of memory. */
typedef struct {
    const InitialValueProblem *problem;
    FreeValues free;
    int next; /* the first sample that is not read yet */
    int n_states;
    double *memory, *times, *positions, *velocities, *clock_slopes, *states, *state_slopes;
    double *angles, *slopes; /* the caller's */
    Play play;
} Record;

/* A Status; memory is to be freed by close_record. */
static int open_record(Record *r, const InitialValueProblem *problem, double *angles, double *slopes);

/* The samples up to the time t_end, from the solved panel and the sensitivities along it. */
static void read_panel(Record *r, const System *s, const Panel *panel, const Sensitivities *d, double t_end);

/* The reading is pushed on by the point where the panel ends. */
static void push_play_on(Record *r, double th, const double *th_slopes);

/* All samples that are left, of a pendulum that rests for good. */
static void read_rest(Record *r, double th, const double *th_slopes);

/* The angles at the true times become readings; or, after a failure, no numbers. */
static void finish_record(Record *r, int status);
static void close_record(Record *r);
#endif
