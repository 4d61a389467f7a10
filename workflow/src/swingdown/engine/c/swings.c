/* Fits of one or more swings with a common model, and of many series alike, side by side where they can be (lockstep.h):
 * fit_swings and fit_batch of interface.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "least_squares.h"
#include "lockstep.h"
#include "trajectory.h"

#define MOST_WORK 4.0      /* of a trajectory, times the usual */
#define FEW_RESIDUALS 50.0 /* no fewer tell whether they are white */
#define SMALL_PART 0.05    /* of a swing's squares about its mean */
/* Reduction that a last step promised, relative to the sum of squares, below which the slopes from before it are those after:
 * of 1e4 samples it went by 3e-5 of a standard error. */
#define SAME_SLOPES 1e-13

/* What the last point was like. */
typedef struct {
    double x[MAX_VARIABLES];
    int with_slopes, stops, driven; /* a swing sticks; friction drives one */
    double squares, steps;          /* of the residuals, and of those from each to the next: sums over all swings */
} LastPoint;

/* A fit under way: the cost function's own.
 *
 * Panels are the measure of work. Far from any optimum a trajectory may take thousands of times what it takes elsewhere (a
 * support that rings at 1e5 rad/s): a point that takes much more than the best so far counts as one that cannot be
 * computed, and a fit that has spent what its evaluations would usually take ends. */
typedef struct {
    const FitProblem *problem;
    double *residuals, *slopes; /* room for the longest swing */
    double *angles;             /* of all swings at the last point; or NULL */
    double seconds;             /* of all swings */
    double least;               /* half the sum of squares, so far */
    double usual, floor, left;  /* panels; usual: before anything is computed by the model; later no less than half of that */
    LastPoint last;
    double rough, coarseness;   /* of trajectories: at the start of a search, and since one was too rough */
} Fit;

/* The free values of a swing, and the variable that each is. */
typedef struct {
    int n, free_value[MAX_PARAMETERS], variable[MAX_PARAMETERS];
} SwingVariables;

static double dot(const double *a, const double *b, int n) {
    double lane[32] = {0.0}, sum = 0.0; /* a fixed order of summation: the same bits on every machine */
    int i = 0;
    for (; i + 32 <= n; i += 32)
        for (int k = 0; k < 32; k++) lane[k] += a[i + k] * b[i + k];
    for (; i < n; i++) sum += a[i] * b[i];
    for (int k = 0; k < 32; k++) sum += lane[k];
    return sum;
}

/* The parameters, release angle and release velocity of swing k. */
static inline double *values_of(const FitProblem *problem, int k) {
    return problem->values + (size_t)k * (problem->models[0].n_parameters + 2);
}

static inline const int *variables_of(const FitProblem *problem, int k) {
    return problem->variable_of + (size_t)k * (problem->models[0].n_parameters + 2);
}

/* Put the variables x into the values of swing k. */
static SwingVariables set_values(const FitProblem *problem, int k, const double *x) {
    SwingVariables own = {.n = 0};
    const int np = problem->models[0].n_parameters, *variable_of = variables_of(problem, k);
    double *values = values_of(problem, k);
    for (int i = 0; i < np + 2; i++) {
        if (variable_of[i] < 0) continue;
        values[i] = x[variable_of[i]];
        own.variable[own.n] = variable_of[i];
        own.free_value[own.n++] = i < np ? i : (i == np ? RELEASE_ANGLE : RELEASE_VELOCITY);
    }
    return own;
}

/* Add a swing's part to J'r and J'J. */
static void add_normal(const Fit *fit, const SwingVariables *own, int n, double *gradient, double *normal) {
    const int n_variables = fit->problem->n_variables;
    for (int i = 0; i < own->n; i++) {
        const double *row = fit->slopes + (size_t)i * n;
        const size_t at = own->variable[i];
        gradient[at] += dot(row, fit->residuals, n);
        for (int j = 0; j <= i; j++) {
            const size_t other = own->variable[j];
            const double product = dot(row, fit->slopes + (size_t)j * n, n);
            normal[at * n_variables + other] += product;
            if (i != j) normal[other * n_variables + at] += product;
        }
    }
}

