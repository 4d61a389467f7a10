/* Trajectories of one pendulum, exact at reversals, with their sensitivities.
 *
 * A panel is the time from a reversal to just past the next one (or a part of it). The acceleration on it is a
 * polynomial through N Gauss-Legendre nodes that satisfies the equation of motion at each node; the signs of the
 * velocity and of every abs() in the model are frozen, so the right-hand side is smooth even past the reversal. The
 * nodes are solved by Newton's iteration with the inverse Jacobian kept from panel to panel: successive half-swings
 * are nearly alike, so four or five cheap sweeps do. The same inverse gives the sensitivities exactly. The reversal is
 * the root of the velocity polynomial; the next panel starts there with the other sign, or the pendulum sticks.
 */
#include "swing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    int n;
    const double *th, *v, *t, *sn, *cs;
    double omega_n, duration, direction;
} Points;

typedef struct {
    void (*value)(const Points *, const double *, const double *, double *);
    void (*partials)(const Points *, const double *, const double *, double *, double *, double *, double *, int);
    void (*switches)(const Points *, const double *, const double *, double *, int);
    int n_parameters, n_switches, timed;
} Effect;

/* Sine and cosine that compilers vectorise and that give the same bits on every machine: reduce by whole turns,
 * take a quarter of the angle (Cephes polynomials on +-pi/4), double twice. */
static inline void sine_cosine(double x, double *s, double *c) {
    const double big = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to whole numbers */
    double turns = x * 0.15915494309189535 + big;
    turns -= big;
    double z = ((x - turns * 6.28318530717958623) - turns * 2.44929359829470635e-16) * 0.25;
    double zz = z * z;
    double ps = ((((1.58962301576546568060e-10 * zz - 2.50507477628578072866e-8) * zz + 2.75573136213857245213e-6) * zz
                  - 1.98412698295895385996e-4) * zz + 8.33333333332211858878e-3) * zz - 1.66666666666666307295e-1;
    double pc = ((((-1.13585365213876817300e-11 * zz + 2.08757008419747316778e-9) * zz - 2.75573141792967388112e-7) * zz
                  + 2.48015872888517045348e-5) * zz - 1.38888888888730564116e-3) * zz + 4.16666666666665929218e-2;
    double s0 = z + z * zz * ps, c0 = 1.0 - 0.5 * zz + zz * zz * pc;
    double s1 = 2.0 * s0 * c0, c1 = 1.0 - 2.0 * s0 * s0;
    *s = 2.0 * s1 * c1;
    *c = 1.0 - 2.0 * s1 * s1;
}
static inline double sine(double x) { double s, c; sine_cosine(x, &s, &c); return s; }
static inline double cosine(double x) { double s, c; sine_cosine(x, &s, &c); return c; }

#include "catalogue.h"

#define OVERSHOOT 1.012      /* a panel reaches this far past the reversal that is expected */
#define SOLVED 1e-11         /* residual of the collocation equations against the acceleration, before the last sweep */
#define TAIL 3e-6            /* last two Legendre coefficients of the acceleration against its size */
#define SWEEPS 14
#define CHUNK 64

typedef struct {
    const Model *m;
    const double *p;
    double direction;
    double sign[MAX_SWITCHES];
    int n_switches, switch_torque[MAX_SWITCHES], switch_local[MAX_SWITCHES], sign_first[MAX_PARAMETERS];
    int timed;
} Pendulum;

typedef struct {
    double t0, h, th0, v0;
    double a[N], th[N], v[N], t[N];
    double theta_poly[N + 2], v_poly[N + 1];
    double d_theta[N], d_v[N], d_p[MAX_PARAMETERS * N]; /* row 0: omega_n */
    double inverse[N * N];
    int has_inverse;
} Panel;

static void accelerations(const Pendulum *s, int n, const double *th, const double *v, const double *t, double *a) {
    double sn[N], cs[N];
    for (int i = 0; i < n; i++) sine_cosine(th[i], &sn[i], &cs[i]);
    const Points q = {n, th, v, t, sn, cs, s->p[0], s->m->duration, s->direction};
    for (int i = 0; i < n; i++) a[i] = 0.0;
    for (int k = 0; k < s->m->n_torques; k++)
        EFFECTS[s->m->torques[k]].value(&q, s->p + s->m->torque_first[k], s->sign + s->sign_first[k], a);
}

