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

/* The velocity at a position, and its slope by that. */
static double velocity_at(const Panel *panel, double x, double *slope) {
    double value = panel->curve.v[N];
    *slope = 0.0;
    for (int j = N - 1; j >= 0; j--) {
        *slope = *slope * x + value;
        value = value * x + panel->curve.v[j];
    }
    return value;
}

/* Root of the velocity in the bracket, where direction * v is >= 0 at low and < 0 at high: Newton's, kept within. */
static double velocity_root(const Panel *panel, double direction, Bracket at) {
    double low = at.low, high = at.high, difference = at.at_low - at.at_high, slope;
    double x = difference != 0.0 ? low + (high - low) * at.at_low / difference : low;
    if (!(x > low && x < high)) x = 0.5 * (low + high);
    for (int k = 0; k < 80; k++) {
        const double value = velocity_at(panel, x, &slope);
        double next = x - value / slope;
        if (fabs(next - x) < 1e-7) return next; /* Newton's next step would be below rounding */
        if (direction * value >= 0.0) low = x; else high = x;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == low || next == high) return next;
        x = next;
    }
    return x;
}

/* The velocity falls at the bracket's low and rises at its high end, forwards at both: where it turns backwards in between,
 * by more than rounding, the bracket ends there, and 1 is returned. */
static int turns_back(const Panel *panel, double direction, Bracket *at) {
    const double rounding = 1e-13 * largest(panel->v);
    double low = at->low, high = at->high, slope;
    for (int k = 0; k < 60 && high - low > 1e-12; k++) {
        const double middle = 0.5 * (low + high), value = velocity_at(panel, middle, &slope);
        if (direction * value < -rounding) {
            at->high = middle;
            at->at_high = value;
            return 1;
        }
        if (direction * slope < 0.0) low = middle; else high = middle;
    }
    return 0;
}

static Event first_reversal(const System *s, const Panel *panel) {
    Bracket at = {.low = -1.0, .at_low = panel->from.v};
    double slope, slope_before;
    if (s->stuck) return (Event){NEVER, NOTHING};
    velocity_at(panel, -1.0, &slope_before);
    for (int i = 0; i <= N; i++) {
        at.high = position_of(i);
        at.at_high = i < N ? panel->v[i] : velocity_at(panel, 1.0, &slope);
        if (i < N) slope = panel->u[i];
        const int dips = s->direction * slope_before < 0.0 && s->direction * slope > 0.0;
        if (s->direction * at.at_high < 0.0 || (dips && turns_back(panel, s->direction, &at)))
            return (Event){velocity_root(panel, s->direction, at), REVERSAL};
        at.low = at.high;
        at.at_low = at.at_high;
        slope_before = slope;
    }
    return (Event){NEVER, NOTHING};
}

/* A quantity along a solved panel, positive until the event that it tells of; k: which of its kind. */
typedef double (*Watched)(System *s, const Panel *panel, int k, double x);

static double watched_root(System *s, const Panel *panel, Watched watched, int k, double low, double high) {
    for (int step = 0; step < 60 && high - low > 1e-15; step++) {
        const double middle = 0.5 * (low + high);
        if (watched(s, panel, k, middle) >= 0.0) low = middle; else high = middle;
    }
    return high;
}

/* A position where the quantity is negative between three at which it is not and is least at the middle one; or NEVER. Only
 * where the parabola through the three comes close to zero is it looked for, by the golden section. */
static double watched_dip(System *s, const Panel *panel, Watched watched, int k, const double *x, const double *value) {
    const double golden = 0.3819660112501051, left = x[1] - x[0], right = x[2] - x[1];
    const double fall = (value[0] - value[1]) / left, rise = (value[2] - value[1]) / right;
    const double curvature = (fall + rise) / (left + right), slope = (rise * left - fall * right) / (left + right);
    if (!(curvature > 0.0) || value[1] - 0.25 * slope * slope / curvature > 0.5 * value[1]) return NEVER;
    double low = x[0], high = x[2], middle = x[1], least = value[1];
    for (int step = 0; step < 60 && high - low > 1e-9; step++) {
        const int above = high - middle > middle - low;
        const double next = above ? middle + golden * (high - middle) : middle - golden * (middle - low);
        const double at_next = watched(s, panel, k, next);
        if (at_next < 0.0) return next;
        if (at_next < least) {
            if (above) low = middle; else high = middle;
            middle = next;
            least = at_next;
        } else if (above) high = next;
        else low = next;
    }
    return NEVER;
}

