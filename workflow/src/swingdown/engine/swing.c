/* Trajectories of one pendulum, exact at reversals, with their sensitivities.
 *
 * A panel is the time from a reversal to just past the next one (or a part of it). The acceleration on it, and the
 * rate of every state an effect has, is a polynomial through N Gauss-Legendre nodes that satisfies the equations of
 * motion at each node; the signs of the velocity and of every abs() in the model are frozen, so the right-hand side is
 * smooth even past the reversal. The nodes are solved by Newton's iteration with the inverse Jacobian kept from panel
 * to panel: successive half-swings are nearly alike, so four or five cheap sweeps do. The same inverse gives the
 * sensitivities exactly. The reversal is the root of the velocity polynomial; the next panel starts there with the
 * other sign, or the pendulum sticks: then its panels have no acceleration until a torque frees it.
 */
#include "swing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "points.h"

#include "catalogue.h"

#define OVERSHOOT 1.012 /* a panel reaches this far past the reversal that is expected */
#define SOLVED 1e-12    /* residual of the collocation equations against their size, after the last sweep */
#define TAIL 3e-6       /* last two Legendre coefficients of a rate against its size */
#define SWEEPS 14
#define MOST_PANELS 100 /* a half-swing, beyond the first thousand: more is no pendulum's motion */
#define CHUNK 64
#define ROWS (2 + MAX_STATES)
#define BLOCKS (1 + MAX_STATES)

typedef struct {
    const Model *m;
    const double *p;
    double direction, reach; /* of the velocity, 1 or -1; the largest angle so far */
    double sign[MAX_SWITCHES];
    int sign_first[MAX_PARTS], n_switches, timed, inertial, rough, held, blocks;
} Pendulum;

/* Where the motion is: time, angle, velocity, states. */
typedef struct {
    double t, th, v, z[MAX_STATES];
} Place;

typedef struct {
    double h;
    Place from;
    double u[BLOCKS * N]; /* the unknowns: acceleration, then the states' rates, at the nodes */
    double th[N], v[N], t[N], z[MAX_STATES * N];
    double th_poly[N + 2], v_poly[N + 1], z_poly[MAX_STATES][N + 1];
    double by[BLOCKS * (3 + MAX_STATES) * N], by_parameter[BLOCKS * MAX_PARAMETERS * N];
    double inverse[BLOCKS * N * BLOCKS * N];
    int has_inverse;
} Panel;

/* Accelerations and states' rates at n points, row by row; `a` is what the states' equations take for theta''. */
static void rates(const Pendulum *s, int n, const double *th, const double *v, const double *a, const double *t, const double *z,
                  double *out, double *share) {
    double sn[N], cs[N], sum[ROWS * N];
    const int nz = s->m->n_states;
    for (int i = 0; i < n; i++) sine_cosine(th[i], &sn[i], &cs[i]);
    memset(sum, 0, (2 + nz) * N * sizeof(double));
    for (int k = 0; k < s->m->n_motions; k++) {
        const Part at = s->m->motions[k];
        const Points q = {n, N, th, v, a, t, sn, cs, z + at.first_state * N, s->p[0], s->m->duration, s->direction};
        EFFECTS[at.row].motion(&q, s->p + at.first_parameter, s->sign + s->sign_first[k], sum, at);
    }
    if (s->inertial)
        for (int i = 0; i < n; i++) {
            const double part = 1.0 / (1.0 + sum[N + i]);
            if (share) share[i] = part;
            sum[i] *= part;
        }
    if (s->held)
        for (int i = 0; i < n; i++) sum[i] = 0.0;
    memcpy(out, sum, N * sizeof(double));
    memcpy(out + N, sum + 2 * N, nz * N * sizeof(double));
}

/* The same at one place, for one direction of motion; the states' rates take the acceleration found first. */
static double rates_at(Pendulum *s, const Place *x, double direction, double *out) {
    double z[MAX_STATES * N], rows[BLOCKS * N], a = 0.0;
    const double kept = s->direction;
    s->direction = direction;
    for (int k = 0; k < s->m->n_states; k++) z[k * N] = x->z[k];
    for (int again = 0; again < (s->m->n_states && out ? 2 : 1); again++) {
        rates(s, 1, &x->th, &x->v, &a, &x->t, z, rows, NULL);
        a = rows[0];
    }
    for (int k = 0; out && k < s->blocks; k++) out[k] = rows[k * N];
    s->direction = kept;
    return a;
}