/* Half of what the variables' distance from what is known of them adds to the sum of squares; its part of J'r and J'J. */
static double add_knowledge(const FitProblem *problem, const double *x, double *gradient, double *normal) {
    const Knowledge *known = &problem->known;
    const int n = problem->n_variables;
    double value = 0.0;
    if (!known->precision) return 0.0;
    for (int i = 0; i < n; i++) {
        double pull = 0.0;
        for (int j = 0; j < n; j++) {
            const double precision = known->precision[(size_t)i * n + j];
            pull += precision * (x[j] - known->mean[j]);
            if (gradient) normal[(size_t)i * n + j] += precision;
        }
        if (gradient) gradient[i] += pull;
        value += 0.5 * (x[i] - known->mean[i]) * pull;
    }
    return value;
}

/* The residuals of swing k and, where wanted, their slopes and the angles; the panels it took, or -1 where it cannot be computed. */
static int compute_swing(Fit *fit, int k, const SwingVariables *own, int with_slopes, double *computed) {
    const FitProblem *problem = fit->problem;
    const Model *m = &problem->models[k];
    const double *values = values_of(problem, k), *angles = problem->angles[k];
    const int n = problem->n_samples[k];
    const InitialValueProblem swing = {m, values, values[m->n_parameters], values[m->n_parameters + 1], problem->times[k], n,
                                       MOST_WORK * fit->usual / fit->seconds, fit->coarseness, own->n, own->free_value};
    TrajectoryReport report;
    const int failed = swing_trajectory(&swing, fit->residuals, with_slopes ? fit->slopes : NULL, &report);
    const int panels = report.panels + report.rejected;
    fit->left -= panels;
    if (report.anew) fit->coarseness = 1.0;
    if (failed) return -1;
    fit->last.stops |= report.stuck_after >= 0.0;
    fit->last.driven |= report.driven;
    if (computed) memcpy(computed, fit->residuals, n * sizeof(double));
    for (int i = 0; i < n; i++) fit->residuals[i] -= angles[i];
    return panels;
}

/* The squares of the steps from each residual to the next. */
static double steps_of(const double *r, int n) {
    return dot(r, r, n - 1) + dot(r + 1, r + 1, n - 1) - 2.0 * dot(r, r + 1, n - 1);
}

/* The Cost of a Fit. */
static double swings_cost(void *of, const double *x, double *gradient, double *normal) {
    Fit *fit = of;
    const FitProblem *problem = fit->problem;
    double value = 0.0, work = 0.0, *angles = fit->angles;
    if (fit->left <= 0.0) return NAN;
    memcpy(fit->last.x, x, problem->n_variables * sizeof(double));
    fit->last.with_slopes = gradient != NULL;
    fit->last.stops = fit->last.driven = 0;
    fit->last.steps = 0.0;
    if (gradient) {
        memset(gradient, 0, problem->n_variables * sizeof(double));
        memset(normal, 0, (size_t)problem->n_variables * problem->n_variables * sizeof(double));
    }
    for (int k = 0; k < problem->n_swings; k++) {
        const SwingVariables own = set_values(problem, k, x);
        const int n = problem->n_samples[k], panels = compute_swing(fit, k, &own, gradient != NULL, angles);
        if (panels < 0) return INFINITY;
        if (angles) angles += n;
        work += panels;
        value += 0.5 * dot(fit->residuals, fit->residuals, n);
        fit->last.steps += steps_of(fit->residuals, n);
        if (gradient) add_normal(fit, &own, n, gradient, normal);
    }
    fit->last.squares = 2.0 * value;
    value += add_knowledge(problem, x, gradient, normal);
    if (value < fit->least) {
        fit->least = value;
        fit->usual = fmax(work, fit->floor);
    }
    return value;
}