static double acceleration(Pendulum *s, double th, double v, double t, double direction) {
    double a, kept = s->direction;
    s->direction = direction;
    accelerations(s, 1, &th, &v, &t, &a);
    s->direction = kept;
    return a;
}

static void partials(const Pendulum *s, Panel *b) {
    double sn[N], cs[N];
    for (int i = 0; i < N; i++) sine_cosine(b->th[i], &sn[i], &cs[i]);
    const Points q = {N, b->th, b->v, b->t, sn, cs, s->p[0], s->m->duration, s->direction};
    memset(b->d_theta, 0, sizeof b->d_theta);
    memset(b->d_v, 0, sizeof b->d_v);
    memset(b->d_p, 0, N * sizeof(double));
    for (int k = 0; k < s->m->n_torques; k++) {
        const int first = s->m->torque_first[k];
        EFFECTS[s->m->torques[k]].partials(&q, s->p + first, s->sign + s->sign_first[k], b->d_theta, b->d_v, b->d_p,
                                           b->d_p + first * N, N);
    }
}

static void switch_values(const Pendulum *s, int n, const double *th, const double *v, const double *t, double *out) {
    double sn[N], cs[N];
    if (!s->n_switches) return;
    for (int i = 0; i < n; i++) sine_cosine(th[i], &sn[i], &cs[i]);
    const Points q = {n, th, v, t, sn, cs, s->p[0], s->m->duration, s->direction};
    for (int k = 0; k < s->m->n_torques; k++)
        EFFECTS[s->m->torques[k]].switches(&q, s->p + s->m->torque_first[k], s->sign + s->sign_first[k],
                                           out + s->sign_first[k] * N, N);
}

/* out = base + sum over j of weight[j] * column j of table */
static inline void combine(const double *restrict table, const double *restrict weight, double *restrict out) {
    double sum[N] = {0.0};
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++) sum[i] += table[j * N + i] * weight[j];
    memcpy(out, sum, sizeof sum);
}

static void states_at_nodes(Panel *b) {
    double once[N], twice[N];
    combine(T_first, b->a, once);
    combine(T_second, b->a, twice);
    for (int i = 0; i < N; i++) {
        b->v[i] = b->v0 + b->h * once[i];
        b->th[i] = b->th0 + b->h * (b->v0 * T_nodes[i] + b->h * twice[i]);
    }
}

/* Inverse of I - h^2 diag(a_theta) A2 - h diag(a_v) A1, by Gauss-Jordan with pivoting; stored by column. */
static int invert(Panel *b) {
    double g[N][2 * N];
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < N; i++)
            g[j][i] = (i == j) - b->h * (b->h * b->d_theta[i] * T_second[j * N + i] + b->d_v[i] * T_first[j * N + i]);
        for (int i = 0; i < N; i++) g[j][N + i] = i == j;
    }
    for (int c = 0; c < N; c++) {
        int pivot = c;
        for (int r = c + 1; r < N; r++)
            if (fabs(g[r][c]) > fabs(g[pivot][c])) pivot = r;
        if (!(fabs(g[pivot][c]) > 1e-300)) return 0;
        if (pivot != c) {
            double row[2 * N];
            memcpy(row, g[c], sizeof row);
            memcpy(g[c], g[pivot], sizeof row);
            memcpy(g[pivot], row, sizeof row);
        }
        const double unit = 1.0 / g[c][c];
        for (int i = 0; i < 2 * N; i++) g[c][i] *= unit;
        for (int r = 0; r < N; r++) {
            const double factor = g[r][c];
            if (r == c || factor == 0.0) continue;
            for (int i = 0; i < 2 * N; i++) g[r][i] -= factor * g[c][i];
        }
    }
    for (int j = 0; j < N; j++) memcpy(b->inverse + j * N, g[j] + N, N * sizeof(double));
    b->has_inverse = 1;
    return 1;
}

