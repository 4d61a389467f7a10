#include "least_squares.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAME 1e-6 /* of the sum of squares: how near to a known minimum is the same place */
#define TINY 1e-300
#define MOST_DAMPING 1e18
#define PATIENCE 10 /* evaluations */
#define HOPE 10.0 /* times what a full step promises: what lies further below is another minimum's */
#define AT_KINK 100.0 /* times the tolerance: where last steps are foretold, a step that promises less and does not gain is the last */

/* ---- Linear algebra ---- */

/* The lower triangle's Cholesky factor of the k x k matrix in place; 0 where it is not positive definite. */
static int factorise(int k, double *a) {
    for (int i = 0; i < k; i++)
        for (int j = 0; j <= i; j++) {
            double sum = a[i * k + j];
            for (int l = 0; l < j; l++) sum -= a[i * k + l] * a[j * k + l];
            if (i != j) a[i * k + j] = sum / a[j * k + j];
            else if (sum > 1e-15 * a[i * k + i]) a[i * k + i] = sqrt(sum);
            else return 0;
        }
    return 1;
}

static void substitute(int k, const double *a, double *b) {
    for (int i = 0; i < k; i++) {
        for (int l = 0; l < i; l++) b[i] -= a[i * k + l] * b[l];
        b[i] /= a[i * k + i];
    }
    for (int i = k - 1; i >= 0; i--) {
        for (int l = i + 1; l < k; l++) b[i] -= a[l * k + i] * b[l];
        b[i] /= a[i * k + i];
    }
}

/* The damped Gauss-Newton step of the variables that no bound holds (those of the others are given); 0 where J'J with the
 * damping is not positive definite. */
static int solve_damped(Search *s, double damping) {
    int index[MAX_VARIABLES], k = 0;
    const int n = s->n;
    for (int i = 0; i < n; i++)
        if (!s->active[i]) index[k++] = i;
    double *a = s->cholesky, *rhs = a + k * k;
    for (int i = 0; i < k; i++) {
        const double *row = s->normal + index[i] * n;
        double b = -s->gradient[index[i]];
        for (int j = 0; j < n; j++)
            if (s->active[j]) b -= row[j] * s->step[j];
        rhs[i] = b;
        for (int j = 0; j <= i; j++) a[i * k + j] = row[index[j]];
        a[i * k + i] += damping * s->scale[index[i]] + TINY;
    }
    if (!factorise(k, a)) return 0;
    substitute(k, a, rhs);
    for (int i = 0; i < k; i++) s->step[index[i]] = rhs[i];
    return 1;
}

/* Size of a step in units of what each variable does to the residuals. */
static double length(const Search *s, const double *d) {
    double sum = 0.0;
    for (int i = 0; i < s->n; i++) sum += s->scale[i] * d[i] * d[i];
    return sqrt(sum);
}

/* Reduction of half the sum of squares that the linearised residuals promise for the step. */
static double predicted_reduction(const Search *s) {
    double fall = 0.0;
    for (int i = 0; i < s->n; i++) {
        double row = 0.0;
        for (int j = 0; j < s->n; j++) row += s->normal[i * s->n + j] * s->step[j];
        fall -= s->step[i] * (s->gradient[i] + 0.5 * row);
    }
    return fall;
}

/* ---- Steps within bounds ---- */

/* The step with the present damping: a variable that would cross its bound stops there, the rest is solved anew. */
static int step_within_bounds(Search *s) {
    const double *lower = s->problem->bounds.lower, *upper = s->problem->bounds.upper;
    for (int i = 0; i < s->n; i++) {
        s->active[i] = (s->x[i] <= lower[i] && s->gradient[i] > 0.0) || (s->x[i] >= upper[i] && s->gradient[i] < 0.0);
        s->step[i] = 0.0;
    }
    for (int again = 1; again;) {
        if (!solve_damped(s, s->damping)) return 0;
        again = 0;
        for (int i = 0; i < s->n; i++) {
            if (s->active[i]) continue;
            const double low = lower[i] - s->x[i], high = upper[i] - s->x[i];
            if (s->step[i] < low || s->step[i] > high) {
                s->step[i] = s->step[i] < low ? low : high;
                s->active[i] = 1;
                again = 1;
            }
        }
    }
    return 1;
}