/* Room for the longest swing and its slopes; 0 where there is none, or a swing has more free values than the engine takes. */
static int open_fit(Fit *fit, const FitProblem *problem) {
    int longest = 0, widest = 0;
    *fit = (Fit){.problem = problem};
    for (int k = 0; k < problem->n_swings; k++) {
        const int n = problem->n_samples[k], *variable_of = variables_of(problem, k);
        int free_values = 0;
        for (int i = 0; i < problem->models[0].n_parameters + 2; i++) free_values += variable_of[i] >= 0;
        widest = free_values > widest ? free_values : widest;
        longest = n > longest ? n : longest;
        fit->seconds += problem->times[k][n - 1] - problem->times[k][0];
    }
    if (widest > MAX_PARAMETERS) return 0;
    fit->residuals = malloc((size_t)longest * (1 + widest) * sizeof(double));
    fit->slopes = fit->residuals + longest;
    return fit->residuals != NULL;
}

/* Panels that a swing's input asks for. */
static double pieces_of_swing(const FitProblem *problem, int k) {
    const double *times = problem->times[k];
    return 2.0 * pieces_a_second(&problem->models[k]) * (times[problem->n_samples[k] - 1] - times[0]);
}

/* What a fit from x may spend. */
static void set_budget(Fit *fit, const double *x, int most_evaluations) {
    const FitProblem *problem = fit->problem;
    const int variable = problem->variable_of[0]; /* of the natural frequency */
    const double frequency = variable >= 0 ? x[variable] : problem->values[0];
    fit->least = INFINITY;
    fit->coarseness = fit->rough;
    fit->usual = usual_panels(problem->models) * (problem->n_swings + fabs(frequency) * fit->seconds / PI);
    for (int k = 0; k < problem->n_swings; k++) fit->usual += pieces_of_swing(problem, k);
    fit->floor = 0.5 * fit->usual;
    fit->left = most_evaluations * fit->usual;
}

/* Whether the last point is the best one. */
static int is_at_best(const Fit *fit, const FitResult *result) {
    return !memcmp(fit->last.x, result->variables, fit->problem->n_variables * sizeof(double));
}

/* The best point: its swings and, unless those from before the last step are as good, its slopes. gradient, normal: room. */
static void evaluate_best(Fit *fit, FitResult *result, double *gradient, double *normal) {
    const SearchOutcome *outcome = &result->outcome;
    const size_t n = fit->problem->n_variables;
    const int same_slopes = outcome->converged == STATIONARY && outcome->predicted_reduction < SAME_SLOPES;
    fit->usual = fit->left = INFINITY;
    if (!is_at_best(fit, result) || !(fit->last.with_slopes || same_slopes)) {
        swings_cost(fit, result->variables, gradient, normal);
        memcpy(result->normal, normal, n * n * sizeof(double));
    }
    /* computed with slopes, angles differ in their last bits from those that a trajectory without them has */
    if (fit->angles && fit->last.with_slopes) swings_cost(fit, result->variables, NULL, NULL);
    result->outcome.stops = fit->last.stops;
    result->outcome.driven = fit->last.driven;
}

/* Whether the residuals just computed are white (von Neumann's ratio, Annals of Mathematical Statistics 12, 1941) and a small
 * part of the swings: then there is nothing left that another minimum could explain. */
static int leaves_noise(const Fit *fit) {
    const FitProblem *problem = fit->problem;
    double n = 0.0, swing = 0.0;
    for (int k = 0; k < problem->n_swings; k++) {
        double sum = 0.0;
        for (int i = 0; i < problem->n_samples[k]; i++) sum += problem->angles[k][i];
        const double mean = sum / problem->n_samples[k];
        for (int i = 0; i < problem->n_samples[k]; i++) swing += (problem->angles[k][i] - mean) * (problem->angles[k][i] - mean);
        n += problem->n_samples[k];
    }
    return n >= FEW_RESIDUALS && fit->last.squares < SMALL_PART * swing
        && fit->last.steps > 2.0 * (1.0 - 4.0 / sqrt(n)) * fit->last.squares;
}