/* Derivatives of every rate at the nodes by angle, velocity, acceleration, states and parameters. */
static void slopes_at_nodes(const Pendulum *s, Panel *b) {
    double sn[N], cs[N], by[ROWS * (3 + MAX_STATES) * N], share[N], f[BLOCKS * N];
    const int nz = s->m->n_states, inputs = 3 + nz, np = s->m->n_parameters, rows = 2 + nz;
    for (int i = 0; i < N; i++) sine_cosine(b->th[i], &sn[i], &cs[i]);
    memset(by, 0, rows * inputs * N * sizeof(double));
    const int plain = !s->inertial && !nz; /* then the parameters' rows are where the effects write them */
    double room[plain ? 1 : ROWS * MAX_PARAMETERS * N];
    double *parameters = plain ? b->by_parameter : room;
    memset(parameters, 0, (plain ? 1 : rows) * np * N * sizeof(double));
    const Slopes d = {by, parameters, inputs, np, N};
    for (int k = 0; k < s->m->n_motions; k++) {
        const Part at = s->m->motions[k];
        const Points q = {N, N, b->th, b->v, b->u, b->t, sn, cs, b->z + at.first_state * N, s->p[0], s->m->duration, s->direction};
        EFFECTS[at.row].motion_slopes(&q, s->p + at.first_parameter, s->sign + s->sign_first[k], &d, at);
    }
    if (s->inertial) { /* the acceleration is torque / (1 + inertia) */
        rates(s, N, b->th, b->v, b->u, b->t, b->z, f, share);
        for (int k = 0; k < inputs; k++)
            for (int i = 0; i < N; i++)
                by[k * N + i] = (by[k * N + i] - f[i] * by[(inputs + k) * N + i]) * share[i];
        for (int k = 0; k < np; k++)
            for (int i = 0; i < N; i++)
                parameters[k * N + i] = (parameters[k * N + i] - f[i] * parameters[(np + k) * N + i]) * share[i];
    }
    if (s->held) {
        memset(by, 0, inputs * N * sizeof(double));
        memset(parameters, 0, np * N * sizeof(double));
    }
    memcpy(b->by, by, inputs * N * sizeof(double));
    memcpy(b->by + inputs * N, by + 2 * inputs * N, nz * inputs * N * sizeof(double));
    if (!plain) {
        memcpy(b->by_parameter, parameters, np * N * sizeof(double));
        memcpy(b->by_parameter + np * N, parameters + 2 * np * N, nz * np * N * sizeof(double));
    }
}

static void switch_values(const Pendulum *s, int n, const double *th, const double *v, const double *t, const double *z, double *out) {
    double sn[N], cs[N];
    for (int i = 0; i < n; i++) sine_cosine(th[i], &sn[i], &cs[i]);
    for (int k = 0; k < s->m->n_motions; k++) {
        const Part at = s->m->motions[k];
        const Points q = {n, N, th, v, v, t, sn, cs, z + at.first_state * N, s->p[0], s->m->duration, s->direction};
        if (EFFECTS[at.row].n_switches)
            EFFECTS[at.row].switches(&q, s->p + at.first_parameter, s->sign + s->sign_first[k], out + s->sign_first[k] * N, at);
    }
}

static void switches_at(const Pendulum *s, const Place *x, double *out) {
    double z[MAX_STATES * N], rows[MAX_SWITCHES * N];
    for (int k = 0; k < s->m->n_states; k++) z[k * N] = x->z[k];
    switch_values(s, 1, &x->th, &x->v, &x->t, z, rows);
    for (int k = 0; k < s->n_switches; k++) out[k] = rows[k * N];
}

/* Eight doubles at once (GCC's and Clang's vectors, on any processor; each lane rounds as a double alone would). */
typedef double Lanes __attribute__((vector_size(64), aligned(8), may_alias));
#define LANES(array, k) (((Lanes *)(array))[k])
#define READ_LANES(array, k) (((const Lanes *)(array))[k])
#define LANES_OF(size) ((size) / 8)

/* out[i] = sum over j of weight[j] * table[j * N + i] */
static inline void combine(const double *table, const double *weight, double *out) {
    Lanes low = {0.0}, high = {0.0};
    for (int j = 0; j < N; j++) {
        low += READ_LANES(table + j * N, 0) * weight[j];
        high += READ_LANES(table + j * N, 1) * weight[j];
    }
    LANES(out, 0) = low;
    LANES(out, 1) = high;
}
/* the same for a table of several blocks of N rows and columns */
static void combine_blocks(int blocks, const double *table, const double *weight, double *out) {
    const int size = blocks * N;
    for (int k = 0; k < LANES_OF(size); k++) {
        Lanes sum = {0.0};
        for (int j = 0; j < size; j++) sum += READ_LANES(table + j * size, k) * weight[j];
        LANES(out, k) = sum;
    }
}
static void apply_inverse(const Panel *b, int blocks, const double *in, double *out) {
    if (blocks == 1) combine(b->inverse, in, out);
    else combine_blocks(blocks, b->inverse, in, out);
}

static void states_at_nodes(Panel *b, int n_states) {
    double once[N], twice[N];
    combine(T_first, b->u, once);
    combine(T_second, b->u, twice);
    for (int i = 0; i < N; i++) {
        b->v[i] = b->from.v + b->h * once[i];
        b->th[i] = b->from.th + b->h * (b->from.v * T_nodes[i] + b->h * twice[i]);
    }
    for (int k = 0; k < n_states; k++) {
        combine(T_first, b->u + (1 + k) * N, once);
        for (int i = 0; i < N; i++) b->z[k * N + i] = b->from.z[k] + b->h * once[i];
    }
}

/* Invert the size x size matrix in place by Gauss-Jordan with row pivoting; 0 where it is singular. */
static inline int gauss_jordan(int size, double *g) {
    int swapped[BLOCKS * N];
    for (int c = 0; c < size; c++) {
        int pivot = c;
        for (int r = c + 1; r < size; r++)
            if (fabs(g[r * size + c]) > fabs(g[pivot * size + c])) pivot = r;
        swapped[c] = pivot;
        if (!(fabs(g[pivot * size + c]) > 1e-300)) return 0;
        double *row = g + c * size;
        if (pivot != c)
            for (int i = 0; i < size; i++) {
                const double kept = row[i];
                row[i] = g[pivot * size + i];
                g[pivot * size + i] = kept;
            }
        const double unit = 1.0 / row[c];
        Lanes pivot_row[LANES_OF(BLOCKS * N)];
        for (int k = 0; k < LANES_OF(size); k++) pivot_row[k] = READ_LANES(row, k) * unit;
        ((double *)pivot_row)[c] = 1.0 + unit; /* so that each other row's own entry, factor, becomes -factor * unit */
        for (int r = 0; r < size; r++) {
            double *other = g + r * size;
            const double factor = r == c ? 0.0 : other[c];
            for (int k = 0; k < LANES_OF(size); k++) LANES(other, k) -= pivot_row[k] * factor;
        }
        for (int k = 0; k < LANES_OF(size); k++) LANES(row, k) = pivot_row[k];
        row[c] = unit;
    }
    for (int c = size - 1; c >= 0; c--)
        if (swapped[c] != c)
            for (int r = 0; r < size; r++) {
                const double kept = g[r * size + c];
                g[r * size + c] = g[r * size + swapped[c]];
                g[r * size + swapped[c]] = kept;
            }
    return 1;
}

