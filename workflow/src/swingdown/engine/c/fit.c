/* Least squares: one Levenberg-Marquardt with an active set of bounds, for swings and for any other residual. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "swing.h"

/* Half the sum of squares at x; with gradient, also J'r and J'J (n by n). Infinite where x cannot be computed, not a
 * number where nothing more is to be computed: the search then ends as it stands. */
typedef double (*Cost)(void *of, const double *x, double *gradient, double *hessian);

/* A minimum found before: a search that comes to the same place need not follow it to the end again. */
typedef struct {
    const double *x, *hessian;
    double value;
} Known;
#define SAME 1e-6 /* of the sum of squares: how near is the same place */

typedef struct {
    int converged;   /* 1: stationary to the tolerance; 2: at the minimum known before; 0: neither, with all it may spend
                      * spent or no way on; -1: cannot be computed at the start */
    int evaluations;
    double predicted; /* relative fall that the last full step promised */
    int stops;        /* a swing sticks within its record, where that was looked at */
} Outcome;

/* Solve A d = -b for the free variables (the rest of d is given), by Cholesky; 0 where A is not positive definite. */
static int step(int n, const double *hessian, const double *gradient, double damping, const double *scale, const unsigned char *held,
                double *d, double *work) {
    int index[MAX_PARAMETERS * 4], k = 0;
    for (int i = 0; i < n; i++)
        if (!held[i]) index[k++] = i;
    for (int i = 0; i < k; i++) {
        double b = -gradient[index[i]];
        for (int j = 0; j < n; j++)
            if (held[j]) b -= hessian[index[i] * n + j] * d[j];
        work[k * k + i] = b;
        for (int j = 0; j <= i; j++) work[i * k + j] = hessian[index[i] * n + index[j]];
        work[i * k + i] += damping * scale[index[i]] + 1e-300;
    }
    for (int i = 0; i < k; i++)
        for (int j = 0; j <= i; j++) {
            double sum = work[i * k + j];
            for (int l = 0; l < j; l++) sum -= work[i * k + l] * work[j * k + l];
            if (i != j) work[i * k + j] = sum / work[j * k + j];
            else if (sum > 1e-15 * work[i * k + i]) work[i * k + i] = sqrt(sum);
            else return 0;
        }
    for (int i = 0; i < k; i++) {
        for (int l = 0; l < i; l++) work[k * k + i] -= work[i * k + l] * work[k * k + l];
        work[k * k + i] /= work[i * k + i];
    }
    for (int i = k - 1; i >= 0; i--) {
        for (int l = i + 1; l < k; l++) work[k * k + i] -= work[l * k + i] * work[k * k + l];
        d[index[i]] = (work[k * k + i] /= work[i * k + i]);
    }
    return 1;
}

static double promise(int n, const double *gradient, const double *hessian, const double *d) {
    double fall = 0.0;
    for (int i = 0; i < n; i++) {
        double row = 0.0;
        for (int j = 0; j < n; j++) row += hessian[i * n + j] * d[j];
        fall -= d[i] * (gradient[i] + 0.5 * row);
    }
    return fall;
}

/* Size of a step in units of what each variable does to the residuals. */
static double length(int n, const double *scale, const double *d) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) sum += scale[i] * d[i] * d[i];
    return sqrt(sum);
}

static int arrived(int n, const Known *known, const double *x, double value, double *d) {
    if (!(fabs(value - known->value) <= SAME * known->value)) return 0;
    for (int i = 0; i < n; i++) d[i] = x[i] - known->x[i];
    double distance = 0.0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) distance += 0.5 * d[i] * known->hessian[i * n + j] * d[j];
    return distance <= SAME * known->value;
}

/* The least sum of squares from x, in place. slopes_last: hessian is wanted at the very end; else a step that promises less
 * than the tolerance, which ends the search, is taken without slopes and leaves those of the point before. */