/* Where the quantity first turns negative before `end`, or NEVER. at_nodes: its values there. */
static double watched_crossing(System *s, const Panel *panel, Watched watched, int k, const double *at_nodes, double end) {
    double x[3] = {-1.0, -1.0, -1.0}, value[3];
    value[1] = value[2] = watched(s, panel, k, -1.0);
    for (int i = 0; i <= N; i++) {
        const int past = position_of(i) > end;
        for (int j = 0; j < 2; j++) {
            x[j] = x[j + 1];
            value[j] = value[j + 1];
        }
        x[2] = past ? end : position_of(i);
        value[2] = i < N && !past ? at_nodes[i] : watched(s, panel, k, x[2]);
        if (value[2] < 0.0) return watched_root(s, panel, watched, k, x[1], x[2]);
        if (i && value[1] < value[0] && value[1] <= value[2]) {
            const double dip = watched_dip(s, panel, watched, k, x, value);
            if (dip < NEVER) return watched_root(s, panel, watched, k, x[0], dip);
        }
        if (past) break;
    }
    return NEVER;
}

/* The argument of switch k, on the side that it is frozen at. */
static double switch_side(System *s, const Panel *panel, int k, double x) {
    double g[MAX_SWITCHES];
    const PhasePoint at = point_at(s, panel, x);
    switches_at(s, &at, g);
    return s->sign[k] * g[k];
}

/* How far friction is from letting the pendulum go forwards (0) or backwards (1), while stuck. */
static double hold(System *s, const Panel *panel, int k, double x) {
    PhasePoint at = point_at(s, panel, x);
    at.v = 0.0;
    const Freed freed = freed_at(s, &at);
    return k ? freed.down : -freed.up;
}

/* The same at the nodes, a row each. */
static void hold_at_nodes(System *s, const Panel *panel, double *out) {
    const double zero[N] = {0.0}, direction = s->direction;
    const MotionPoints nodes = {N, panel->th, zero, zero, panel->t, panel->z};
    double f[BLOCKS * N];
    s->stuck = 0;
    for (int k = 0; k < 2; k++) {
        s->direction = k ? -1.0 : 1.0;
        right_hand_side(s, &nodes, f, NULL);
        for (int i = 0; i < N; i++) out[k * N + i] = k ? f[i] : -f[i];
    }
    s->direction = direction;
    s->stuck = 1;
}

static double hold_ratio(System *s, const Panel *panel) {
    double f[2 * N], most = 0.0;
    hold_at_nodes(s, panel, f);
    for (int k = 0; k < 2; k++) most = fmax(most, tail_of(f + k * N) / (largest(f + k * N) + 1e-300));
    return most / HOLD_TRUNCATION;
}

static Event first_event(System *s, const Panel *panel) {
    double g[MAX_SWITCHES * N];
    const MotionPoints nodes = nodes_of(panel);
    Event first = first_reversal(s, panel);
    if (s->n_switches) switch_values(s, &nodes, g);
    for (int k = 0; k < s->n_switches; k++) {
        for (int i = 0; i < N; i++) g[k * N + i] *= s->sign[k];
        const double crossing = watched_crossing(s, panel, switch_side, k, g + k * N, first.position);
        if (crossing < first.position) first = (Event){crossing, k};
    }
    if (!s->stuck) return first;
    hold_at_nodes(s, panel, g);
    for (int k = 0; k < 2; k++) {
        const double freed = watched_crossing(s, panel, hold, k, g + k * N, fmin(first.position, 1.0));
        if (freed < first.position) first = (Event){freed, REVERSAL};
    }
    return first;
}

static Freed freed_at(System *s, const PhasePoint *x) {
    const int stuck = s->stuck;
    s->stuck = 0;
    const Freed freed = {rates_at(s, x, 1.0, NULL), rates_at(s, x, -1.0, NULL)};
    s->stuck = stuck;
    return freed;
}

static int leaves_rest(const Freed *freed, double came) {
    const double up = freed->up, down = freed->down;
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
