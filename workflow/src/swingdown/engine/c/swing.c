/* Trajectories of one pendulum, exact at reversals, with their sensitivities.
 *
 * A panel is the time from a reversal to just past the next one (or a part of it). The acceleration on it, and the
 * rate of every state an effect has, is a polynomial through N Gauss-Legendre nodes that satisfies the equations of
 * motion at each node; the signs of the velocity and of every abs() in the model are frozen, so the right-hand side is
 * smooth even past the reversal. The nodes are solved by Newton's iteration with the inverse Jacobian kept from panel
 * to panel: successive half-swings are nearly alike, so four or five cheap sweeps do. The same inverse gives the
 * sensitivities exactly. Only states that the motion depends on in no simpler way have unknowns of their own (points.h).
 * Between the nodes the equations are checked where an effect may be too narrow for them. The reversal is the root of
 * the velocity polynomial; the next panel starts there with the other sign, or the pendulum sticks: then its panels have
 * no acceleration until a torque frees it.
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
#define MISSED 1e-7     /* residual of the equations of motion between the nodes against their size */
#define ROUGH_TAIL 300.0 /* broken powers of the speed: their errors do not cancel, so the limits are stricter by this */
#define ROUGH_MISSED 10.0
#define NARROW 0.015    /* rad; the catalogue's narrowest effect in the angle has 0.01 */
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
    int sign_first[MAX_PARTS], n_switches, timed, inertial, rough, sharp, held, followers;
    /* Blocks of unknowns: the acceleration, then the rates of some states; row: of a block among all rates (0 the
     * acceleration, 1 + k state k). manner[k].of: for RATE and POSITION the block. */
    int blocks, row[BLOCKS];
    Manner manner[MAX_STATES];
    double pull[MAX_STATES], push[MAX_STATES], lead[MAX_STATES];
    double pull_by[MAX_STATES][MAX_PARAMETERS], push_by[MAX_STATES][MAX_PARAMETERS];
} Pendulum;

/* Where the motion is: time, angle, velocity, states. */
typedef struct {
    double t, th, v, z[MAX_STATES];
} Place;

/* A state along a panel: a polynomial and, of a FOLLOWER, what fades: (fade[0] + fade[1] t) exp(pull t) from its start. */
typedef struct {
    double poly[N + 2], fade[2];
} Course;

typedef struct {
    double h;
    Place from;
    double u[BLOCKS * N]; /* the unknowns at the nodes */
    double th[N], v[N], t[N], z[MAX_STATES * N];
    double growth[MAX_STATES * N]; /* of an ALONG state: its derivative by its own value at the start */
    double th_poly[N + 2], v_poly[N + 2];
    Course state[MAX_STATES];
    /* derivatives of every rate by angle, velocity, acceleration and states (ALONG: by their value at the start) at the
     * nodes, by the angle at the panel's start, and by the parameters */
    double by[BLOCKS * (3 + MAX_STATES) * N], by_start[BLOCKS * N], by_parameter[BLOCKS * MAX_PARAMETERS * N];
    double follow[MAX_STATES][N * N]; /* of a FOLLOWER: the inverse that gives its rate from what drives it */
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
    for (int k = 0; out && k <= s->m->n_states; k++) out[k] = rows[k * N];
    s->direction = kept;
    return a;
}

/* Where an ALONG state would settle. */
static inline double settled(const Pendulum *s, int k) { return -s->push[k] / s->pull[k]; }

/* An ALONG state at N angles, and its derivative there by its value at the panel's start. */
static void along(const Pendulum *s, const Panel *b, int k, const double *th, double *growth, double *z) {
    for (int i = 0; i < N; i++) {
        growth[i] = exp(s->pull[k] * (th[i] - b->from.th));
        z[i] = settled(s, k) + (b->from.z[k] - settled(s, k)) * growth[i];
    }
}