/* The inverse of 1 - d(rates)/d(unknowns), stored by column. */
static int invert(Panel *b, int n_states) {
    const int blocks = 1 + n_states, size = blocks * N, inputs = 3 + n_states;
    for (int block = 0; block < blocks; block++)
        for (int j = 0; j < N; j++) {
            double *column = b->inverse + (block * N + j) * size;
            for (int o = 0; o < blocks; o++) {
                const double *by = b->by + o * inputs * N;
                for (int i = 0; i < N; i++) {
                    const double through = block
                        ? b->h * by[(2 + block) * N + i] * T_first[j * N + i]
                        : b->h * (b->h * by[i] * T_second[j * N + i] + by[N + i] * T_first[j * N + i]);
                    column[o * N + i] = -through;
                }
                if (block == 0) column[o * N + j] -= by[2 * N + j];
            }
            column[block * N + j] += 1.0;
        }
    b->has_inverse = n_states ? gauss_jordan(size, b->inverse) : gauss_jordan(N, b->inverse);
    return b->has_inverse;
}

static double largest(const double *x) {
    double most = 0.0;
    for (int i = 0; i < N; i++) most = fmax(most, fabs(x[i]));
    return most;
}

/* The size against which a block's errors count: of the acceleration, or of a thousandth of what it was at the largest
 * angle, for a swing that has died down is all rounding; of a state's rate, or of what would change the state by its own
 * size over the panel, for a state that has settled has no rate to speak of. */
static double size_of(const Pendulum *s, const Panel *b, int block, const double *rates) {
    const double least = block ? largest(b->z + (block - 1) * N) / b->h : 1e-3 * s->p[0] * s->p[0] * s->reach;
    return fmax(largest(rates + block * N), least) + 1e-12;
}

/* Solve the panel from the guess in b->u; 0 where the iteration does not converge. */
static int solve(const Pendulum *s, Panel *b, Report *report) {
    double f[BLOCKS * N], residual[BLOCKS * N], step[BLOCKS * N], last = 0.0;
    const int blocks = s->blocks;
    int fresh = 0;
    for (int i = 0; i < N; i++) b->t[i] = b->from.t + b->h * T_nodes[i];
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double error = 0.0;
        states_at_nodes(b, blocks - 1);
        rates(s, N, b->th, b->v, b->u, b->t, b->z, f, NULL);
        report->evaluations++;
        for (int k = 0; k < blocks; k++) {
            for (int i = k * N; i < (k + 1) * N; i++) residual[i] = f[i] - b->u[i];
            const double off = largest(residual + k * N);
            if (!isfinite(off)) return 0;
            error = fmax(error, off / size_of(s, b, k, f));
        }
        /* the step about to be taken leaves an error smaller by the factor that the last one gained */
        const int solved = error * fmin(1.0, error / last) <= SOLVED;
        if (!b->has_inverse || (!solved && sweep && error > 0.2 * last && !fresh)) {
            slopes_at_nodes(s, b);
            if (!invert(b, blocks - 1)) return 0;
            fresh = 2;
        }
        apply_inverse(b, blocks, residual, step);
        for (int i = 0; i < blocks * N; i++) b->u[i] += step[i];
        if (solved) {
            states_at_nodes(b, blocks - 1);
            return 1;
        }
        last = error;
        if (fresh) fresh--;
    }
    return 0;
}

/* Coefficients, in powers of the position -1..1, of the integral that starts at `start`, of a rate given by them. */
static void integrate(const double *rate, int degree, double h, double start, double *out) {
    double at_start = 0.0;
    for (int k = 0; k <= degree; k++) out[k + 1] = 0.5 * h * rate[k] * T_reciprocal[k];
    for (int k = 0; k <= degree; k++) at_start += k % 2 ? out[k + 1] : -out[k + 1];
    out[0] = start - at_start;
}

static void polynomials(const double *u, int n_states, double h, double th, double v, const double *z, double *th_poly,
                        double *v_poly, double (*z_poly)[N + 1]) {
    double c[N];
    combine(T_monomial, u, c);
    integrate(c, N - 1, h, v, v_poly);
    integrate(v_poly, N, h, th, th_poly);
    for (int k = 0; k < n_states; k++) {
        combine(T_monomial, u + (1 + k) * N, c);
        integrate(c, N - 1, h, z[k], z_poly[k]);
    }
}

static inline double horner(const double *c, int degree, double x) {
    double value = c[degree];
    for (int k = degree - 1; k >= 0; k--) value = value * x + c[k];
    return value;
}

static Place place_at(const Panel *b, int n_states, double x) {
    Place at = {b->from.t + 0.5 * b->h * (x + 1.0), horner(b->th_poly, N + 1, x), horner(b->v_poly, N, x), {0.0}};
    for (int k = 0; k < n_states; k++) at.z[k] = horner(b->z_poly[k], N, x);
    return at;
}

