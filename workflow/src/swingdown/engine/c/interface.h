/* The engine's interface: every structure, constant and function that Python hands over or calls. The C compiler and
 * Python (engine/interface.py) both read this file, and it stands nowhere else; so it holds plain declarations alone.
 *
 * Units: angles in rad, times in s, so velocities in rad/s. Matrices row by row. */
#ifndef INTERFACE_H
#define INTERFACE_H

enum Limits { MAX_PARAMETERS = 48, MAX_SWITCHES = 12, MAX_STATES = 5, MAX_EFFECTS = 32, MAX_VARIABLES = 192 };

/* ---- Models ---- */

/* An effect of the catalogue as a model has it: its row in the table EFFECTS, and where its parameters and its states
 * begin among the model's. */
typedef struct {
    int row, first_parameter, first_state;
} PlacedEffect;

/* A measured drive u(t), from one knot to the next a cubic: on piece k, between knots k and k + 1 (s since the first sample), four
 * coefficients of the powers of the time since knot k, the lowest first. Before the first knot and beyond the last one the pieces
 * there go on. */
typedef struct {
    int n_pieces;
    const double *knots, *coefficients;
} Input;

/* A pendulum model. Parameter 0 is omega_n (rad/s). motions: what changes the motion or has states; sensors and clocks:
 * what changes the reading, in the order in which they act. */
typedef struct {
    int n_motions, n_sensors, n_clocks, n_parameters, n_states;
    const PlacedEffect *motions, *sensors, *clocks;
    int play;        /* parameter that is the width of play (rad) before the sensors, or -1 */
    int reads_rate;  /* 1: what is read is the angular velocity (rad/s), and there is no play; 0: the angle */
    double duration; /* of the record, s */
    const Input *input; /* what drives it; or NULL */
    int input_delay;    /* parameter: by how much (s) the drive acts later than its stamps say, or -1 */
} Model;

/* ---- Trajectories ---- */

enum Status { DONE = 0, LOST_ACCURACY = 1, RAN_AWAY = 2, CLOCK_RUNS_BACK = 3, TOO_LARGE = 4, NO_MEMORY = 5, NOT_UNIQUE = 6 };

/* Free values that are no parameters. */
enum Release { RELEASE_ANGLE = -1, RELEASE_VELOCITY = -2 };

/* Errors of a rough trajectory, of a model that takes many panels, over the usual limits. One with slopes, that by the release
 * angle among them, is computed anew as exactly as usual where its error may come to a micro-radian. */
enum Rough { COARSE = 100 };

/* A release and the times at which the angle is read. */
typedef struct {
    const Model *model;
    const double *parameters;
    double release_angle, release_velocity;
    const double *times; /* increasing; the release is at the first */
    int n_times;
    double most_panels; /* a second: more (and some more) are a failure; infinite where it may take as long as it needs */
    double coarseness;  /* errors may be so many times as large as usual; below 1 smaller */
    int n_free;
    const int *free_values; /* index of a parameter, RELEASE_ANGLE or RELEASE_VELOCITY */
} InitialValueProblem;

typedef struct {
    int status;
    int panels;         /* accepted */
    int rejected;       /* tried and shortened */
    int evaluations;    /* of the whole right-hand side at all nodes */
    int reversals;
    double error;       /* estimated angle error summed over the panels, rad */
    double stuck_after; /* s; time of the last sticking, or -1 */
    int driven;         /* at some rest friction pushed the pendulum on instead of back */
    double largest_angle; /* rad, from the bottom */
    int anew;           /* it was too rough, and computed as exactly as usual */
} TrajectoryReport;

/* The status, and the angles read at the times; with slopes, also their derivatives by the free values, one row of
 * n_times each. On failure what could not be computed is NaN and the status says why. */
int swing_trajectory(const InitialValueProblem *problem, double *angles, double *slopes, TrajectoryReport *report);

/* ---- Least squares ---- */

/* Half the sum of squares at x; with gradient, also J'r and J'J (n by n). Infinite where x cannot be computed, not a
 * number where nothing more is to be computed: the search then ends as it stands. */
typedef double (*Cost)(void *of, const double *x, double *gradient, double *normal);