static double largest(const double *x) {
    double most = 0.0;
    for (int i = 0; i < N; i++) most = fmax(most, fabs(x[i]));
    return most;
}

/* Solve the panel from the guess in b->a; 0 where the iteration does not converge. */
static int solve(const Pendulum *s, Panel *b, Report *report) {
    double f[N], residual[N], step[N], last = INFINITY;
    int fresh = 0;
    for (int i = 0; i < N; i++) b->t[i] = b->t0 + b->h * T_nodes[i];
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        states_at_nodes(b);
        accelerations(s, N, b->th, b->v, b->t, f);
        report->evaluations++;
        for (int i = 0; i < N; i++) residual[i] = f[i] - b->a[i];
        const double error = largest(residual), size = largest(f);
        if (!isfinite(error)) return 0;
        if (!b->has_inverse || (error > 0.2 * last && !fresh && error > SOLVED * size)) {
            partials(s, b);
            if (!invert(b)) return 0;
            fresh = 2;
        }
        combine(b->inverse, residual, step);
        for (int i = 0; i < N; i++) b->a[i] += step[i];
        if (error <= SOLVED * size || error < 1e-290) {
            states_at_nodes(b);
            return 1;
        }
        last = error;
        if (fresh) fresh--;
    }
    return 0;
}

static void integrate_poly(const double *a, double h, double v0, double th0, double *v, double *th) {
    double c[N];
    combine(T_monomial, a, c);
    const double half = 0.5 * h;
    double at_start = 0.0;
    for (int k = 0; k < N; k++) {
        v[k + 1] = half * c[k] / (k + 1);
        at_start += k % 2 ? v[k + 1] : -v[k + 1];
    }
    v[0] = v0 - at_start;
    at_start = 0.0;
    for (int k = 0; k <= N; k++) {
        th[k + 1] = half * v[k] / (k + 1);
        at_start += k % 2 ? th[k + 1] : -th[k + 1];
    }
    th[0] = th0 - at_start;
}

static inline double horner(const double *c, int degree, double x) {
    double value = c[degree];
    for (int k = degree - 1; k >= 0; k--) value = value * x + c[k];
    return value;
}

/* How far the last Legendre coefficients of the acceleration stand out of its size. */
static double tail(const Panel *b) {
    double c[2] = {0.0, 0.0};
    for (int k = 0; k < 2; k++)
        for (int j = 0; j < N; j++) c[k] += T_tail[k * N + j] * b->a[j];
    return (fabs(c[0]) + fabs(c[1])) / (largest(b->a) + 1e-300);
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
    double th = horner(b->theta_poly, N + 1, x), v = horner(b->v_poly, N, x), t = b->t0 + 0.5 * b->h * (x + 1.0);
    double g[MAX_SWITCHES * N];
    switch_values(s, 1, &th, &v, &t, g);
    return g[k * N];
}

static double switch_root(const Pendulum *s, const Panel *b, int k, double low, double high) {
    for (int step = 0; step < 60 && high - low > 1e-15; step++) {
        const double middle = 0.5 * (low + high);
        if (s->sign[k] * switch_at(s, b, k, middle) >= 0.0) low = middle; else high = middle;
    }
    return high;
}