/* How far the last Legendre coefficients of the rates stand out of their sizes. */
static double tail(const Pendulum *s, const Panel *b) {
    double most = 0.0;
    for (int block = 0; block < s->blocks; block++) {
        double c[2] = {0.0, 0.0};
        for (int k = 0; k < 2; k++)
            for (int j = 0; j < N; j++) c[k] += T_tail[k * N + j] * b->u[block * N + j];
        /* the angle is the acceleration's integral twice over, a state its rate's once: that leaves more of the error */
        most = fmax(most, (block ? 30.0 : 1.0) * (fabs(c[0]) + fabs(c[1])) / size_of(s, b, block, b->u));
    }
    return s->rough ? 100.0 * most : most;
}

/* Root of the velocity in [low, high] (positions in -1..1), where direction * v is >= 0 at low and < 0 at high. */
static double velocity_root(const Panel *b, double direction, double low, double high) {
    double x = 0.5 * (low + high);
    for (int k = 0; k < 80; k++) {
        double value = b->v_poly[N], slope = 0.0;
        for (int j = N - 1; j >= 0; j--) {
            slope = slope * x + value;
            value = value * x + b->v_poly[j];
        }
        if (direction * value >= 0.0) low = x; else high = x;
        double next = x - value / slope;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (fabs(next - x) < 4e-16 || next == low || next == high) return next;
        x = next;
    }
    return x;
}

static double switch_at(const Pendulum *s, const Panel *b, int k, double x) {
    double g[MAX_SWITCHES];
    const Place at = place_at(b, s->m->n_states, x);
    switches_at(s, &at, g);
    return g[k];
}

/* The first event on the solved panel: its position in (-1, 1], or 2 for none; what: REVERSAL or the switch. */
enum { REVERSAL = -1, NOTHING = -2 };
static double first_event(const Pendulum *s, const Panel *b, int *what) {
    double at = 2.0, low = -1.0, g[MAX_SWITCHES * N];
    *what = NOTHING;
    for (int i = 0; i <= N && !s->held; i++) {
        const double x = i < N ? 2.0 * T_nodes[i] - 1.0 : 1.0;
        const double v = i < N ? b->v[i] : horner(b->v_poly, N, 1.0);
        if (s->direction * v < 0.0) {
            at = velocity_root(b, s->direction, low, x);
            *what = REVERSAL;
            break;
        }
        low = x;
    }
    if (!s->n_switches) return at;
    switch_values(s, N, b->th, b->v, b->t, b->z, g);
    for (int k = 0; k < s->n_switches; k++) {
        low = -1.0;
        for (int i = 0; i <= N; i++) {
            double x = i < N ? 2.0 * T_nodes[i] - 1.0 : 1.0;
            const int past = x > at;
            if (past) x = at;
            const double value = (i < N && !past) ? g[k * N + i] : switch_at(s, b, k, x);
            if (s->sign[k] * value < 0.0) {
                double high = x;
                for (int step = 0; step < 60 && high - low > 1e-15; step++) {
                    const double middle = 0.5 * (low + high);
                    if (s->sign[k] * switch_at(s, b, k, middle) >= 0.0) low = middle; else high = middle;
                }
                if (high < at) { at = high; *what = k; }
                break;
            }
            if (past) break;
            low = x;
        }
    }
    return at;
}

/* Time to the next reversal if the motion from here were harmonic with angular frequency omega. */
static double time_to_reversal(double direction, double v, double a, double omega) {
    const double phase = atan2(-direction * a / omega, direction * v);
    return (1.5707963267948966 - phase) / omega;
}

static double frequency_guess(double omega_n, double th, double v) {
    const double w = fmax(fabs(omega_n), 1e-3);
    double ratio = 0.5 * (1.0 + cos(th) - v * v / (2.0 * w * w)); /* cos^2 of half the amplitude */
    double a = 1.0, g = sqrt(fmax(ratio, 1e-4));
    for (int k = 0; k < 5; k++) { const double m = 0.5 * (a + g); g = sqrt(a * g); a = m; }
    return w * a;
}

/* Which way the pendulum leaves rest: 1, -1, or 0 where friction holds it. */
static int leaves_rest(Pendulum *s, const Place *x, double from) {
    const int held = s->held;
    s->held = 0;
    const double up = rates_at(s, x, 1.0, NULL), down = rates_at(s, x, -1.0, NULL);
    s->held = held;
    const int first = from != 0.0 ? (from > 0.0 ? -1 : 1) : (up + down >= 0.0 ? 1 : -1);
    if (first > 0) return up > 0.0 ? 1 : (down < 0.0 ? -1 : 0);
    return down < 0.0 ? -1 : (up > 0.0 ? 1 : 0);
}

/* While held: the first position on the panel where a torque frees the pendulum, or 2. */
static double breakaway(Pendulum *s, const Panel *b) {
    double low = -1.0;
    for (int i = 0; i <= N; i++) {
        const double x = i < N ? 2.0 * T_nodes[i] - 1.0 : 1.0;
        Place at = place_at(b, s->m->n_states, x);
        at.v = 0.0;
        if (leaves_rest(s, &at, 0.0)) {
            double high = x;
            for (int k = 0; k < 60 && high - low > 1e-15; k++) {
                const double middle = 0.5 * (low + high);
                at = place_at(b, s->m->n_states, middle);
                at.v = 0.0;
                if (leaves_rest(s, &at, 0.0)) high = middle; else low = middle;
            }
            return high;
        }
        low = x;
    }
    return 2.0;
}