static double search(Cost cost, void *of, int n, double *x, const double *lower, const double *upper, int most, double tolerance,
                     const Known *known, int slopes_last, double *hessian, Outcome *outcome) {
    const size_t nn = (size_t)n * n;
    double *memory = malloc((3 * nn + 8 * (size_t)n + 8) * sizeof(double));
    *outcome = (Outcome){-1, 0, INFINITY, 0};
    if (!memory || n > MAX_PARAMETERS * 4) { free(memory); return NAN; }
    double *g = memory, *trial_g = g + n, *trial_h = trial_g + n, *work = trial_h + nn, *d = work + nn + n, *trial = d + n,
           *scale = trial + n; /* J'J's diagonal, falling no faster than by half: a variable whose column fades does not run off */
    unsigned char held[MAX_PARAMETERS * 4];
    double damping = 1e-4, grow = 4.0, reach = -1.0;
    for (int i = 0; i < n; i++) x[i] = fmin(fmax(x[i], lower[i]), upper[i]);
    double value = cost(of, x, g, hessian);
    outcome->evaluations = 1;
    if (isfinite(value)) outcome->converged = 0;
    memset(scale, 0, n * sizeof(double));
    while (outcome->converged == 0 && outcome->evaluations < most) {
        for (int i = 0; i < n; i++) scale[i] = fmax(0.5 * scale[i], hessian[i * n + i]);
        if (reach < 0.0) reach = 0.5 * length(n, scale, x); /* the first steps stay shorter than the way from zero to the start */
        int ok = 1;
        double size = INFINITY;
        for (int shorter = 0; shorter < 60; shorter++) {
            for (int i = 0; i < n; i++) {
                held[i] = (x[i] <= lower[i] && g[i] > 0.0) || (x[i] >= upper[i] && g[i] < 0.0);
                d[i] = 0.0;
            }
            for (int again = 1; again && ok;) { /* a variable that would cross its bound stops there, the rest is solved anew */
                ok = step(n, hessian, g, damping, scale, held, d, work);
                again = 0;
                for (int i = 0; i < n && ok; i++) {
                    if (held[i]) continue;
                    const double low = lower[i] - x[i], high = upper[i] - x[i];
                    if (d[i] < low || d[i] > high) {
                        d[i] = d[i] < low ? low : high;
                        held[i] = 1;
                        again = 1;
                    }
                }
            }
            size = length(n, scale, d);
            if (!ok || reach == 0.0 || size <= reach) break;
            damping = 4.0 * fmax(damping, 1e-4);
        }
        double expected = ok ? promise(n, g, hessian, d) : 0.0;
        if (ok) {
            int all_held = 1;
            for (int i = 0; i < n; i++) all_held &= d[i] == 0.0;
            if (all_held) { outcome->converged = 1; outcome->predicted = 0.0; break; }
        }
        double found = INFINITY;
        const double relative = expected / (value + 1e-300);
        const int bare = !slopes_last && relative < tolerance && damping < 1.0;
        if (ok && expected > 0.0) {
            for (int i = 0; i < n; i++) trial[i] = fmin(fmax(x[i] + d[i], lower[i]), upper[i]);
            found = bare ? cost(of, trial, NULL, NULL) : cost(of, trial, trial_g, trial_h);
            outcome->evaluations++;
            if (isnan(found)) break;
        }
        const double gain = (value - found) / expected;
        /* residuals down to their rounding, as of a model fitted to itself: the sum wanders, but nothing moves any more */
        const int still = ok && size <= tolerance * length(n, scale, x);
        if (isfinite(found) && found <= value) {
            const double fall = (value - found) / (value + 1e-300);
            memcpy(x, trial, n * sizeof(double));
            if (!bare) {
                memcpy(g, trial_g, n * sizeof(double));
                memcpy(hessian, trial_h, nn * sizeof(double));
            } else if (fall >= tolerance) { /* more than promised: not the end after all */
                found = cost(of, x, g, hessian);
                outcome->evaluations++;
                if (isnan(found)) break;
            }
            value = found;
            outcome->predicted = relative;
            if (relative < tolerance && fall < tolerance && damping < 1.0) outcome->converged = 1;
            if (value == 0.0 || (still && damping < 1.0)) outcome->converged = 1;
            if (gain > 0.75) reach = fmax(reach, 2.0 * size);
            const double cube = 2.0 * gain - 1.0;
            damping = fmax(1e-14, damping * fmax(0.05, 1.0 - cube * cube * cube));
            grow = 4.0;
            if (known && !outcome->converged && arrived(n, known, x, value, d)) outcome->converged = 2;
        } else {
            /* the promise is within the rounding of the sum itself: nothing more to gain */
            if (ok && ((expected > 0.0 && relative < tolerance) || still) && damping < 1.0) { outcome->converged = 1; outcome->predicted = relative; break; }
            /* where there is no trajectory at all the step was far too long, and finding that out is dear */
            damping = isfinite(found) || !ok ? damping * grow : fmax(damping, 1e-2) * 100.0;
            grow *= 2.0;
            if (damping > 1e18) { /* no shorter step gains: a minimum only if a full step would gain or move next to nothing */
                for (int i = 0; i < n; i++) d[i] = 0.0;
                ok = step(n, hessian, g, 1e-10, scale, held, d, work);
                outcome->predicted = ok ? promise(n, g, hessian, d) / (value + 1e-300) : INFINITY;
                outcome->converged = outcome->predicted < 1e-8 || (ok && length(n, scale, d) < 1e-8 * length(n, scale, x));
                break;
            }
        }
    }
    free(memory);
    return value;
}