/* The first event on the solved panel: its position in (-1, 1], or 2 for none; what: -1 the reversal, else a switch. */
static double first_event(const Pendulum *s, const Panel *b, int *what) {
    double at = 2.0, low = -1.0, g[MAX_SWITCHES * N];
    for (int i = 0; i <= N; i++) {
        const double x = i < N ? 2.0 * T_nodes[i] - 1.0 : 1.0;
        const double v = i < N ? b->v[i] : horner(b->v_poly, N, 1.0);
        if (s->direction * v < 0.0) {
            at = velocity_root(b, s->direction, low, x);
            *what = -1;
            break;
        }
        low = x;
    }
    if (!s->n_switches) return at;
    switch_values(s, N, b->th, b->v, b->t, g);
    for (int k = 0; k < s->n_switches; k++) {
        low = -1.0;
        for (int i = 0; i <= N; i++) {
            double x = i < N ? 2.0 * T_nodes[i] - 1.0 : 1.0;
            const int past = x > at;
            if (past) x = at;
            const double value = (i < N && !past) ? g[k * N + i] : switch_at(s, b, k, x);
            if (s->sign[k] * value < 0.0) {
                const double root = switch_root(s, b, k, low, x);
                if (root < at) { at = root; *what = k; }
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
static int leaves_rest(Pendulum *s, double th, double t, double from) {
    const double up = acceleration(s, th, 0.0, t, 1.0), down = acceleration(s, th, 0.0, t, -1.0);
    const int first = from != 0.0 ? (from > 0.0 ? -1 : 1) : (up + down >= 0.0 ? 1 : -1);
    if (first > 0) return up > 0.0 ? 1 : (down < 0.0 ? -1 : 0);
    return down < 0.0 ? -1 : (up > 0.0 ? 1 : 0);
}

/* The clock's true times of the samples and, by row, their derivatives by the free values. */
static int true_times(const Model *m, const double *p, const double *times, int n, int n_free, const int *free_values,
                      double *out, double *slopes) {
    for (int i = 0; i < n; i++) out[i] = times[i] - times[0];
    if (slopes) memset(slopes, 0, (size_t)n_free * n * sizeof(double));
    for (int c = 0; c < m->n_clocks; c++) {
        const Effect *e = &EFFECTS[m->clocks[c]];
        for (int start = 0; start < n; start += CHUNK) {
            const int size = n - start < CHUNK ? n - start : CHUNK;
            double stamped[CHUNK], zero[CHUNK] = {0.0}, d_t[CHUNK], d_v[CHUNK], d_p[MAX_PARAMETERS * CHUNK];
            memcpy(stamped, out + start, size * sizeof(double));
            const Points q = {size, zero, zero, stamped, zero, zero, p[0], m->duration, 1.0};
            e->value(&q, p + m->clock_first[c], NULL, out + start);
            if (!slopes) continue;
            e->partials(&q, p + m->clock_first[c], NULL, d_t, d_v, d_v, d_p, CHUNK);
            for (int f = 0; f < n_free; f++) {
                const int own = free_values[f] - m->clock_first[c];
                for (int i = 0; i < size; i++) {
                    double *slope = slopes + (size_t)f * n + start + i;
                    *slope = *slope * d_t[i] + (own >= 0 && own < e->n_parameters ? d_p[own * CHUNK + i] : 0.0);
                }
            }
        }
    }
    for (int i = 1; i < n; i++)
        if (!(out[i] > out[i - 1])) return 0;
    return 1;
}

/* What the sensors make of the angles, one after the other, with the slopes by the chain rule. */
static void read_out(const Model *m, const double *p, const double *times, int n, int n_free, const int *free_values,
                     double *y, double *slopes) {
    for (int k = 0; k < m->n_sensors; k++) {
        const Effect *e = &EFFECTS[m->sensors[k]];
        for (int start = 0; start < n; start += CHUNK) {
            const int size = n - start < CHUNK ? n - start : CHUNK;
            double th[CHUNK], sn[CHUNK], cs[CHUNK], d_th[CHUNK], d_v[CHUNK], zero[CHUNK] = {0.0}, d_p[MAX_PARAMETERS * CHUNK];
            memcpy(th, y + start, size * sizeof(double));
            for (int i = 0; i < size; i++) sine_cosine(th[i], &sn[i], &cs[i]);
            const Points q = {size, th, zero, times + start, sn, cs, p[0], m->duration, 1.0};
            e->value(&q, p + m->sensor_first[k], NULL, y + start);
            if (!slopes) continue;
            e->partials(&q, p + m->sensor_first[k], NULL, d_th, d_v, d_v, d_p, CHUNK);
            for (int f = 0; f < n_free; f++) {
                const int own = free_values[f] - m->sensor_first[k];
                double *row = slopes + (size_t)f * n + start;
                for (int i = 0; i < size; i++)
                    row[i] = row[i] * d_th[i] + (own >= 0 && own < e->n_parameters ? d_p[own * CHUNK + i] : 0.0);
            }
        }
    }
}

/* Sensitivities along the solved panel: the linear problem with the panel's own inverse. */
static void panel_slopes(const Panel *b, int n_free, const int *free_values, const double *dth, const double *dv,
                         double (*th_poly)[N + 2], double (*v_poly)[N + 1]) {
    for (int f = 0; f < n_free; f++) {
        double rhs[N], da[N];
        for (int i = 0; i < N; i++)
            rhs[i] = b->d_theta[i] * (dth[f] + dv[f] * b->h * T_nodes[i]) + b->d_v[i] * dv[f];
        if (free_values[f] >= 0)
            for (int i = 0; i < N; i++) rhs[i] += b->d_p[free_values[f] * N + i];
        combine(b->inverse, rhs, da);
        integrate_poly(da, b->h, dv[f], dth[f], v_poly[f], th_poly[f]);
    }
}

static void sample(const double *poly, int degree, const double *x, int n, double *out) {
    for (int start = 0; start < n; start += CHUNK) {
        const int size = n - start < CHUNK ? n - start : CHUNK;
        double value[CHUNK];
        const double *xs = x + start;
        for (int i = 0; i < size; i++) value[i] = poly[degree];
        for (int k = degree - 1; k >= 0; k--)
            for (int i = 0; i < size; i++) value[i] = value[i] * xs[i] + poly[k];
        memcpy(out + start, value, size * sizeof(double));
    }
}

/* At a switch other than the reversal the acceleration may jump: rescale the velocity's slopes (saltation). */
static void cross_switch(Pendulum *s, const Panel *b, int k, double x, int n_free, const int *free_values,
                         const double *dth, double *dv) {
    const double th = horner(b->theta_poly, N + 1, x), v = horner(b->v_poly, N, x), t = b->t0 + 0.5 * b->h * (x + 1.0);
    const double before = acceleration(s, th, v, t, s->direction);
    s->sign[k] = -s->sign[k];
    const double after = acceleration(s, th, v, t, s->direction);
    const double jump = after - before;
    if (!n_free || fabs(jump) < 1e-9 * (fabs(before) + fabs(after))) return;
    const double e = 1e-6;
    double out[MAX_SWITCHES * N], q[MAX_PARAMETERS];
#define G(TH, V, TT) (switch_values(s, 1, (double[]){TH}, (double[]){V}, (double[]){TT}, out), out[k * N])
    const double g_th = (G(th + e, v, t) - G(th - e, v, t)) / (2 * e), g_v = (G(th, v + e, t) - G(th, v - e, t)) / (2 * e);
    const double g_t = (G(th, v, t + e) - G(th, v, t - e)) / (2 * e);
    const double rate = g_th * v + g_v * before + g_t;
    const double *kept = s->p;
    for (int f = 0; f < n_free; f++) {
        double g_p = 0.0;
        if (free_values[f] >= 0) {
            memcpy(q, kept, s->m->n_parameters * sizeof(double));
            s->p = q;
            q[free_values[f]] = kept[free_values[f]] + e;
            const double high = G(th, v, t);
            q[free_values[f]] = kept[free_values[f]] - e;
            g_p = (high - G(th, v, t)) / (2 * e);
            s->p = kept;
        }
        const double later = -(g_th * dth[f] + g_v * dv[f] + g_p) / rate;
        dv[f] -= jump * later;
    }
#undef G
}

int swing_trajectory(const Model *m, const double *p, double release_angle, double release_velocity,
                     const double *times, int n, int n_free, const int *free_values,
                     double *angles, double *slopes, Report *report) {
    Pendulum s = {.m = m, .p = p};
    Panel b = {.has_inverse = 0};
    double dth[MAX_PARAMETERS], dv[MAX_PARAMETERS];
    double th_slopes[MAX_PARAMETERS][N + 2], v_slopes[MAX_PARAMETERS][N + 1];
    double t = 0.0, th = release_angle, v = release_velocity, omega, since = -1.0, longest = INFINITY;
    double previous_h = 0.0, previous_start = 0.0;
    int next = 0, from_rest = 0;

    *report = (Report){.stuck_after = -1.0};
    if (!slopes) n_free = 0;
    if (m->n_parameters > MAX_PARAMETERS || n_free > MAX_PARAMETERS) return report->status = TOO_LARGE;
    for (int k = 0; k < m->n_torques; k++) {
        const Effect *e = &EFFECTS[m->torques[k]];
        s.sign_first[k] = s.n_switches;
        s.timed |= e->timed;
        if (s.n_switches + e->n_switches > MAX_SWITCHES) return report->status = TOO_LARGE;
        s.n_switches += e->n_switches;
    }
    /* local time, position on the panel, velocity, and the clock's slopes, for every sample */
    double *work = malloc((size_t)n * (3 + (m->n_clocks ? n_free : 0)) * sizeof(double));
    if (!work) return report->status = NO_MEMORY;
    double *at = work, *x = work + n, *speed = work + 2 * (size_t)n;
    double *clock_slopes = m->n_clocks && n_free ? work + 3 * (size_t)n : NULL;
    int status = DONE;
    if (!true_times(m, p, times, n, n_free, free_values, at, clock_slopes)) status = CLOCK_RUNS_BACK;

    memset(b.d_p, 0, sizeof b.d_p);
    for (int f = 0; f < n_free; f++) {
        dth[f] = free_values[f] == RELEASE_ANGLE;
        dv[f] = free_values[f] == RELEASE_VELOCITY;
    }
    omega = frequency_guess(p[0], th, v);
    t = at[0];
    s.direction = v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0);
    if (s.n_switches) { /* the side each switch starts on; exactly on it, the side it moves to */
        double g[MAX_SWITCHES * N], ahead = th + 1e-9 * (v != 0.0 ? v : -th);
        switch_values(&s, 1, &th, &v, &t, g);
        for (int k = 0; k < s.n_switches; k++) {
            if (g[k * N] == 0.0) switch_values(&s, 1, &ahead, &v, &t, g);
            s.sign[k] = g[k * N] < 0.0 ? -1.0 : 1.0;
        }
    }

    while (next < n && status == DONE) {
        if (v == 0.0) {
            const int way = leaves_rest(&s, th, t, s.direction);
            if (!way) { /* held by friction: for good, or until a changing torque frees it */
                report->stuck_after = t + times[0];
                for (int f = 0; f < n_free; f++) dv[f] = 0.0;
                double free_at = INFINITY;
                if (s.timed) {
                    const double step = fmin(0.02 * 6.283185307179586 / omega, n > 1 ? (at[n - 1] - at[0]) / (n - 1) : 1.0);
                    for (double u = t + step; u < at[n - 1] + step; u += step)
                        if (leaves_rest(&s, th, u, s.direction)) {
                            double low = u - step;
                            for (int k = 0; k < 60 && u - low > 1e-15 * u; k++) {
                                const double middle = 0.5 * (low + u);
                                if (leaves_rest(&s, th, middle, s.direction)) u = middle; else low = middle;
                            }
                            free_at = u;
                            break;
                        }
                }
                for (; next < n && at[next] <= free_at; next++) {
                    angles[next] = th;
                    for (int f = 0; f < n_free; f++) slopes[(size_t)f * n + next] = dth[f];
                    speed[next] = 0.0;
                }
                if (next >= n) break;
                t = free_at;
                since = -1.0;
                s.direction = leaves_rest(&s, th, t, s.direction);
                if (s.direction == 0.0) { status = LOST_ACCURACY; break; }
            } else {
                /* the jump of the acceleration at the reversal rescales the velocity's slopes */
                if (s.direction != 0.0 && n_free) {
                    const double ratio = acceleration(&s, th, 0.0, t, way) / acceleration(&s, th, 0.0, t, s.direction);
                    for (int f = 0; f < n_free; f++) dv[f] *= ratio;
                }
                s.direction = way;
            }
            from_rest = 1;
        }
        const double a0 = acceleration(&s, th, v, t, s.direction);
        const double left = time_to_reversal(s.direction, v, a0, omega) * OVERSHOOT;
        double h = left / fmax(1.0, ceil(left / longest));
        if (!(h > 0.0)) h = 1e-12;
        b.t0 = t, b.th0 = th, b.v0 = v;

        /* guess: the last panel's shape where this is its mirror image, else a harmonic */
        const int alike = from_rest && previous_h > 0.0 && fabs(h - previous_h) < 0.1 * h;
        int solved = 0;
        double shape[N], excess = 0.0;
        memcpy(shape, b.a, sizeof shape);
        for (int attempt = 0; attempt < 60; attempt++) {
            b.h = h;
            if (alike && attempt == 0)
                for (int i = 0; i < N; i++) b.a[i] = shape[i] * (a0 / previous_start);
            else
                for (int i = 0; i < N; i++)
                    b.a[i] = a0 * cos(omega * h * T_nodes[i]) - omega * v * sin(omega * h * T_nodes[i]);
            if (attempt > 0 || fabs(h - previous_h) > 0.1 * h) b.has_inverse = 0;
            if (solve(&s, &b, report)) {
                excess = tail(&b) / TAIL;
                if (excess <= 1.0) { solved = 1; break; }
                h *= fmin(0.7, fmax(0.2, 0.8 * pow(excess, -1.0 / 14)));
                longest = h;
            } else
                longest = h *= 0.5;
            report->rejected++;
        }
        if (!solved) { status = LOST_ACCURACY; break; }
        /* a short last panel says little about how long the next one may be */
        const double allowed = h * 0.95 * pow(fmax(excess, 1e-12), -1.0 / 14);
        if (excess > 0.05 || allowed > longest) longest = allowed;
        previous_h = from_rest ? h : 0.0;
        previous_start = a0;
        report->panels++;

        integrate_poly(b.a, h, v, th, b.v_poly, b.theta_poly);
        int what = -2;
        const double event = first_event(&s, &b, &what);
        const double x_end = event <= 1.0 ? event : 1.0, t_end = event <= 1.0 ? t + 0.5 * h * (event + 1.0) : t + h;
        report->error += excess * TAIL * largest(b.a) * h * h / (64.0 * N * N);
        if (n_free) {
            partials(&s, &b);
            if (!invert(&b)) { status = LOST_ACCURACY; break; }
            panel_slopes(&b, n_free, free_values, dth, dv, th_slopes, v_slopes);
        }
        int last = next;
        while (last < n && at[last] <= t_end) {
            x[last] = 2.0 * (at[last] - t) / h - 1.0;
            last++;
        }
        sample(b.theta_poly, N + 1, x + next, last - next, angles + next);
        if (clock_slopes) sample(b.v_poly, N, x + next, last - next, speed + next);
        for (int f = 0; f < n_free; f++) sample(th_slopes[f], N + 1, x + next, last - next, slopes + (size_t)f * n + next);
        next = last;

        th = horner(b.theta_poly, N + 1, x_end);
        v = horner(b.v_poly, N, x_end);
        for (int f = 0; f < n_free; f++) {
            dth[f] = horner(th_slopes[f], N + 1, x_end);
            dv[f] = horner(v_slopes[f], N, x_end);
        }
        from_rest = 0;
        if (what == -1 && event <= 1.0) {
            v = 0.0;
            report->reversals++;
            if (since >= 0.0) omega = 3.141592653589793 / (t_end - since);
            since = t_end;
        } else if (what >= 0 && event <= 1.0) {
            t = t_end;
            cross_switch(&s, &b, what, x_end, n_free, free_values, dth, dv);
        }
        t = t_end;
        if (!(fabs(th) < 1e4) || !(fabs(v) < 1e8)) status = RAN_AWAY;
    }
    if (status == DONE) {
        for (int f = 0; f < n_free && clock_slopes; f++)
            for (int i = 0; i < n; i++) slopes[(size_t)f * n + i] += speed[i] * clock_slopes[(size_t)f * n + i];
        read_out(m, p, times, n, n_free, free_values, angles, slopes);
    } else {
        for (int i = 0; i < n; i++)
            if (i >= next) angles[i] = NAN;
        if (slopes)
            for (size_t i = 0; i < (size_t)n_free * n; i++) slopes[i] = NAN;
    }
    free(work);
    return report->status = status;
}