/* The clock's true times of the samples and, by row, their derivatives by the free values. */
static int true_times(const Model *m, const double *p, const double *times, int n, int n_free, const int *free_values,
                      double *out, double *slopes) {
    for (int i = 0; i < n; i++) out[i] = times[i] - times[0];
    if (slopes) memset(slopes, 0, (size_t)n_free * n * sizeof(double));
    for (int c = 0; c < m->n_clocks; c++) {
        const Part at = m->clocks[c];
        const Effect *e = &EFFECTS[at.row];
        for (int start = 0; start < n; start += CHUNK) {
            const int size = n - start < CHUNK ? n - start : CHUNK;
            double stamped[CHUNK], zero[CHUNK] = {0.0}, by[CHUNK] = {0.0}, by_p[MAX_PARAMETERS * CHUNK];
            memcpy(stamped, out + start, size * sizeof(double));
            const Points q = {size, CHUNK, zero, zero, zero, stamped, zero, zero, zero, p[0], m->duration, 1.0};
            memset(out + start, 0, size * sizeof(double));
            e->reading(&q, p + at.first_parameter, NULL, out + start, at);
            if (!slopes) continue;
            memset(by_p, 0, m->n_parameters * CHUNK * sizeof(double));
            const Slopes d = {by, by_p, 1, m->n_parameters, CHUNK};
            e->reading_slopes(&q, p + at.first_parameter, NULL, &d, at);
            for (int f = 0; f < n_free; f++)
                for (int i = 0; i < size; i++) {
                    double *slope = slopes + (size_t)f * n + start + i;
                    *slope = *slope * by[i] + (free_values[f] >= 0 ? by_p[free_values[f] * CHUNK + i] : 0.0);
                }
        }
    }
    for (int i = 1; i < n; i++)
        if (!(out[i] > out[i - 1])) return 0;
    return 1;
}

/* What the sensors make of the angles, one after the other, with the slopes by the chain rule. z: the states' rows. */
static void read_out(const Model *m, const double *p, const double *times, int n, int n_free, const int *free_values,
                     const double *z, const double *z_slopes, double *y, double *slopes) {
    for (int k = 0; k < m->n_sensors; k++) {
        const Part at = m->sensors[k];
        const Effect *e = &EFFECTS[at.row];
        const int nz = m->n_states, inputs = 3 + nz;
        for (int start = 0; start < n; start += CHUNK) {
            const int size = n - start < CHUNK ? n - start : CHUNK;
            double th[CHUNK], sn[CHUNK], cs[CHUNK], t[CHUNK], zero[CHUNK] = {0.0}, states[(MAX_STATES + 1) * CHUNK];
            double by[(3 + MAX_STATES) * CHUNK], by_p[MAX_PARAMETERS * CHUNK];
            memcpy(th, y + start, size * sizeof(double));
            for (int i = 0; i < size; i++) {
                sine_cosine(th[i], &sn[i], &cs[i]);
                t[i] = times[start + i] - times[0];
            }
            for (int j = 0; z && j < nz; j++) memcpy(states + j * CHUNK, z + (size_t)j * n + start, size * sizeof(double));
            const Points q = {size, CHUNK, th, zero, zero, t, sn, cs, states + at.first_state * CHUNK, p[0], m->duration, 1.0};
            memset(y + start, 0, size * sizeof(double));
            e->reading(&q, p + at.first_parameter, NULL, y + start, at);
            if (!slopes) continue;
            memset(by, 0, inputs * CHUNK * sizeof(double));
            memset(by_p, 0, m->n_parameters * CHUNK * sizeof(double));
            const Slopes d = {by, by_p, inputs, m->n_parameters, CHUNK};
            e->reading_slopes(&q, p + at.first_parameter, NULL, &d, at);
            for (int f = 0; f < n_free; f++) {
                double *row = slopes + (size_t)f * n + start;
                for (int i = 0; i < size; i++) row[i] *= by[i];
                for (int j = 0; z && j < nz; j++)
                    for (int i = 0; i < size; i++)
                        row[i] += by[(3 + j) * CHUNK + i] * z_slopes[((size_t)j * n_free + f) * n + start + i];
                if (free_values[f] >= 0)
                    for (int i = 0; i < size; i++) row[i] += by_p[free_values[f] * CHUNK + i];
            }
        }
    }
}

/* Play between the pendulum and its sensor: the reading follows only when pushed, a half width behind. */
typedef struct {
    int parameter; /* index of the width, or -1 */
    double reading, slope[MAX_PARAMETERS];
} Play;

static void push(Play *play, double half, double th, int n_free, const int *free_values, const double *slopes, size_t stride) {
    const double side = play->reading > th + half ? 1.0 : (play->reading < th - half ? -1.0 : 0.0);
    if (side == 0.0) return;
    play->reading = th + side * half;
    for (int f = 0; f < n_free; f++) play->slope[f] = slopes[f * stride] + side * 0.5 * (free_values[f] == play->parameter);
}

/* The polynomial at n positions; room for whole lanes must follow the positions. */
static void sample(const double *poly, int degree, const double *x, int n, double *out) {
    for (int start = 0; start < n; start += 8) {
        const Lanes at = READ_LANES(x + start, 0);
        Lanes value = poly[degree] - (Lanes){0.0};
        for (int k = degree - 1; k >= 0; k--) value = value * at + poly[k];
        if (n - start >= 8) LANES(out + start, 0) = value;
        else memcpy(out + start, &value, (n - start) * sizeof(double));
    }
}

