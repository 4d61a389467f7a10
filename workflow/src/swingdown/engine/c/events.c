#include "events.h"

static void freeze_signs(System *s, const PhasePoint *here) {
    double g[MAX_SWITCHES], ahead[MAX_SWITCHES];
    PhasePoint next = *here;
    next.th += 1e-9 * (here->v != 0.0 ? here->v : -here->th);
    switches_at(s, here, g);
    switches_at(s, &next, ahead);
    for (int k = 0; k < s->n_switches; k++) s->sign[k] = (g[k] != 0.0 ? g[k] : ahead[k]) < 0.0 ? -1.0 : 1.0;
}

/* The nodes' positions, then the panel's end. */
static inline double position_of(int i) { return i < N ? 2.0 * T_nodes[i] - 1.0 : 1.0; }

/* Positions on a panel with a quantity's value there. */
typedef struct {
    double low, high, at_low, at_high;
} Bracket;

/* Root of the velocity in the bracket, where direction * v is >= 0 at low and < 0 at high: Newton's, kept within. */
static double velocity_root(const Panel *panel, double direction, Bracket at) {
    double low = at.low, high = at.high, difference = at.at_low - at.at_high;
    double x = difference != 0.0 ? low + (high - low) * at.at_low / difference : low;
    if (!(x > low && x < high)) x = 0.5 * (low + high);
    for (int k = 0; k < 80; k++) {
        double value = panel->curve.v[N], slope = 0.0;
        for (int j = N - 1; j >= 0; j--) {
            slope = slope * x + value;
            value = value * x + panel->curve.v[j];
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

static Event first_reversal(const System *s, const Panel *panel) {
    Bracket at = {.low = -1.0, .at_low = panel->from.v};
    for (int i = 0; i <= N && !s->stuck; i++) {
        at.high = position_of(i);
        at.at_high = i < N ? panel->v[i] : horner(panel->curve.v, N, 1.0);
        if (s->direction * at.at_high < 0.0) return (Event){velocity_root(panel, s->direction, at), REVERSAL};
        at.low = at.high;
        at.at_low = at.at_high;
    }
    return (Event){NEVER, NOTHING};
}

static double switch_at(const System *s, const Panel *panel, int k, double x) {
    double g[MAX_SWITCHES];
    const PhasePoint at = point_at(s, panel, x);
    switches_at(s, &at, g);
    return g[k];
}

/* Where switch k changes sign before `end`, by bisection, or NEVER. at_nodes: its values there. */
static double switch_crossing(const System *s, const Panel *panel, int k, const double *at_nodes, double end) {
    double low = -1.0;
    for (int i = 0; i <= N; i++) {
        double high = position_of(i);
        const int past = high > end;
        if (past) high = end;
        const double value = i < N && !past ? at_nodes[i] : switch_at(s, panel, k, high);
        if (s->sign[k] * value < 0.0) {
            for (int step = 0; step < 60 && high - low > 1e-15; step++) {
                const double middle = 0.5 * (low + high);
                if (s->sign[k] * switch_at(s, panel, k, middle) >= 0.0) low = middle; else high = middle;
            }
            return high;
        }
        if (past) break;
        low = high;
    }
    return NEVER;
}

static int breaks_away(System *s, const Panel *panel, double x) {
    PhasePoint at = point_at(s, panel, x);
    at.v = 0.0;
    return leaves_rest(s, &at, 0.0) != 0;
}

/* While stuck: the first position on the panel where a torque frees the pendulum, by bisection, or NEVER. */
static double breakaway(System *s, const Panel *panel) {
    double low = -1.0;
    for (int i = 0; i <= N; i++) {
        double high = position_of(i);
        if (breaks_away(s, panel, high)) {
            for (int k = 0; k < 60 && high - low > 1e-15; k++) {
                const double middle = 0.5 * (low + high);
                if (breaks_away(s, panel, middle)) high = middle; else low = middle;
            }
            return high;
        }
        low = high;
    }
    return NEVER;
}

static Event first_event(System *s, const Panel *panel) {
    double g[MAX_SWITCHES * N];
    const MotionPoints nodes = nodes_of(panel);
    Event first = first_reversal(s, panel);
    if (s->n_switches) switch_values(s, &nodes, g);
    for (int k = 0; k < s->n_switches; k++) {
        const double crossing = switch_crossing(s, panel, k, g + k * N, first.position);
        if (crossing < first.position) first = (Event){crossing, k};
    }
    if (s->stuck) {
        const double freed = breakaway(s, panel);
        if (freed < first.position) first = (Event){freed, REVERSAL};
    }
    return first;
}

static int leaves_rest(System *s, const PhasePoint *x, double came) {
    const int stuck = s->stuck;
    s->stuck = 0;
    const double up = rates_at(s, x, 1.0, NULL), down = rates_at(s, x, -1.0, NULL);
    s->stuck = stuck;
    const int first = came != 0.0 ? (came > 0.0 ? -1 : 1) : (up + down >= 0.0 ? 1 : -1);
    if (first > 0) return up > 0.0 ? 1 : (down < 0.0 ? -1 : 0);
    return down < 0.0 ? -1 : (up > 0.0 ? 1 : 0);
}

static double time_to_reversal(double direction, double v, double a, double omega) {
    const double phase = atan2(-direction * a / omega, direction * v);
    return (0.5 * PI - phase) / omega;
}

static double swing_frequency(double omega_n, double th, double v) {
    const double w = fmax(fabs(omega_n), 1e-3);
    double ratio = 0.5 * (1.0 + cos(th) - v * v / (2.0 * w * w)); /* cos^2 of half the amplitude */
    double a = 1.0, g = sqrt(fmax(ratio, 1e-4));
    for (int k = 0; k < 5; k++) {
        const double mean = 0.5 * (a + g);
        g = sqrt(a * g);
        a = mean;
    }
    return w * a;
}