/* The minimum of cost within lower..upper from x, in place; returns half the sum of squares. hessian: J'J there. */
double minimise(Cost cost, void *of, int n, double *x, const double *lower, const double *upper, int most, double tolerance,
                double *hessian, Outcome *outcome) {
    return search(cost, of, n, x, lower, upper, most, tolerance, NULL, 1, hessian, outcome);
}

/* One or more swings with a common model. values[k]: the model's parameters, release angle and release velocity of
 * swing k; where[k]: for each of them the index of the free variable it is, or -1 where it stays as given. */
typedef struct {
    const Model *model; /* one a swing: they differ in duration */
    int n_swings;
    const int *n;
    const double *const *times, *const *angles;
    double *values;
    const int *where;
    int n_free;
    double *series, *slopes; /* room for the longest swing */
    /* Panels as the measure of work. Far from any optimum a trajectory may take thousands of times what it takes
     * elsewhere (a support that rings at 1e5 rad/s): a point that takes much more than the best so far counts as one that
     * cannot be computed, and a fit that has spent what its evaluations would usually take ends. */
    double seconds, least, usual, floor, left; /* usual: before anything is computed by the model; later no less than half of that */
    int stops; /* of the last trajectories: one sticks */
} Swings;
#define DEAR 4.0   /* times the usual work */

static double dot(const double *a, const double *b, int n) {
    double lane[32] = {0.0}, sum = 0.0; /* a fixed order of summation: the same bits on every machine */
    int i = 0;
    for (; i + 32 <= n; i += 32)
        for (int k = 0; k < 32; k++) lane[k] += a[i + k] * b[i + k];
    for (; i < n; i++) sum += a[i] * b[i];
    for (int k = 0; k < 32; k++) sum += lane[k];
    return sum;
}

static double swings_cost(void *of, const double *x, double *gradient, double *hessian) {
    Swings *f = of;
    double value = 0.0, work = 0.0;
    const int n_free = f->n_free;
    if (f->left <= 0.0) return NAN;
    f->stops = 0;
    if (gradient) {
        memset(gradient, 0, n_free * sizeof(double));
        memset(hessian, 0, (size_t)n_free * n_free * sizeof(double));
    }
    for (int k = 0; k < f->n_swings; k++) {
        const int np = f->model[k].n_parameters, n = f->n[k];
        double *p = f->values + (size_t)k * (np + 2);
        const int *where = f->where + (size_t)k * (np + 2);
        int own[MAX_PARAMETERS], place[MAX_PARAMETERS], m = 0;
        for (int i = 0; i < np + 2; i++)
            if (where[i] >= 0) {
                p[i] = x[where[i]];
                place[m] = where[i];
                own[m++] = i < np ? i : (i == np ? RELEASE_ANGLE : RELEASE_VELOCITY);
            }
        Report report;
        const int failed = swing_trajectory(&f->model[k], p, p[np], p[np + 1], f->times[k], n, DEAR * f->usual / f->seconds, m, own,
                                            f->series, gradient ? f->slopes : NULL, &report);
        work += report.panels + report.rejected;
        f->left -= report.panels + report.rejected;
        if (failed) return INFINITY;
        f->stops |= report.stuck_after >= 0.0;
        const double *y = f->angles[k];
        for (int i = 0; i < n; i++) f->series[i] -= y[i];
        value += 0.5 * dot(f->series, f->series, n);
        if (!gradient) continue;
        for (int i = 0; i < m; i++) {
            const double *row = f->slopes + (size_t)i * n;
            gradient[place[i]] += dot(row, f->series, n);
            for (int j = 0; j <= i; j++) {
                const double product = dot(row, f->slopes + (size_t)j * n, n);
                hessian[(size_t)place[i] * n_free + place[j]] += product;
                if (i != j) hessian[(size_t)place[j] * n_free + place[i]] += product;
            }
        }
    }
    if (value < f->least) {
        f->least = value;
        f->usual = fmax(work, f->floor);
    }
    return value;
}