/* A step no longer than the trust radius: damped the more until it is. */
static Proposal propose(Search *s) {
    Proposal step = {1, INFINITY, 0.0, 0.0, 0, 0};
    for (int shorter = 0; shorter < 60; shorter++) {
        step.solvable = step_within_bounds(s);
        step.size = length(s, s->step);
        if (!step.solvable || s->trust_radius == 0.0 || step.size <= s->trust_radius) break;
        s->damping = 4.0 * fmax(s->damping, 1e-4);
    }
    const double tolerance = s->problem->options.tolerance;
    step.predicted = step.solvable ? predicted_reduction(s) : 0.0;
    step.relative = step.predicted / (s->value + TINY);
    step.without_slopes = s->skip_last_slopes && step.relative < tolerance && s->damping < 1.0;
    /* residuals down to their rounding, as of a model fitted to itself: the sum wanders, but nothing moves any more */
    step.motionless = step.solvable && step.size <= tolerance * length(s, s->x);
    return step;
}

static int moves(const Search *s) {
    for (int i = 0; i < s->n; i++)
        if (s->step[i] != 0.0) return 1;
    return 0;
}

/* What the step without damping promises, relative to the sum of squares, where searches end with a foretold one: in a narrow
 * valley damped steps promise next to nothing far from the minimum. The step is left in place. */
static double promise(Search *s) {
    const double damping = s->damping;
    s->damping = 1e-12;
    const int solvable = step_within_bounds(s);
    s->damping = damping;
    return solvable ? predicted_reduction(s) / (s->value + TINY) : INFINITY;
}

/* Whether hardly damped steps promise less than so many times the tolerance: `relative`, and what there is beyond it. */
static int promises_little(Search *s, double relative, double times) {
    const double least = times * s->problem->options.tolerance;
    return relative < least && s->damping < 1.0 && (!s->problem->options.foretells || promise(s) < least);
}

/* ---- The search ---- */

static int is_at(const Search *s, const KnownMinimum *known) {
    if (!(fabs(s->value - known->value) <= SAME * known->value)) return 0;
    double distance = 0.0;
    for (int i = 0; i < s->n; i++)
        for (int j = 0; j < s->n; j++)
            distance += 0.5 * (s->x[i] - known->x[i]) * known->normal[i * s->n + j] * (s->x[j] - known->x[j]);
    return distance <= SAME * known->value;
}

/* Whether the search goes straight to a minimum that lies above the known one. */
static int ends_above(Search *s, const KnownMinimum *known) {
    const double above = s->value - known->value;
    return above > SAME * known->value && s->gain > 0.75 && s->damping < 1.0 && HOPE * promise(s) * s->value < above;
}

/* The step is taken and has the value `found`, lower by `fall`, and slopes where it is not the last. */
static void arrive(Search *s, double found) {
    const Proposal *step = &s->proposal;
    const double tolerance = s->problem->options.tolerance, gain = s->gain;
    s->value = found;
    s->outcome->predicted_reduction = step->relative;
    const int at_end = (s->fall < tolerance && promises_little(s, step->relative, 1.0)) || (step->motionless && s->damping < 1.0);
    if (s->value == 0.0 || at_end) s->outcome->converged = STATIONARY;
    if (gain > 0.75) s->trust_radius = fmax(s->trust_radius, 2.0 * step->size);
    const double twice = 2.0 * gain - 1.0;
    s->damping = fmax(1e-14, s->damping * fmax(0.05, 1.0 - twice * twice * twice));
    s->growth = 4.0;
    if (s->known && !s->outcome->converged && is_at(s, s->known)) s->outcome->converged = AT_KNOWN_MINIMUM;
    s->stage = s->outcome->converged == NOT_STATIONARY ? PROPOSES : OVER;
    if (s->known && s->stage == PROPOSES && ends_above(s, s->known)) s->stage = OVER;
}