/* Sensitivities: of angle, velocity and states by each free value, now and along the panel. */
typedef struct {
    int n;
    const int *by;
    double th[MAX_PARAMETERS], v[MAX_PARAMETERS], z[MAX_PARAMETERS][MAX_STATES];
    double th_poly[MAX_PARAMETERS][N + 2], v_poly[MAX_PARAMETERS][N + 1], z_poly[MAX_PARAMETERS][MAX_STATES][N + 1];
} Sensitivities;

/* Along the solved panel: the linear problem with the panel's own inverse. */
static void propagate(const Panel *b, int n_states, int n_parameters, Sensitivities *d) {
    const int blocks = 1 + n_states, inputs = 3 + n_states;
    for (int f = 0; f < d->n; f++) {
        double rhs[BLOCKS * N], du[BLOCKS * N];
        for (int o = 0; o < blocks; o++) {
            const double *by = b->by + o * inputs * N;
            double *out = rhs + o * N;
            for (int i = 0; i < N; i++) out[i] = by[i] * (d->th[f] + d->v[f] * b->h * T_nodes[i]) + by[N + i] * d->v[f];
            for (int k = 0; k < n_states; k++)
                for (int i = 0; i < N; i++) out[i] += by[(3 + k) * N + i] * d->z[f][k];
            if (d->by[f] >= 0)
                for (int i = 0; i < N; i++) out[i] += b->by_parameter[(o * n_parameters + d->by[f]) * N + i];
        }
        apply_inverse(b, blocks, rhs, du);
        polynomials(du, n_states, b->h, d->th[f], d->v[f], d->z[f], d->th_poly[f], d->v_poly[f], d->z_poly[f]);
    }
}

static void move_to(Sensitivities *d, int n_states, double x) {
    for (int f = 0; f < d->n; f++) {
        d->th[f] = horner(d->th_poly[f], N + 1, x);
        d->v[f] = horner(d->v_poly[f], N, x);
        for (int k = 0; k < n_states; k++) d->z[f][k] = horner(d->z_poly[f][k], N, x);
    }
}

/* The rates jump at an event that comes `later[f]` for a change of free value f: saltation. */
static void jump(Sensitivities *d, int blocks, const double *before, const double *after, const double *later) {
    for (int f = 0; f < d->n; f++) {
        d->v[f] += (before[0] - after[0]) * later[f];
        for (int k = 1; k < blocks; k++) d->z[f][k - 1] += (before[k] - after[k]) * later[f];
    }
}

/* Cross a switch other than the reversal; where the rates jump there, so do the sensitivities. */
static void cross_switch(Pendulum *s, const Place *x, int k, Sensitivities *d) {
    double before[BLOCKS], after[BLOCKS], high[MAX_SWITCHES], low[MAX_SWITCHES], later[MAX_PARAMETERS], moved[MAX_PARAMETERS];
    rates_at(s, x, s->direction, before);
    s->sign[k] = -s->sign[k];
    rates_at(s, x, s->direction, after);
    double difference = 0.0, size = 0.0;
    for (int j = 0; j < s->blocks; j++) {
        difference = fmax(difference, fabs(after[j] - before[j]) / (fabs(before[j]) + fabs(after[j]) + 1e-12));
        size = fmax(size, fabs(before[j]));
    }
    if (!d->n || difference < 1e-9) return;
    /* differences of the switch's own formula, which is smooth: by angle, velocity, time, states and parameters */
    const double e = 1e-6;
    double g_z[MAX_STATES], g_th, g_v, g_t;
#define DIFFERENCE(FIELD, INTO) { Place up = *x, down = *x; up.FIELD += e; down.FIELD -= e; switches_at(s, &up, high); \
        switches_at(s, &down, low); INTO = (high[k] - low[k]) / (2.0 * e); }
    DIFFERENCE(th, g_th)
    DIFFERENCE(v, g_v)
    DIFFERENCE(t, g_t)
    double rate = g_th * x->v + g_v * before[0] + g_t;
    for (int j = 0; j < s->m->n_states; j++) {
        DIFFERENCE(z[j], g_z[j])
        rate += g_z[j] * before[1 + j];
    }
#undef DIFFERENCE
    const double *given = s->p;
    for (int f = 0; f < d->n; f++) {
        double change = g_th * d->th[f] + g_v * d->v[f];
        for (int j = 0; j < s->m->n_states; j++) change += g_z[j] * d->z[f][j];
        if (d->by[f] >= 0) {
            memcpy(moved, given, s->m->n_parameters * sizeof(double));
            s->p = moved;
            moved[d->by[f]] = given[d->by[f]] + e;
            switches_at(s, x, high);
            moved[d->by[f]] = given[d->by[f]] - e;
            switches_at(s, x, low);
            s->p = given;
            change += (high[k] - low[k]) / (2.0 * e);
        }
        later[f] = -change / rate;
    }
    jump(d, s->blocks, before, after, later);
}

/* The states at the release, and their sensitivities. */
static void release(const Pendulum *s, Place *x, Sensitivities *d) {
    double sn, cs;
    sine_cosine(x->th, &sn, &cs);
    for (int k = 0; k < s->m->n_motions; k++) {
        const Part at = s->m->motions[k];
        const Effect *e = &EFFECTS[at.row];
        if (!e->n_states) continue;
        const double zero = 0.0;
        double by[MAX_STATES * 2] = {0.0}, by_p[MAX_STATES * MAX_PARAMETERS] = {0.0};
        const Points q = {1, 1, &x->th, &x->v, &zero, &x->t, &sn, &cs, &zero, s->p[0], s->m->duration, 1.0};
        const Slopes slopes = {by, by_p, 2, s->m->n_parameters, 1};
        e->initial(&q, s->p + at.first_parameter, NULL, x->z + at.first_state, at);
        e->initial_slopes(&q, s->p + at.first_parameter, NULL, &slopes, at);
        for (int f = 0; f < d->n; f++)
            for (int j = 0; j < e->n_states; j++)
                d->z[f][at.first_state + j] = by[2 * j] * d->th[f] + by[2 * j + 1] * d->v[f]
                                              + (d->by[f] >= 0 ? by_p[j * s->m->n_parameters + d->by[f]] : 0.0);
    }
}

