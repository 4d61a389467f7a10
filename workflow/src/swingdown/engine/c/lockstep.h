/* Fits side by side, each in a lane of its own: the same arithmetic for all, so a fit's numbers depend neither on its company
 * nor on how many lanes there are.
 *
 * Here are the models without states, added inertia or effects that may be narrow, whose sensors are affine. Of a smooth motion,
 * which does not depend on the velocity's sign, panels stand still in time, LOCKSTEP_NODES nodes each, the same for all fits and
 * evaluations. So a panel's angle is always a polynomial over the same samples, and the data count only by their part in the
 * space of those polynomials (lockstep_record.c): a fit's work does not grow with its samples. Of a directed motion, which does,
 * each lane's panels go from reversal to reversal (lockstep_swings.c). The last point's solution foretells the next one's, so
 * that Newton's iteration has little left to do. Fits that come where a panel is not accurate or does not converge are tried
 * once more with shorter panels; whatever else happens (a pendulum held at its release, a search that does not end at a minimum) is
 * left to the fits one by one. */
#ifndef LOCKSTEP_H
#define LOCKSTEP_H
#include "least_squares.h"
#include "system.h"

#define LN LOCKSTEP_NODES
#define TERMS (LN + 2) /* of a panel's angle: where and how fast it starts, and the accelerations at the nodes */
#define MOST_FREE 16

/* Loops of a fixed number of rounds are to be laid out whole, so that what they run over stays in registers. */
#ifdef __clang__
#define UNROLL _Pragma("clang loop unroll(full)")
#else
#define UNROLL _Pragma("GCC unroll 16")
#endif

/* ---- Numbers of each fit ---- */

static inline Each each(double x) { return (Each){0.0} + x; }
static inline Each choose(Which which, Each yes, Each no) {
    return (Each)(((Which)yes & which) | ((Which)no & ~which));
}
static inline Each size_of(Each x) { return (Each)((Which)x & 0x7fffffffffffffffLL); }
static inline Each larger(Each a, Each b) { return choose((Which)(a > b), a, b); }
static inline int any(Which which) {
    long long some = 0;
    for (int l = 0; l < WIDTH; l++) some |= which[l];
    return some != 0;
}

/* ---- A panel of the motion ---- */

/* terms: the start's angle, its velocity times the length h (s), and the accelerations at the nodes times h^2 */
typedef struct {
    Each h, t, th, v; /* where it starts */
    Each u[LN];       /* accelerations at the nodes: a guess, then the solution */
    Each by_angle[LN], by_velocity[LN], by_parameter[MAX_PARAMETERS * LN];
    Each factors[LN * LN], pivot[LN]; /* of the collocation equations; pivot: reciprocals */
} LockstepPanel;

typedef struct {
    const Model *model;
    Each p[MAX_PARAMETERS], direction, least; /* least: acceleration, against which errors count */
    double most_error;                        /* of a panel, over its limit */
    double coarseness;
} LockstepSystem;

/* Solve the panel for the fits chosen; those for which it is solved, accurately. */
static Which solve_lockstep(const LockstepSystem *s, LockstepPanel *panel, Which which);

/* The change of the accelerations for a change of the start and, unless it is -1, of a parameter. */
static void change_lockstep(const LockstepPanel *panel, Each th, Each v, int parameter, Each *change);

/* Angle and velocity at the panel's end, also of changes. */
static void end_lockstep(const LockstepPanel *panel, const Each *u, Each *th, Each *v);

/* ---- The samples ---- */

/* An orthonormal basis, over a panel's samples, of the angles that the panel can have; where there are no more samples than that,
 * they are the basis themselves. */
typedef struct {
    int n_samples, rows, triangular;
    double matrix[TERMS * TERMS]; /* by row: a panel's coordinates from its terms */
    double *by_sample, *by_column; /* rows of TERMS, padded to BASIS_ROW; columns of n_samples */
} SampleBasis;
#define BASIS_ROW ((TERMS + WIDTH - 1) / WIDTH * WIDTH)

typedef struct {
    int first; /* sample */
    const SampleBasis *basis;
} PanelSamples;

typedef struct {
    int n_panels;
    double h; /* s, of each */
    PanelSamples *panels;
    SampleBasis *bases;
    double *memory;
} LockstepRecord;