/* Take the step. */
static void accept(Search *s, double found) {
    const Proposal *step = &s->proposal;
    s->gain = (s->value - found) / step->predicted;
    s->fall = (s->value - found) / (s->value + TINY);
    memcpy(s->x, s->trial, s->n * sizeof(double));
    if (!step->without_slopes) {
        memcpy(s->gradient, s->trial_gradient, s->n * sizeof(double));
        memcpy(s->normal, s->trial_normal, (size_t)s->n * s->n * sizeof(double));
    } else if (s->fall >= s->problem->options.tolerance) { /* more than predicted: not the end after all */
        s->stage = WANTS_SLOPES;
        return;
    }
    arrive(s, found);
}

/* No shorter step gains: a minimum only if a full step would gain or move next to nothing. */
static void judge_no_gain(Search *s) {
    memset(s->step, 0, s->n * sizeof(double));
    const int solvable = solve_damped(s, 1e-10);
    const double relative = solvable ? predicted_reduction(s) / (s->value + TINY) : INFINITY;
    s->outcome->predicted_reduction = relative;
    s->outcome->converged = relative < 1e-8 || (solvable && length(s, s->step) < 1e-8 * length(s, s->x));
}

/* Damp the next step more, unless there is nothing more to gain. */
static void reject(Search *s, double found) {
    const Proposal *step = &s->proposal;
    /* the prediction is within the rounding of the sum itself */
    const double times = s->problem->options.foretells ? AT_KINK : 1.0;
    const int negligible = (step->predicted > 0.0 && promises_little(s, step->relative, times)) || (step->motionless && s->damping < 1.0);
    s->stage = PROPOSES;
    if (step->solvable && negligible) {
        s->outcome->converged = STATIONARY;
        s->outcome->predicted_reduction = step->relative;
        s->stage = OVER;
        return;
    }
    /* where there is no trajectory at all the step was far too long, and finding that out is costly */
    s->damping = isfinite(found) || !step->solvable ? s->damping * s->growth : fmax(s->damping, 1e-2) * 100.0;
    s->growth *= 2.0;
    if (s->damping <= MOST_DAMPING) return;
    judge_no_gain(s);
    s->stage = OVER;
}

/* Whether the search may end with the step as it is foretold, without damping: next to nothing. */
static int may_foretell(Search *s) {
    Proposal *step = &s->proposal;
    const double tolerance = s->problem->options.tolerance;
    if (!s->problem->options.foretells || !step->solvable || !(step->predicted > 0.0) || step->relative >= tolerance) return 0;
    step->relative = promise(s);
    step->predicted = step->relative * s->value;
    if (step->relative < tolerance && step->predicted >= 0.0) return 1;
    s->proposal = propose(s);
    return 0;
}

static void move_to_trial(Search *s) {
    const Bounds *bounds = &s->problem->bounds;
    for (int i = 0; i < s->n; i++) s->trial[i] = fmin(fmax(s->x[i] + s->step[i], bounds->lower[i]), bounds->upper[i]);
}

static void foretell(Search *s) {
    move_to_trial(s);
    memcpy(s->x, s->trial, s->n * sizeof(double));
    s->value = fmax(s->value - s->proposal.predicted, 0.0);
    s->foretold = 1;
    s->outcome->converged = STATIONARY;
    s->outcome->predicted_reduction = s->proposal.relative;
    s->stage = OVER;
}

/* Propose the next step, to s->trial. */
static void propose_next(Search *s) {
    for (int i = 0; i < s->n; i++) s->scale[i] = fmax(0.5 * s->scale[i], s->normal[i * s->n + i]);
    /* the first steps stay shorter than the way from zero to the start */
    if (s->trust_radius < 0.0) s->trust_radius = 0.5 * length(s, s->x);
    s->proposal = propose(s);
    if (may_foretell(s)) foretell(s);
    else if (s->proposal.solvable && !moves(s)) {
        s->outcome->converged = STATIONARY;
        s->outcome->predicted_reduction = 0.0;
        s->stage = OVER;
    } else if (!s->proposal.solvable || !(s->proposal.predicted > 0.0)) reject(s, INFINITY); /* there is no step to take */
    else {
        move_to_trial(s);
        s->stage = TRIES;
        if (memcmp(s->trial, s->x, s->n * sizeof(double))) return;
        judge_no_gain(s); /* damped until it is below the values' rounding: it would be taken again and again */
        s->stage = OVER;
    }
}