static int prepare(Pendulum *s, const Model *m, const double *p, int n_free) {
    *s = (Pendulum){.m = m, .p = p, .blocks = 1 + m->n_states};
    if (m->n_parameters > MAX_PARAMETERS || n_free > MAX_PARAMETERS || m->n_states > MAX_STATES || m->n_motions > MAX_PARTS) return 0;
    for (int k = 0; k < m->n_motions; k++) {
        const Effect *e = &EFFECTS[m->motions[k].row];
        s->sign_first[k] = s->n_switches;
        s->n_switches += e->n_switches;
        s->timed |= e->timed;
        s->inertial |= e->inertial;
        s->rough |= e->rough;
        if (s->n_switches > MAX_SWITCHES) return 0;
    }
    return 1;
}

int swing_trajectory(const Model *m, const double *p, double release_angle, double release_velocity,
                     const double *times, int n, double pace, int n_free, const int *free_values,
                     double *angles, double *slopes, Report *report) {
    Pendulum s;
    Panel b;
    Sensitivities d;
    const int nz = m->n_states;
    if (!slopes) n_free = 0;
    *report = (Report){.stuck_after = -1.0};
    if (!prepare(&s, m, p, n_free)) return report->status = TOO_LARGE;
    d.n = n_free;
    d.by = free_values;
    b.has_inverse = 0;

    int reads_states = 0;
    for (int k = 0; k < m->n_sensors; k++) reads_states |= EFFECTS[m->sensors[k].row].n_states > 0;
    const int with_clock = m->n_clocks && n_free, kept_states = reads_states ? nz : 0;
    /* for every sample: true time, position on its panel, velocity, the clock's slopes, the states and theirs */
    double *work = malloc((8 + (size_t)n * (3 + (with_clock ? n_free : 0) + kept_states * (1 + n_free))) * sizeof(double));
    if (!work) return report->status = NO_MEMORY;
    double *at = work, *x = at + n, *speed = x + n, *clock_slopes = with_clock ? speed + n : NULL;
    double *z = kept_states ? speed + (size_t)n * (1 + (with_clock ? n_free : 0)) : NULL, *z_slopes = z ? z + (size_t)kept_states * n : NULL;
    int status = true_times(m, p, times, n, n_free, free_values, at, clock_slopes) ? DONE : CLOCK_RUNS_BACK;

    Place here = {at[0], release_angle, release_velocity, {0.0}};
    for (int f = 0; f < n_free; f++) {
        d.th[f] = free_values[f] == RELEASE_ANGLE;
        d.v[f] = free_values[f] == RELEASE_VELOCITY;
        for (int k = 0; k < nz; k++) d.z[f][k] = 0.0;
    }
    if (nz) release(&s, &here, &d);
    s.direction = here.v > 0.0 ? 1.0 : (here.v < 0.0 ? -1.0 : 0.0);
    if (s.n_switches) { /* the side each switch starts on; exactly on it, the side it moves to */
        double g[MAX_SWITCHES], ahead[MAX_SWITCHES];
        Place next = here;
        next.th += 1e-9 * (here.v != 0.0 ? here.v : -here.th);
        switches_at(&s, &here, g);
        switches_at(&s, &next, ahead);
        for (int k = 0; k < s.n_switches; k++) s.sign[k] = (g[k] != 0.0 ? g[k] : ahead[k]) < 0.0 ? -1.0 : 1.0;
    }
    Play play = {m->play, here.th, {0.0}};
    for (int f = 0; f < n_free; f++) play.slope[f] = d.th[f];

    double omega = frequency_guess(p[0], here.th, here.v), since = -1.0, longest = INFINITY;
    const double panels_in_advance = isfinite(pace) ? 50.0 : 1000.0, panels_a_second = fmin(pace, MOST_PANELS * omega / 3.141592653589793);
    double last_h = 0.0, last_start = 0.0; /* of the last panel, if it began at rest */
    int next = 0, at_rest = 0;
    s.reach = hypot(here.th, here.v / omega);
    while (next < n && status == DONE) {
        at_rest = here.v == 0.0;
        s.reach = fmax(s.reach, fabs(here.th));
        if (at_rest) {
            double before[BLOCKS], after[BLOCKS], later[MAX_PARAMETERS];
            const int was_held = s.held, way = leaves_rest(&s, &here, s.held ? 0.0 : s.direction);
            if (n_free && s.direction != 0.0) rates_at(&s, &here, s.direction, before);
            s.held = way == 0;
            if (n_free && s.direction != 0.0) { /* the rates jump at the reversal, which comes later by -dv/a */
                rates_at(&s, &here, way ? way : s.direction, after);
                for (int f = 0; f < n_free; f++) later[f] = before[0] != 0.0 ? -d.v[f] / before[0] : 0.0;
                if (!was_held) jump(&d, s.blocks, before, after, later);
                if (s.held)
                    for (int f = 0; f < n_free; f++) d.v[f] = 0.0;
            }
            if (s.held) {
                if (!was_held) report->stuck_after = here.t + times[0];
                since = -1.0;
                if (!s.timed && !nz) { /* nothing changes any more */
                    for (; next < n; next++) {
                        angles[next] = m->play >= 0 ? play.reading : here.th;
                        speed[next] = 0.0;
                        for (int f = 0; f < n_free; f++) slopes[(size_t)f * n + next] = m->play >= 0 ? play.slope[f] : d.th[f];
                    }
                    break;
                }
            } else
                s.direction = way;
        }
        double start[BLOCKS];
        rates_at(&s, &here, s.direction, start);
        const double left = s.held ? 3.0 / omega : time_to_reversal(s.direction, here.v, start[0], omega) * OVERSHOOT;
        double h = left / fmax(1.0, ceil(left / longest));
        if (!(h > 1e-12)) h = 1e-12;
        b.from = here;

        /* guess: the last panel's shape where this is its mirror image, else a harmonic */
        const int alike = at_rest && !s.held && last_h > 0.0 && fabs(h - last_h) < 0.1 * h;
        double shape[N], excess = 0.0;
        int solved = 0;
        memcpy(shape, b.u, sizeof shape);
        for (int attempt = 0; attempt < 60; attempt++) {
            b.h = h;
            if (alike && attempt == 0)
                for (int i = 0; i < N; i++) b.u[i] = shape[i] * (start[0] / last_start);
            else
                for (int i = 0; i < N; i++)
                    b.u[i] = s.held ? 0.0 : start[0] * cos(omega * h * T_nodes[i]) - omega * here.v * sin(omega * h * T_nodes[i]);
            for (int i = N; i < s.blocks * N; i++) b.u[i] = start[i / N];
            if (attempt > 0 || !alike) b.has_inverse = 0;
            if (solve(&s, &b, report)) {
                excess = tail(&s, &b) / TAIL;
                if (excess <= 1.0) { solved = 1; break; }
                h *= fmin(0.7, fmax(0.2, 0.8 * pow(excess, -1.0 / 14)));
            } else
                h *= 0.5;
            longest = h;
            report->rejected++;
        }
        if (!solved) { status = LOST_ACCURACY; break; }
        /* a short last panel says little about how long the next one may be */
        const double allowed = h * 0.95 * pow(fmax(excess, 1e-12), -1.0 / 14);
        if (excess > 0.05 || allowed > longest) longest = allowed;
        last_h = at_rest && !s.held ? h : 0.0;
        last_start = start[0];
        report->panels++;

        polynomials(b.u, nz, h, here.th, here.v, here.z, b.th_poly, b.v_poly, b.z_poly);
        int what;
        double event = first_event(&s, &b, &what);
        if (s.held) {
            const double freed = breakaway(&s, &b);
            if (freed < event) { event = freed; what = REVERSAL; }
        }
        const double x_end = fmin(event, 1.0), t_end = event <= 1.0 ? here.t + 0.5 * h * (event + 1.0) : here.t + h;
        report->error += excess * TAIL * largest(b.u) * h * h / (64.0 * N * N);
        if (n_free) {
            slopes_at_nodes(&s, &b);
            if (!invert(&b, nz)) { status = LOST_ACCURACY; break; }
            propagate(&b, nz, m->n_parameters, &d);
        }
        int last = next;
        while (last < n && at[last] <= t_end) {
            x[last] = 2.0 * (at[last] - here.t) / h - 1.0;
            last++;
        }
        const int size = last - next;
        sample(b.th_poly, N + 1, x + next, size, angles + next);
        if (with_clock) sample(b.v_poly, N, x + next, size, speed + next);
        for (int k = 0; k < kept_states; k++) sample(b.z_poly[k], N, x + next, size, z + (size_t)k * n + next);
        for (int f = 0; f < n_free; f++) {
            sample(d.th_poly[f], N + 1, x + next, size, slopes + (size_t)f * n + next);
            for (int k = 0; k < kept_states; k++)
                sample(d.z_poly[f][k], N, x + next, size, z_slopes + ((size_t)k * n_free + f) * n + next);
        }
        here = place_at(&b, nz, x_end);
        here.t = t_end;
        if (n_free) move_to(&d, nz, x_end);
        if (m->play >= 0) {
            const double half = 0.5 * p[m->play];
            for (int i = next; i < last; i++) {
                push(&play, half, angles[i], n_free, free_values, slopes + i, n);
                angles[i] = play.reading;
                for (int f = 0; f < n_free; f++) slopes[(size_t)f * n + i] = play.slope[f];
            }
            push(&play, half, here.th, n_free, free_values, d.th, 1);
        }
        next = last;
        if (event <= 1.0 && what == REVERSAL) {
            here.v = 0.0;
            if (!s.held) {
                report->reversals++;
                if (since >= 0.0) omega = 3.141592653589793 / (t_end - since);
                since = t_end;
            }
        } else if (event <= 1.0 && what >= 0)
            cross_switch(&s, &here, what, &d);
        if (report->panels + report->rejected > panels_in_advance + panels_a_second * (here.t - at[0])) status = LOST_ACCURACY;
        if (!(fabs(here.th) < 1e4) || !(fabs(here.v) < 1e8)) status = RAN_AWAY;
    }
    if (status == DONE) {
        for (int f = 0; f < n_free && with_clock; f++)
            for (int i = 0; i < n; i++) slopes[(size_t)f * n + i] += speed[i] * clock_slopes[(size_t)f * n + i];
        read_out(m, p, times, n, n_free, free_values, z, z_slopes, angles, n_free ? slopes : NULL);
    } else {
        for (int i = next; i < n; i++) angles[i] = NAN;
        for (size_t i = 0; i < (size_t)n_free * n; i++) slopes[i] = NAN;
    }
    free(work);
    return report->status = status;
}