/* Panels no longer than that; 0 where there is no memory. */
static int open_lockstep_record(LockstepRecord *r, const double *times, int n, double longest);
static void close_lockstep_record(LockstepRecord *r);

/* The coordinates of a series, TERMS for each panel; the sum of squares (rad^2) of what no panel can follow. */
static double compress(const LockstepRecord *r, const double *series, double *coordinates);

/* ---- Fits ---- */

#define PANELS_OF(parts) ((parts) + 2)

/* The free values: parameter, RELEASE_ANGLE or RELEASE_VELOCITY; the variable that each is; whether the motion changes by it. */
typedef struct {
    int n, value[MOST_FREE], variable[MOST_FREE], moves[MOST_FREE];
} FreeSlots;

/* What a sensor, or all of them, make of the angle: gain times it plus zero, and its changes by the free values. */
typedef struct {
    double gain, zero, gain_by[MOST_FREE], zero_by[MOST_FREE];
} Affine;

/* The fit in one lane. */
typedef struct {
    int series; /* or -1 */
    Search search;
    SearchOutcome outcome;
    double off, off_gradient[MOST_FREE]; /* as of Lockstep, where the search is */
    double x[MOST_FREE], normal[MOST_FREE * MOST_FREE], *room;
    Point at;
} LaneFit;

/* The solution at a point: the accelerations at the nodes of all panels and, of each free value, their changes. */
typedef struct {
    Each x[MOST_FREE], *u, *changes;
} LockstepSolution;

typedef struct {
    const Batch *batch;
    LeastSquares problem;
    FreeSlots free;
    LockstepRecord record;
    LockstepSystem system;
    Each values[MAX_PARAMETERS + 2]; /* parameters, release angle and velocity */
    LockstepSolution last;           /* of each lane's last point */
    Each *data, missed;              /* coordinates of each lane's series, and what they leave */
    Each gain, zero, gain_by[MOST_FREE], zero_by[MOST_FREE];
    Each squares, gradient[MOST_FREE], normal[MOST_FREE * MOST_FREE]; /* at the point just computed */
    Each off, off_gradient[MOST_FREE]; /* the same against the reference, if there is one */
    /* what the last point foretells: n_kept numbers of each lane, the solution and, of a directed motion, where each panel began,
     * how fast, and the durations (s) of the half-swings; omega_n (rad/s) there. Of a directed motion the panels are numbered by
     * half-swing, each having room for PANELS_OF(parts) */
    int n_kept, n_half_swings;
    Each *kept, *angles_from, *velocities_from, *durations, last_omega;
    int directed, timed, parts; /* the motion depends on the velocity's sign, and on the time; panels of a half-swing */
    double half_swing; /* s */
    /* of the point from which the batch starts: it, what it foretells, and its angles and slopes, as coordinates or at the samples */
    int n_rows;
    double first[MOST_FREE], *first_kept, *first_angles, *first_slopes, first_normal[MOST_FREE * MOST_FREE];
    double *series, *reference; /* one, in the same way; NULL where there is no reference */
    double reference_missed;    /* what its coordinates leave of it */
    double first_off, first_off_gradient[MOST_FREE];
    const double *series_of[WIDTH], *reference_of; /* at the samples; where there is none, the first series */
    Each *angles;   /* room for the coordinates of one panel's angles and slopes */
    LaneFit fits[WIDTH];
    int next, again; /* the series; those left over, with shorter panels */
} Lockstep;

/* Sums of squares and slopes at s->values, for the fits chosen; those for which they could be computed. */
static Which evaluate_lockstep(Lockstep *s, Which which, int has_last);

/* The same of a motion that depends on the velocity's sign (lockstep_swings.c). */
static Which evaluate_swings(Lockstep *s, Which which, int has_last);

/* What a lane's sensors make of the angle, at its values. */
static void set_sensors(Lockstep *s, int lane);

/* ---- Batches ---- */

/* Fit the series of a batch that this is for; `alone` is set for all the others, which are yet to be fitted. A Status. */
static int fit_in_lockstep(const Batch *batch, const SearchOptions *options, BatchResult *result);
#endif