/* Where last steps are foretold: whether the last steps gained next to nothing together, as at a cusp, whose slopes promise more. */
static int stalls(Search *s) {
    if (!s->problem->options.foretells || s->outcome->evaluations < s->looked_at + PATIENCE) return 0;
    s->stalled = s->looked_at && s->looked_value - s->value < s->problem->options.tolerance * s->value;
    s->looked_at = s->outcome->evaluations;
    s->looked_value = s->value;
    return s->stalled;
}

static Point next_point(Search *s) {
    while (s->stage == PROPOSES) {
        if (s->outcome->evaluations < s->problem->options.most_evaluations && !stalls(s)) propose_next(s);
        else s->stage = OVER;
    }
    if (s->stage == OVER) return (Point){NULL, NULL, NULL};
    s->outcome->evaluations++;
    if (s->stage != TRIES) return (Point){s->x, s->gradient, s->normal};
    if (s->proposal.without_slopes) return (Point){s->trial, NULL, NULL};
    return (Point){s->trial, s->trial_gradient, s->trial_normal};
}

static void take_value(Search *s, double found) {
    switch (s->stage) {
    case STARTS:
        s->value = found;
        s->outcome->converged = isfinite(found) ? NOT_STATIONARY : NOT_COMPUTABLE;
        s->stage = isfinite(found) ? PROPOSES : OVER;
        break;
    case TRIES:
        if (isnan(found)) s->stage = OVER;
        else if (isfinite(found) && found <= s->value) accept(s, found);
        else reject(s, found);
        break;
    default:
        if (isnan(found)) s->stage = OVER;
        else arrive(s, found);
    }
}

static size_t search_room(int n) { return 2 * (size_t)n * n + 6 * (size_t)n + 8; }

static void begin_search(Search *s, const LeastSquares *problem, const KnownMinimum *known, int normal_at_end, double *room, double *x,
                         double *normal, SearchOutcome *outcome) {
    const int n = problem->n_variables;
    *outcome = (SearchOutcome){NOT_COMPUTABLE, 0, INFINITY, 0, 0, 0};
    *s = (Search){.problem = problem, .known = known, .n = n, .x = x, .normal = normal, .outcome = outcome,
                  .damping = 1e-4, .growth = 4.0, .trust_radius = -1.0, .skip_last_slopes = !normal_at_end, .stage = STARTS};
    s->gradient = room;
    s->trial_gradient = s->gradient + n;
    s->step = s->trial_gradient + n;
    s->trial = s->step + n;
    s->scale = s->trial + n;
    s->trial_normal = s->scale + n;
    s->cholesky = s->trial_normal + (size_t)n * n; /* and the right-hand side */
    for (int i = 0; i < n; i++) x[i] = fmin(fmax(x[i], problem->bounds.lower[i]), problem->bounds.upper[i]);
    memset(s->scale, 0, n * sizeof(double));
}

static double search(const LeastSquares *problem, const KnownMinimum *known, int normal_at_end, double *x, double *normal,
                     SearchOutcome *outcome) {
    const int n = problem->n_variables;
    Search s;
    *outcome = (SearchOutcome){NOT_COMPUTABLE, 0, INFINITY, 0, 0, 0};
    double *room = n > MAX_VARIABLES ? NULL : malloc(search_room(n) * sizeof(double));
    if (!room) return NAN;
    begin_search(&s, problem, known, normal_at_end, room, x, normal, outcome);
    for (Point at = next_point(&s); at.x; at = next_point(&s))
        take_value(&s, problem->cost(problem->of, at.x, at.gradient, at.normal));
    free(room);
    return s.value;
}

double minimise(const LeastSquares *problem, double *x, double *normal, SearchOutcome *outcome) {
    return search(problem, NULL, 1, x, normal, outcome);
}