/* Half the least sum of squares over all starts; x, normal: room for one of them. */
static double search_all(Fit *fit, const Starts *starts, const SearchOptions *options, double *x, double *normal, FitResult *result) {
    const FitProblem *problem = fit->problem;
    const LeastSquares least_squares = {swings_cost, fit, problem->n_variables, problem->bounds, *options};
    const size_t n = problem->n_variables;
    double least = INFINITY;
    int evaluations = 0;
    for (int k = 0; k < starts->n_starts; k++) {
        SearchOutcome outcome;
        memcpy(x, starts->variables + k * n, n * sizeof(double));
        set_budget(fit, x, options->most_evaluations);
        const KnownMinimum known = {result->variables, result->normal, least};
        const double value = search(&least_squares, result->outcome.converged == STATIONARY ? &known : NULL, 0, x, normal, &outcome);
        const int is_known = outcome.converged == AT_KNOWN_MINIMUM;
        evaluations += outcome.evaluations;
        result->squares[k] = 2.0 * (is_known ? least : value);
        if (!isfinite(value) || is_known) continue;
        if (value < least || (value == least && outcome.converged > result->outcome.converged)) {
            least = value;
            memcpy(result->variables, x, n * sizeof(double));
            memcpy(result->normal, normal, n * n * sizeof(double));
            result->outcome = outcome;
        }
        if (k || !starts->until_noise || result->outcome.converged != STATIONARY) continue;
        if (!is_at_best(fit, result)) swings_cost(fit, result->variables, NULL, NULL);
        if (fit->last.stops || !leaves_noise(fit)) continue;
        result->outcome.ends_in_noise = 1;
        while (++k < starts->n_starts) result->squares[k] = NAN;
    }
    result->outcome.evaluations = evaluations;
    return least;
}

double fit_swings(const FitProblem *problem, const Starts *starts, const SearchOptions *options, FitResult *result) {
    const size_t n = problem->n_variables;
    Fit fit;
    double least = INFINITY;
    result->outcome = (SearchOutcome){NOT_COMPUTABLE, 0, INFINITY, 0, 0, 0};
    double *room = malloc((n * n + n) * sizeof(double)), *x = room + n * n;
    if (open_fit(&fit, problem) && room) {
        fit.angles = result->angles;
        fit.rough = starts->rough && takes_many_panels(problem->models) ? COARSE : 1.0;
        least = search_all(&fit, starts, options, x, room, result);
        if (starts->evaluate_best && result->outcome.converged >= 0) evaluate_best(&fit, result, x, room);
    }
    free(fit.residuals);
    free(room);
    return 2.0 * least;
}

/* One series of a batch by itself. normal: room for a matrix. */
static void fit_series(const Batch *batch, const SearchOptions *options, int k, double *normal, BatchResult *result) {
    const int np = batch->model->n_parameters, n = batch->n_variables;
    double start[MAX_PARAMETERS + 2], squares, *values = batch->values + (size_t)k * (np + 2);
    const double *series = batch->series + (size_t)k * batch->n_samples;
    for (int i = 0; i < np + 2; i++)
        if (batch->variable_of[i] >= 0) start[batch->variable_of[i]] = values[i];
    const FitProblem one = {batch->model, 1, &batch->n_samples, &batch->times, &series, values, batch->variable_of, n, batch->bounds,
                            {NULL, NULL}};
    const Starts starts = {1, start, 0, 0, 0};
    FitResult fitted = {.variables = result->variables + (size_t)k * n, .normal = normal, .squares = &squares};
    result->squares[k] = fit_swings(&one, &starts, options, &fitted);
    result->converged[k] = fitted.outcome.converged;
    result->evaluations[k] = fitted.outcome.evaluations;
}

int fit_batch(const Batch *batch, const SearchOptions *options, BatchResult *result) {
    const size_t n = batch->n_variables;
    double *normal = malloc(n * n * sizeof(double));
    const int status = normal ? fit_in_lockstep(batch, options, result) : NO_MEMORY;
    for (int k = 0; k < batch->n_series && status == DONE; k++)
        if (result->alone[k]) fit_series(batch, options, k, normal, result);
    free(normal);
    return status;
}