/* Fit swings from each of n_starts starts; the best is left in best (values), with its J'J where `wanted`, else with
 * one of a point close by. Returns its sum of squares. */
double fit_swings(const Model *models, int n_swings, const int *n, const double *const *times, const double *const *angles,
                  double *values, const int *where, int n_free, int n_starts, const double *starts, const double *lower,
                  const double *upper, int most, double tolerance, int wanted, double *best, double *hessian, double *all,
                  Outcome *outcome) {
    int longest = 0;
    for (int k = 0; k < n_swings; k++) longest = n[k] > longest ? n[k] : longest;
    Swings f = {models, n_swings, n, times, angles, values, where, n_free, NULL, NULL, 0.0, 0.0, 0.0, 0.0, 0.0, 0};
    int widest = 0;
    for (int k = 0; k < n_swings; k++) f.seconds += times[k][n[k] - 1] - times[k][0];
    for (int k = 0, np = models[0].n_parameters; k < n_swings; k++) {
        int m = 0;
        for (int i = 0; i < np + 2; i++) m += where[(size_t)k * (np + 2) + i] >= 0;
        widest = m > widest ? m : widest;
    }
    *outcome = (Outcome){-1, 0, INFINITY, 0};
    const size_t nn = (size_t)n_free * n_free;
    f.series = malloc((size_t)longest * (1 + widest) * sizeof(double));
    double *room = malloc((nn + n_free) * sizeof(double));
    double least = INFINITY;
    int evaluations = 0;
    for (int s = 0; s < n_starts && f.series && room && widest <= MAX_PARAMETERS; s++) {
        double *x = room + nn;
        Outcome one;
        f.slopes = f.series + longest;
        memcpy(x, starts + (size_t)s * n_free, n_free * sizeof(double));
        const double frequency = where[0] >= 0 ? x[where[0]] : values[0];
        f.least = INFINITY;
        f.usual = usual_panels(models) * (n_swings + fabs(frequency) * f.seconds / 3.141592653589793);
        f.floor = 0.5 * f.usual;
        f.left = most * f.usual;
        const Known known = {best, hessian, least};
        const double value = search(swings_cost, &f, n_free, x, lower, upper, most, tolerance,
                                    outcome->converged == 1 ? &known : NULL, 0, room, &one);
        evaluations += one.evaluations;
        all[s] = 2.0 * (one.converged == 2 ? least : value);
        if (isfinite(value) && one.converged != 2 && (value < least || (value == least && one.converged > outcome->converged))) {
            least = value;
            memcpy(best, x, n_free * sizeof(double));
            memcpy(hessian, room, nn * sizeof(double));
            *outcome = one;
        }
    }
    outcome->evaluations = evaluations;
    if (wanted && outcome->converged >= 0) {
        f.usual = f.left = INFINITY;
        swings_cost(&f, best, room + nn, hessian);
        outcome->stops = f.stops;
    }
    free(f.series);
    free(room);
    return 2.0 * least;
}

/* Many series over the same times: values[k] holds the start of series k (parameters and release), where what is free. */
int fit_batch(const Model *model, int n, const double *times, int n_series, const double *series, double *values, const int *where,
              int n_free, const double *lower, const double *upper, int most, double tolerance, double *best, double *squares,
              int *converged, int *evaluations) {
    const int np = model->n_parameters;
    double start[MAX_PARAMETERS + 2], every;
    double *hessian = malloc((size_t)n_free * n_free * sizeof(double));
    if (!hessian) return NO_MEMORY;
    for (int k = 0; k < n_series; k++) {
        double *own = values + (size_t)k * (np + 2);
        const double *y = series + (size_t)k * n;
        Outcome outcome;
        for (int i = 0; i < np + 2; i++)
            if (where[i] >= 0) start[where[i]] = own[i];
        squares[k] = fit_swings(model, 1, &n, &times, &y, own, where, n_free, 1, start, lower, upper, most, tolerance, 0,
                                best + (size_t)k * n_free, hessian, &every, &outcome);
        converged[k] = outcome.converged;
        evaluations[k] = outcome.evaluations;
    }
    free(hessian);
    return DONE;
}