typedef struct {
    const double *lower, *upper; /* one for each variable; infinite where there is none */
} Bounds;

typedef struct {
    int most_evaluations;
    double tolerance; /* relative fall of the sum of squares below which it is stationary */
    int foretells;    /* a step that promises less than that ends the search, taken as the slopes foretell it, not tried */
} SearchOptions;

enum Convergence { NOT_COMPUTABLE = -1, NOT_STATIONARY = 0, STATIONARY = 1, AT_KNOWN_MINIMUM = 2 };

typedef struct {
    int converged; /* a Convergence; NOT_STATIONARY: all evaluations are spent, or no way led on */
    int evaluations;
    double predicted_reduction; /* of the last full step, relative to the sum of squares */
    int stops;                  /* a swing sticks within its record, where that was looked at */
    int ends_in_noise;          /* nothing but white noise is left, where that was looked at */
    int driven;                 /* friction drives a swing (TrajectoryReport), where that was looked at */
} SearchOutcome;

typedef struct {
    Cost cost;
    void *of; /* handed to cost */
    int n_variables;
    Bounds bounds;
    SearchOptions options;
} LeastSquares;

/* Half the least sum of squares within the bounds, from x, which moves to the minimum; normal: J'J there. */
double minimise(const LeastSquares *problem, double *x, double *normal, SearchOutcome *outcome);

/* ---- Fits of swings ---- */

/* What is known of the variables before any swing: (x - mean)' precision (x - mean) joins the sum of squares, in rad^2. The
 * precision is a matrix of the variables; NULL where nothing is known. */
typedef struct {
    const double *mean, *precision;
} Knowledge;

/* One or more swings with a common model. values: by swing, a row of the model's parameters, release angle and release
 * velocity; variable_of: for each of them the variable it is, or -1 where it stays as given. */
typedef struct {
    const Model *models; /* one a swing: they differ in duration */
    int n_swings;
    const int *n_samples;
    const double *const *times, *const *angles;
    double *values; /* overwritten where variable */
    const int *variable_of;
    int n_variables;
    Bounds bounds;
    Knowledge known;
} FitProblem;

/* The starts of a fit, row by row. evaluate_best: whether J'J and `stops` are wanted at the best point itself. until_noise: the
 * others are not tried where the first leads to a minimum that leaves nothing but white noise, far smaller than the swing. rough:
 * the best point is no more than where another search starts, so trajectories may be coarse. */
typedef struct {
    int n_starts;
    const double *variables;
    int evaluate_best, until_noise, rough;
} Starts;

typedef struct {
    double *variables; /* at the best of all minima */
    double *normal;    /* J'J there, or of a point close by where it was not asked for */
    double *angles;    /* the swings' angles there, one after the other, where it was asked for; NULL: not wanted */
    double *squares;   /* the sum of squares that each start came to, rad^2; not a number where it was not tried */
    SearchOutcome outcome;
} FitResult;

/* The least sum of squares (rad^2) over all starts. */
double fit_swings(const FitProblem *problem, const Starts *starts, const SearchOptions *options, FitResult *result);

/* Many series of angles over the same times, each fitted alone. values: by series, the row it starts from. */
typedef struct {
    const Model *model;
    int n_samples;
    const double *times;
    int n_series;
    const double *series;
    double *values; /* overwritten where variable */
    const double *guess; /* a row near which all start */
    const int *variable_of;
    int n_variables;
    Bounds bounds;
    const double *reference; /* a series that the fits are compared with, rad; or NULL */
    const double *curvature; /* matrix of the variables: what J'J lacks of the curvature of half the sum of squares; or NULL */
    double coarseness;       /* side by side, errors may be so many times as large as usual, at least 1 */
} Batch;

typedef struct {
    double *variables, *squares; /* by series: a row of variables; the sum of squares, rad^2 */
    double *off; /* the sum of squares of the fitted angles less the reference, rad^2: of those that are not alone */
    int *converged, *evaluations, *alone; /* alone: not in lockstep with others, which takes longer */
} BatchResult;

/* The status. */
int fit_batch(const Batch *batch, const SearchOptions *options, BatchResult *result);
#endif