/* The derivative of an ALONG state at an angle by a parameter, its value and angle at the panel's start held. */
static double along_by(const Pendulum *s, const Panel *b, int k, int p, double th, double growth) {
    if (s->pull_by[k][p] == 0.0 && s->push_by[k][p] == 0.0) return 0.0;
    const double end_by = (s->push[k] * s->pull_by[k][p] / s->pull[k] - s->push_by[k][p]) / s->pull[k];
    return end_by * (1.0 - growth) + (b->from.z[k] - settled(s, k)) * growth * s->pull_by[k][p] * (th - b->from.th);
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
    memset(b->by_start, 0, (1 + nz) * N * sizeof(double));
    for (int k = 0; k < nz; k++) {
        if (s->manner[k].kind != ALONG) continue;
        const double end = settled(s, k);
        for (int o = 0; o <= nz; o++)
            for (int i = 0; i < N; i++) {
                double *by_state = b->by + (o * inputs + 3 + k) * N + i;
                if (*by_state == 0.0) continue;
                const double by_angle = s->pull[k] * (b->z[k * N + i] - end);
                b->by[o * inputs * N + i] += *by_state * by_angle;
                b->by_start[o * N + i] -= *by_state * by_angle;
                for (int p = 0; p < np; p++) {
                    const double change = along_by(s, b, k, p, b->th[i], b->growth[k * N + i]);
                    b->by_parameter[(o * np + p) * N + i] += *by_state * change;
                }
                *by_state *= b->growth[k * N + i];
            }
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

/* As many doubles at once as the processor takes (GCC's and Clang's vectors; each lane rounds as a double alone would, so
 * their number changes no bit; wider ones than the processor's are taken apart, at several times the cost). */
#if defined __AVX512F__
#define WIDTH 8
#elif defined __AVX__
#define WIDTH 4
#else
#define WIDTH 2
#endif
typedef double Lanes __attribute__((vector_size(WIDTH * sizeof(double)), aligned(8), may_alias));
#define LANES(array, k) (((Lanes *)(array))[k])
#define READ_LANES(array, k) (((const Lanes *)(array))[k])
#define LANES_OF(size) ((size) / WIDTH)

/* out[i] = sum over j of weight[j] * table[j * N + i] */
static inline void combine(const double *table, const double *weight, double *out) {
    Lanes sum[LANES_OF(N)] = {{0.0}};
    for (int j = 0; j < N; j++)
        for (int k = 0; k < LANES_OF(N); k++) sum[k] += READ_LANES(table + j * N, k) * weight[j];
    for (int k = 0; k < LANES_OF(N); k++) LANES(out, k) = sum[k];
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

static void states_at_nodes(const Pendulum *s, Panel *b) {
    double once[N], twice[N];
    combine(T_first, b->u, once);
    combine(T_second, b->u, twice);
    for (int i = 0; i < N; i++) {
        b->v[i] = b->from.v + b->h * once[i];
        b->th[i] = b->from.th + b->h * (b->from.v * T_nodes[i] + b->h * twice[i]);
    }
    for (int k = 0; k < s->m->n_states; k++) {
        double *z = b->z + k * N;
        const double *rate = b->u + s->manner[k].of * N, start = b->from.z[k];
        switch (s->manner[k].kind) {
        case RATE:
            combine(T_first, rate, once);
            for (int i = 0; i < N; i++) z[i] = start + b->h * once[i];
            break;
        case POSITION:
            combine(T_second, rate, twice);
            for (int i = 0; i < N; i++) z[i] = start + b->h * (b->from.z[s->row[s->manner[k].of] - 1] * T_nodes[i] + b->h * twice[i]);
            break;
        case FOLLOWER:
            for (int i = 0; i < N; i++) z[i] = 0.0; /* its rate is then what drives it */
            break;
        default:
            along(s, b, k, b->th, b->growth + k * N, z);
        }
    }
}

/* Invert the size x size matrix in place by Gauss-Jordan; 0 where it is singular. Rows are exchanged only for a small
 * pivot: the matrices are one less the integrals up to each node, so nearly triangular with a diagonal near one. */
#define SMALL_PIVOT 0.1
static inline int gauss_jordan(int size, double *g) {
    static const double ones[2 * BLOCKS * N] = {[BLOCKS * N] = 1.0};
    int swapped[BLOCKS * N];
    for (int c = 0; c < size; c++) {
        int pivot = c;
        for (int r = c + 1; r < size && !(fabs(g[c * size + c]) > SMALL_PIVOT); r++)
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
        const double unit = 1.0 / row[c], *one = ones + BLOCKS * N - c; /* one at c; added by lanes, for a store of one double before lanes are read stalls */
        Lanes pivot_row[LANES_OF(BLOCKS * N)];
        /* 1 + unit at c, so that each other row's own entry, factor, becomes -factor * unit */
        for (int k = 0; k < LANES_OF(size); k++) pivot_row[k] = (READ_LANES(row, k) + READ_LANES(one, k)) * unit;
        for (int r = 0; r < size; r++) {
            double *other = g + r * size;
            const double factor = other[c];
            for (int k = 0; k < LANES_OF(size); k++) LANES(other, k) -= pivot_row[k] * factor;
        }
        for (int k = 0; k < LANES_OF(size); k++) LANES(row, k) = pivot_row[k] - READ_LANES(one, k);
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
static int invert(const Pendulum *s, Panel *b) {
    const int blocks = s->blocks, size = blocks * N, inputs = 3 + s->m->n_states;
    for (int block = 0; block < blocks; block++) {
        int of = 0, position = -1; /* what the block's rate is integrated to, once and twice */
        if (block) {
            of = 3 + s->row[block] - 1;
            for (int k = 0; k < s->m->n_states; k++)
                if (s->manner[k].kind == POSITION && s->manner[k].of == block) position = 3 + k;
        } else {
            of = 1;
            position = 0;
        }
        for (int o = 0; o < blocks; o++) {
            const double *by = b->by + s->row[o] * inputs * N, *once = by + of * N, *twice = by + position * N;
            for (int j = 0; j < N; j++) {
                double *column = b->inverse + (block * N + j) * size + o * N;
                if (position >= 0)
                    for (int i = 0; i < N; i++)
                        column[i] = -b->h * (b->h * twice[i] * T_second[j * N + i] + once[i] * T_first[j * N + i]);
                else
                    for (int i = 0; i < N; i++) column[i] = -b->h * once[i] * T_first[j * N + i];
                if (block == 0) column[j] -= by[2 * N + j];
                if (block == o) column[j] += 1.0;
            }
        }
    }
    b->has_inverse = blocks > 1 ? gauss_jordan(size, b->inverse) : gauss_jordan(N, b->inverse);
    return b->has_inverse;
}

static double largest(const double *x) {
    double most = 0.0;
    for (int i = 0; i < N; i++) most = fabs(x[i]) > most ? fabs(x[i]) : most;
    return most;
}

/* Whether all N are finite; `largest` passes over what is no number. */
static int all_finite(const double *x) {
    double sum[4] = {0.0};
    for (int i = 0; i < N; i++) sum[i % 4] += x[i];
    return isfinite((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/* The size against which a block's errors count: of the acceleration, or of a thousandth of what it was at the largest
 * angle, for a swing that has died down is all rounding; of a state's rate, or of what would change the state by its own
 * size over the panel, for a state that has settled has no rate to speak of. */
static double size_of(const Pendulum *s, const Panel *b, int block, const double *rates) {
    const double least = block ? largest(b->z + (s->row[block] - 1) * N) / b->h : 1e-3 * s->p[0] * s->p[0] * s->reach;
    return fmax(largest(rates), least) + 1e-12;
}

/* Solve the panel from the guess in b->u; 0 where the iteration does not converge. */
static int solve(const Pendulum *s, Panel *b, Report *report) {
    double f[BLOCKS * N], residual[BLOCKS * N], step[BLOCKS * N], last = 0.0;
    const int blocks = s->blocks;
    int fresh = 0;
    for (int i = 0; i < N; i++) b->t[i] = b->from.t + b->h * T_nodes[i];
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double error = 0.0;
        states_at_nodes(s, b);
        rates(s, N, b->th, b->v, b->u, b->t, b->z, f, NULL);
        report->evaluations++;
        for (int k = 0; k < blocks; k++) {
            const double *found = f + s->row[k] * N;
            for (int i = 0; i < N; i++) residual[k * N + i] = found[i] - b->u[k * N + i];
            const double off = largest(residual + k * N);
            if (!all_finite(residual + k * N)) return 0;
            error = fmax(error, off / size_of(s, b, k, found));
        }
        /* the step about to be taken leaves an error smaller by the factor that the last one gained */
        const int solved = error * fmin(1.0, error / last) <= SOLVED;
        if (!b->has_inverse || (!solved && sweep && error > 0.2 * last && !fresh)) {
            slopes_at_nodes(s, b);
            if (!invert(s, b)) return 0;
            fresh = 2;
        }
        apply_inverse(b, blocks, residual, step);
        for (int i = 0; i < blocks * N; i++) b->u[i] += step[i];
        if (solved) {
            states_at_nodes(s, b);
            return 1;
        }
        last = error;
        if (fresh) fresh--;
    }
    return 0;
}

/* Coefficients, in powers of the position -1..1, of the integral that starts at `start`, of a rate of degree N - 1 or N
 * given by them. */
static inline void integrate(const double *rate, int degree, double h, double start, double *out) {
    double sum[8] = {0.0};
    for (int k = 0; k < LANES_OF(N); k++) {
        const Lanes part = READ_LANES(rate, k) * READ_LANES(T_reciprocal, k) * (0.5 * h);
        LANES(out + 1, k) = part;
        LANES(sum, k % LANES_OF(8)) += part;
    }
    if (degree == N) sum[0] += out[N + 1] = 0.5 * h * rate[N] * T_reciprocal[N];
    out[0] = start + (((sum[0] - sum[1]) + (sum[2] - sum[3])) + ((sum[4] - sum[5]) + (sum[6] - sum[7])));
}

static inline double horner(const double *c, int degree, double x) {
    double value = c[degree];
    for (int k = degree - 1; k >= 0; k--) value = value * x + c[k];
    return value;
}

/* z' = driven + pull z from z0, with `driven` at the nodes: exact for the polynomial through them. Where it settles
 * within a small part of the panel, a polynomial that satisfies the equation, and what is left of the start fades; there
 * the part of `driven` that is `lead` times the angle th, which has a higher degree, is taken as it is. */
#define SETTLES 12.0 /* time constants a panel */
static void follow(const double *driven, const double *inverse, double pull, double lead, const double *th, const double *th_poly,
                   double h, double z0, Course *out) {
    double c[N], rate[N];
    memset(out, 0, sizeof *out);
    if (-pull * h < SETTLES) {
        for (int i = 0; i < N; i++) c[i] = driven[i] + pull * z0;
        combine(inverse, c, rate);
        combine(T_monomial, rate, c);
        integrate(c, N - 1, h, z0, out->poly);
    } else {
        for (int i = 0; i < N; i++) rate[i] = driven[i] - lead * th[i];
        combine(T_monomial, rate, c);
        for (int k = N + 1; k >= 0; k--) {
            const double rise = k > N ? 0.0 : 2.0 / h * (k + 1) * out->poly[k + 1];
            out->poly[k] = (rise - lead * th_poly[k] - (k < N ? c[k] : 0.0)) / pull;
        }
        out->fade[0] = z0 - horner(out->poly, N + 1, -1.0);
    }
}

/* The inverses that `follow` takes, for the followers that are not quick to settle. */
static int prepare_followers(const Pendulum *s, Panel *b) {
    for (int k = 0; k < s->m->n_states; k++) {
        if (s->manner[k].kind != FOLLOWER || -s->pull[k] * b->h >= SETTLES) continue;
        for (int j = 0; j < N; j++)
            for (int i = 0; i < N; i++) b->follow[k][j * N + i] = (i == j) - b->h * s->pull[k] * T_first[j * N + i];
        if (!gauss_jordan(N, b->follow[k])) return 0;
    }
    return 1;
}

/* Angle, velocity and states along the panel: of the motion, or of its change by a value with `driven` for the followers'. */
static void polynomials(const Pendulum *s, const Panel *b, const double *u, double th, double v, const double *z, const double *driven,
                        const double *th_nodes, double *th_poly, double *v_poly, Course *state) {
    double c[N];
    combine(T_monomial, u, c);
    integrate(c, N - 1, b->h, v, v_poly);
    v_poly[N + 1] = 0.0;
    integrate(v_poly, N, b->h, th, th_poly);
    for (int k = 0; k < s->m->n_states; k++) {
        const int block = s->manner[k].of;
        double once[N + 1];
        switch (s->manner[k].kind) {
        case RATE:
            combine(T_monomial, u + block * N, c);
            integrate(c, N - 1, b->h, z[k], state[k].poly);
            state[k].poly[N + 1] = state[k].fade[0] = state[k].fade[1] = 0.0;
            break;
        case POSITION:
            combine(T_monomial, u + block * N, c);
            integrate(c, N - 1, b->h, z[s->row[block] - 1], once);
            integrate(once, N, b->h, z[k], state[k].poly);
            state[k].fade[0] = state[k].fade[1] = 0.0;
            break;
        case FOLLOWER:
            follow(driven + k * N, b->follow[k], s->pull[k], s->lead[k], th_nodes, th_poly, b->h, z[k], &state[k]);
            break;
        default: memset(&state[k], 0, sizeof state[k]); /* no polynomial is needed */
        }
    }
}

/* The motion along the solved panel. */
static void trace(const Pendulum *s, Panel *b) {
    double f[BLOCKS * N];
    if (s->followers) rates(s, N, b->th, b->v, b->u, b->t, b->z, f, NULL);
    polynomials(s, b, b->u, b->from.th, b->from.v, b->from.z, f + N, b->th, b->th_poly, b->v_poly, b->state);
    for (int k = 0; k < s->m->n_states; k++)
        if (s->manner[k].kind == FOLLOWER)
            for (int i = 0; i < N; i++) b->z[k * N + i] = horner(b->state[k].poly, N + 1, 2.0 * T_nodes[i] - 1.0);
}

static double faded(const Course *state, double pull, double after) {
    return state->fade[0] == 0.0 && state->fade[1] == 0.0 ? 0.0 : (state->fade[0] + state->fade[1] * after) * exp(pull * after);
}

static Place place_at(const Pendulum *s, const Panel *b, double x) {
    const double after = 0.5 * b->h * (x + 1.0);
    Place at = {b->from.t + after, horner(b->th_poly, N + 1, x), horner(b->v_poly, N, x), {0.0}};
    for (int k = 0; k < s->m->n_states; k++)
        at.z[k] = s->manner[k].kind == ALONG
            ? settled(s, k) + (b->from.z[k] - settled(s, k)) * exp(s->pull[k] * (at.th - b->from.th))
            : horner(b->state[k].poly, N + 1, x) + faded(&b->state[k], s->pull[k], after);
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
        most = fmax(most, (block ? 30.0 : 1.0) * (fabs(c[0]) + fabs(c[1])) / size_of(s, b, block, b->u + block * N));
    }
    return most;
}

/* Root of the velocity in [low, high] (positions in -1..1), where direction * v is >= 0 at low and < 0 at high. */
static double velocity_root(const Panel *b, double direction, double low, double high, double v_low, double v_high) {
    double x = v_low - v_high != 0.0 ? low + (high - low) * v_low / (v_low - v_high) : low;
    if (!(x > low && x < high)) x = 0.5 * (low + high);
    for (int k = 0; k < 80; k++) {
        double value = b->v_poly[N], slope = 0.0;
        for (int j = N - 1; j >= 0; j--) {
            slope = slope * x + value;
            value = value * x + b->v_poly[j];
        }
        double next = x - value / slope;
        if (fabs(next - x) < 1e-7) return next; /* Newton's next step would be below rounding */
        if (direction * value >= 0.0) low = x; else high = x;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == low || next == high) return next;
        x = next;
    }
    return x;
}

/* The value and the slope by time of N positions of a polynomial (-1..1). */
static void sloped(const double *poly, double h, const double *x, double *value, double *slope) {
    for (int k = 0; k < LANES_OF(N); k++) {
        const Lanes at = READ_LANES(x, k);
        Lanes sum = poly[N + 1] - (Lanes){0.0}, rise = {0.0};
        for (int j = N; j >= 0; j--) {
            rise = rise * at + sum;
            sum = sum * at + poly[j];
        }
        LANES(value, k) = sum;
        LANES(slope, k) = rise * (2.0 / h);
    }
}

/* How far the equations of motion are missed between the nodes, against their size: what is narrower than the nodes'
 * distance shows nowhere else. Looked at are the panel's start and the middles between the nodes and, where an effect may
 * be narrow in the angle, places closer than NARROW. */
static double missed(const Pendulum *s, const Panel *b) {
    double most = 0.0, low = b->th[0], high = b->th[0];
    for (int i = 1; i < N; i++) {
        low = fmin(low, b->th[i]);
        high = fmax(high, b->th[i]);
    }
    const int rounds = s->sharp > 1 ? 1 + (int)fmin(1e4, (high - low) / (N * NARROW)) : 1;
    for (int round = 0; round <= rounds - (s->sharp < 2); round++) {
        double x[N], t[N], th[N], v[N], again[N], u[BLOCKS * N], z[MAX_STATES * N] = {0.0}, growth[N], f[BLOCKS * N];
        for (int i = 0; i < N; i++) {
            x[i] = round ? 2.0 * ((round - 1) * N + i + 0.5) / (rounds * N) - 1.0 : i ? T_nodes[i] + T_nodes[i - 1] - 1.0 : -1.0;
            t[i] = b->from.t + 0.5 * b->h * (x[i] + 1.0);
        }
        sloped(b->th_poly, b->h, x, th, again);
        sloped(b->v_poly, b->h, x, v, u);
        for (int k = 0; k < s->m->n_states; k++) {
            if (s->manner[k].kind == ALONG) along(s, b, k, th, growth, z + k * N);
            else if (s->manner[k].kind != FOLLOWER)
                sloped(b->state[k].poly, b->h, x, z + k * N, s->manner[k].kind == RATE ? u + s->manner[k].of * N : again);
        }
        rates(s, N, th, v, u, t, z, f, NULL);
        for (int block = 0; block < s->blocks; block++) {
            const double *found = f + s->row[block] * N;
            const double size = size_of(s, b, block, found);
            for (int i = 0; i < N; i++) most = fmax(most, fabs(found[i] - u[block * N + i]) / size);
        }
    }
    return most;
}

static double switch_at(const Pendulum *s, const Panel *b, int k, double x) {
    double g[MAX_SWITCHES];
    const Place at = place_at(s, b, x);
    switches_at(s, &at, g);
    return g[k];
}

/* The first event on the solved panel: its position in (-1, 1], or 2 for none; what: REVERSAL or the switch. */
enum { REVERSAL = -1, NOTHING = -2 };
static double first_event(const Pendulum *s, const Panel *b, int *what) {
    double at = 2.0, low = -1.0, v_low = b->from.v, g[MAX_SWITCHES * N];
    *what = NOTHING;
    for (int i = 0; i <= N && !s->held; i++) {
        const double x = i < N ? 2.0 * T_nodes[i] - 1.0 : 1.0;
        const double v = i < N ? b->v[i] : horner(b->v_poly, N, 1.0);
        if (s->direction * v < 0.0) {
            at = velocity_root(b, s->direction, low, x, v_low, v);
            *what = REVERSAL;
            break;
        }
        low = x;
        v_low = v;
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
        Place at = place_at(s, b, x);
        at.v = 0.0;
        if (leaves_rest(s, &at, 0.0)) {
            double high = x;
            for (int k = 0; k < 60 && high - low > 1e-15; k++) {
                const double middle = 0.5 * (low + high);
                at = place_at(s, b, middle);
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

/* The polynomial at n positions, ROOM at a time; as many must follow the positions. */
#define ROOM 16
static inline void sample(const double *poly, int degree, const double *x, int n, double *out) {
    for (int start = 0; start < n; start += ROOM) {
        Lanes at[LANES_OF(ROOM)], value[LANES_OF(ROOM)];
        for (int j = 0; j < LANES_OF(ROOM); j++) {
            at[j] = READ_LANES(x + start, j);
            value[j] = poly[degree] - (Lanes){0.0};
        }
        for (int k = degree - 1; k >= 0; k--)
            for (int j = 0; j < LANES_OF(ROOM); j++) value[j] = value[j] * at[j] + poly[k];
        if (n - start >= ROOM) memcpy(out + start, value, sizeof value);
        else memcpy(out + start, value, (n - start) * sizeof(double));
    }
}

static double rate_of_course(const Course *state, double pull, double h, double x) {
    double value = state->poly[N + 1], slope = 0.0;
    for (int k = N; k >= 0; k--) {
        slope = slope * x + value;
        value = value * x + state->poly[k];
    }
    const double after = 0.5 * h * (x + 1.0);
    return 2.0 / h * slope + pull * faded(state, pull, after) + (state->fade[1] != 0.0 ? state->fade[1] * exp(pull * after) : 0.0);
}

static void sample_state(const Course *state, double pull, double h, const double *x, int n, double *out) {
    sample(state->poly, N + 1, x, n, out);
    if (state->fade[0] == 0.0 && state->fade[1] == 0.0) return;
    for (int i = 0; i < n; i++) {
        const double after = 0.5 * h * (x[i] + 1.0);
        if (pull * after < -45.0) break;
        out[i] += faded(state, pull, after);
    }
}

/* Sensitivities: of angle, velocity and states by each free value, now and along the panel. */
typedef struct {
    int n;
    const int *by;
    double th[MAX_PARAMETERS], v[MAX_PARAMETERS], z[MAX_PARAMETERS][MAX_STATES];
    double th_poly[MAX_PARAMETERS][N + 2], v_poly[MAX_PARAMETERS][N + 2];
    Course state[MAX_PARAMETERS][MAX_STATES];
} Sensitivities;

/* What changes a rate at the nodes for a change of free value f: through the place where the panel starts, and itself. */
static void forcing(const Pendulum *s, const Panel *b, const Sensitivities *d, int f, int row, double *out) {
    const int nz = s->m->n_states, inputs = 3 + nz;
    const double *by = b->by + row * inputs * N;
    for (int i = 0; i < N; i++) out[i] = by[i] * (d->th[f] + d->v[f] * b->h * T_nodes[i]) + by[N + i] * d->v[f];
    for (int k = 0; k < nz; k++) {
        const double *by_state = by + (3 + k) * N;
        for (int i = 0; i < N; i++) out[i] += by_state[i] * d->z[f][k];
        if (s->manner[k].kind == POSITION) {
            const double speed = b->h * d->z[f][s->row[s->manner[k].of] - 1];
            for (int i = 0; i < N; i++) out[i] += by_state[i] * speed * T_nodes[i];
        }
    }
    if (nz)
        for (int i = 0; i < N; i++) out[i] += b->by_start[row * N + i] * d->th[f];
    if (d->by[f] >= 0)
        for (int i = 0; i < N; i++) out[i] += b->by_parameter[(row * s->m->n_parameters + d->by[f]) * N + i];
}

/* Along the solved panel: the linear problem with the panel's own inverse. */
static void propagate(const Pendulum *s, const Panel *b, Sensitivities *d) {
    const int nz = s->m->n_states, inputs = 3 + nz;
    for (int f = 0; f < d->n; f++) {
        double rhs[BLOCKS * N], du[BLOCKS * N], driven[MAX_STATES * N], th[N];
        for (int block = 0; block < s->blocks; block++) forcing(s, b, d, f, s->row[block], rhs + block * N);
        apply_inverse(b, s->blocks, rhs, du);
        for (int k = 0; s->followers && k < nz; k++) {
            if (s->manner[k].kind != FOLLOWER) continue;
            /* what drives its change: as the blocks', with the change of the motion that is now known */
            const double *by = b->by + (1 + k) * inputs * N;
            double once[N], twice[N], *out = driven + k * N;
            forcing(s, b, d, f, 1 + k, out);
            combine(T_first, du, once);
            combine(T_second, du, twice);
            for (int i = 0; i < N; i++) {
                out[i] += b->h * (b->h * by[i] * twice[i] + by[N + i] * once[i]) + by[2 * N + i] * du[i] - s->pull[k] * d->z[f][k];
                th[i] = d->th[f] + b->h * (d->v[f] * T_nodes[i] + b->h * twice[i]);
            }
        }
        polynomials(s, b, du, d->th[f], d->v[f], d->z[f], driven, th, d->th_poly[f], d->v_poly[f], d->state[f]);
        for (int k = 0; s->followers && k < nz; k++)
            if (d->by[f] >= 0) d->state[f][k].fade[1] = s->pull_by[k][d->by[f]] * b->state[k].fade[0];
    }
}

static void move_to(const Pendulum *s, const Panel *b, Sensitivities *d, double x) {
    const double after = 0.5 * b->h * (x + 1.0), th = horner(b->th_poly, N + 1, x);
    for (int f = 0; f < d->n; f++) {
        const double th_before = d->th[f];
        d->th[f] = horner(d->th_poly[f], N + 1, x);
        d->v[f] = horner(d->v_poly[f], N, x);
        for (int k = 0; k < s->m->n_states; k++) {
            if (s->manner[k].kind == ALONG) {
                const double growth = exp(s->pull[k] * (th - b->from.th));
                d->z[f][k] = growth * (d->z[f][k] + s->pull[k] * (b->from.z[k] - settled(s, k)) * (d->th[f] - th_before))
                             + (d->by[f] >= 0 ? along_by(s, b, k, d->by[f], th, growth) : 0.0);
            } else
                d->z[f][k] = horner(d->state[f][k].poly, N + 1, x) + faded(&d->state[f][k], s->pull[k], after);
        }
    }
}

/* The rates jump at an event that comes `later[f]` for a change of free value f: saltation. */
static void jump(Sensitivities *d, int n_states, const double *before, const double *after, const double *later) {
    for (int f = 0; f < d->n; f++) {
        d->v[f] += (before[0] - after[0]) * later[f];
        for (int k = 0; k < n_states; k++) d->z[f][k] += (before[1 + k] - after[1 + k]) * later[f];
    }
}

/* Cross a switch other than the reversal; where the rates jump there, so do the sensitivities. */
static void cross_switch(Pendulum *s, const Place *x, int k, Sensitivities *d) {
    double before[BLOCKS], after[BLOCKS], high[MAX_SWITCHES], low[MAX_SWITCHES], later[MAX_PARAMETERS], moved[MAX_PARAMETERS];
    rates_at(s, x, s->direction, before);
    s->sign[k] = -s->sign[k];
    rates_at(s, x, s->direction, after);
    double difference = 0.0, size = 0.0;
    for (int j = 0; j <= s->m->n_states; j++) {
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
    jump(d, s->m->n_states, before, after, later);
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
        s->sharp |= e->sharp;
        if (s->n_switches > MAX_SWITCHES) return 0;
    }
    s->blocks = 1;
    for (int k = 0; k < m->n_motions; k++) {
        const Part at = m->motions[k];
        const Effect *e = &EFFECTS[at.row];
        for (int j = 0; j < e->n_states; j++) {
            s->manner[at.first_state + j] = e->manner[j];
            s->followers += e->manner[j].kind == FOLLOWER;
            if (e->manner[j].kind != RATE) continue;
            s->manner[at.first_state + j].of = s->blocks;
            s->row[s->blocks++] = 1 + at.first_state + j;
        }
        for (int j = 0; j < e->n_states; j++)
            if (e->manner[j].kind == POSITION) s->manner[at.first_state + j].of = s->manner[at.first_state + e->manner[j].of].of;
    }
    return 1;
}

/* What draws the states that are linear in themselves, in the present direction, with its derivatives. */
static void draw_states(Pendulum *s) {
    const double zero = 0.0;
    for (int k = 0; k < s->m->n_motions; k++) {
        const Part at = s->m->motions[k];
        const Effect *e = &EFFECTS[at.row];
        if (!e->n_states) continue;
        double row[3 * MAX_STATES] = {0.0}, by_p[3 * MAX_STATES * MAX_PARAMETERS] = {0.0};
        const Points q = {1, 1, &zero, &zero, &zero, &zero, &zero, &zero, &zero, s->p[0], s->m->duration, s->direction};
        const Slopes slopes = {NULL, by_p, 0, s->m->n_parameters, 1};
        e->linear(&q, s->p + at.first_parameter, s->sign + s->sign_first[k], row, at);
        e->linear_slopes(&q, s->p + at.first_parameter, s->sign + s->sign_first[k], &slopes, at);
        for (int j = 0; j < e->n_states; j++) {
            const int state = at.first_state + j;
            s->pull[state] = row[3 * j];
            s->push[state] = row[3 * j + 1];
            s->lead[state] = row[3 * j + 2];
            memcpy(s->pull_by[state], by_p + 3 * j * s->m->n_parameters, s->m->n_parameters * sizeof(double));
            memcpy(s->push_by[state], by_p + (3 * j + 1) * s->m->n_parameters, s->m->n_parameters * sizeof(double));
        }
    }
}

/* A broken power of the speed has no Taylor series where the speed is zero: panels get shorter and shorter up to every
 * reversal, the more so the smaller the exponent (60 tried a half-swing at 0.2). */
double usual_panels(const Model *m) {
    for (int k = 0; k < m->n_motions; k++)
        if (EFFECTS[m->motions[k].row].rough) return 20.0;
    return 5.0;
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
    double *work = malloc((ROOM + (size_t)n * (3 + (with_clock ? n_free : 0) + kept_states * (1 + n_free))) * sizeof(double));
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
                if (!was_held) jump(&d, nz, before, after, later);
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
        if (nz) draw_states(&s);
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
            for (int i = N; i < s.blocks * N; i++) b.u[i] = start[s.row[i / N]];
            if (attempt > 0 || !alike) b.has_inverse = 0;
            if (solve(&s, &b, report)) {
                excess = tail(&s, &b) / TAIL;
                if (s.followers && !prepare_followers(&s, &b)) continue;
                trace(&s, &b);
                /* a short panel adds little, however far it is off */
                const double part = fmin(1.0, h * omega / 3.141592653589793);
                if (s.rough) excess *= ROUGH_TAIL * part;
                if (s.sharp && excess <= 1.0) excess = fmax(excess, missed(&s, &b) / MISSED * (s.rough ? ROUGH_MISSED : 1.0) * part);
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
            if (!invert(&s, &b)) { status = LOST_ACCURACY; break; }
            propagate(&s, &b, &d);
        }
        int last = next;
        while (last < n && at[last] <= t_end) last++;
        const double per_second = 2.0 / h;
        for (int i = next; i < last; i++) x[i] = (at[i] - here.t) * per_second - 1.0;
        const int size = last - next;
        sample(b.th_poly, N + 1, x + next, size, angles + next);
        if (with_clock) sample(b.v_poly, N, x + next, size, speed + next);
        for (int k = 0; k < kept_states; k++) sample_state(&b.state[k], s.pull[k], h, x + next, size, z + (size_t)k * n + next);
        for (int f = 0; f < n_free; f++) {
            sample(d.th_poly[f], N + 1, x + next, size, slopes + (size_t)f * n + next);
            for (int k = 0; k < kept_states; k++)
                sample_state(&d.state[f][k], s.pull[k], h, x + next, size, z_slopes + ((size_t)k * n_free + f) * n + next);
        }
        for (int k = 0; with_clock && k < kept_states; k++)
            for (int i = next; i < last; i++) { /* a sample that comes later sees the state move on */
                const double rate = rate_of_course(&b.state[k], s.pull[k], h, x[i]);
                for (int f = 0; f < n_free; f++) z_slopes[((size_t)k * n_free + f) * n + i] += rate * clock_slopes[(size_t)f * n + i];
            }
        here = place_at(&s, &b, x_end);
        here.t = t_end;
        if (n_free) move_to(&s, &b, &d, x_end);
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
        for (int k = 0; k < nz; k++)
            if (!isfinite(here.z[k])) status = RAN_AWAY;
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
