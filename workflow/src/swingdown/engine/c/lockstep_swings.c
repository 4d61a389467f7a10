/* Fits side by side of models whose motion depends on the velocity's sign: each lane's panels go from reversal to reversal of its
 * own swing, a fixed number of panels to each half-swing, and its samples are read one by one. */
#include "events.h"
#include "lockstep_swings.h"

#define PAST_REVERSAL 1.02  /* how far beyond the reversal that is expected the panels of a half-swing reach */
#define LEAST_PART 0.3      /* of an equal part of a half-swing: the least panel, as of one more where the reversal is yet to come */
#define ROOT_STEPS 7
#define ROOT 1e-12          /* of a position */

/* ---- What the last point foretells ---- */

/* Where a lane's panel is kept: as the same part of the same half-swing. */
static void find_kept(const Lockstep *s, const Swing *w, int *at) {
    const int most = PANELS_OF(s->parts);
    for (int l = 0; l < WIDTH; l++) at[l] = w->half[l] * most + (w->part[l] < most ? w->part[l] : most - 1);
}

static Each read_kept(const Each *kept, const int *at, int row, int i) {
    Each found;
    for (int l = 0; l < WIDTH; l++) found[l] = kept[at[l] * row + i][l];
    return found;
}

static void write_kept(Each *kept, const int *at, int row, int i, Which which, Each x) {
    for (int l = 0; l < WIDTH; l++)
        if (which[l]) kept[at[l] * row + i][l] = x[l];
}

/* The last solution, as much larger or smaller as the motion at the panel's start now is; where there is none, a harmonic. */
static void guess_from_last(const Lockstep *s, const int *at, LockstepPanel *panel) {
    const Each omega = s->system.p[0] * s->system.p[0], faster = s->system.p[0] / s->last_omega;
    const Each th = read_kept(s->angles_from, at, 1, 0), v = faster * read_kept(s->velocities_from, at, 1, 0);
    const Each size = omega * th * th + v * v, ratio = (omega * panel->th * th + panel->v * v) / size;
    const Which alike = (Which)(size > 0.0) & (Which)(ratio > 0.5) & (Which)(ratio < 2.0);
    const Each factor = ratio * faster * faster;
    guess_harmonic(s, panel);
    UNROLL
    for (int i = 0; i < LN; i++) panel->u[i] = choose(alike, factor * read_kept(s->last.u, at, LN, i), panel->u[i]);
}

static void keep_panel(Lockstep *s, const int *at, Which which, const LockstepPanel *panel) {
    for (int i = 0; i < LN; i++) write_kept(s->last.u, at, LN, i, which, panel->u[i]);
    write_kept(s->angles_from, at, 1, 0, which, panel->th);
    write_kept(s->velocities_from, at, 1, 0, which, panel->v);
}

/* ---- Panels ---- */

static void lay_course(Each h, Each th, Each v, const Each *u, Course *out) {
    Each c[LN], sum_v = each(0.0), sum_th = each(0.0);
    UNROLL
    for (int i = 0; i < LN; i++) c[i] = each(0.0);
    UNROLL
    for (int j = 0; j < LN; j++) {
        const Each at = u[j];
        UNROLL
        for (int i = 0; i < LN; i++) c[i] += LOCKSTEP_monomial[j * LN + i] * at;
    }
    const Each half = 0.5 * h;
    UNROLL
    for (int k = 0; k < LN; k++) {
        out->v[k + 1] = half * c[k] * LOCKSTEP_reciprocal[k];
        sum_v = (k % 2 ? sum_v + out->v[k + 1] : sum_v - out->v[k + 1]);
    }
    out->v[0] = v - sum_v;
    UNROLL
    for (int k = 0; k <= LN; k++) {
        out->th[k + 1] = half * out->v[k] * LOCKSTEP_reciprocal[k];
        sum_th = (k % 2 ? sum_th + out->th[k + 1] : sum_th - out->th[k + 1]);
    }
    out->th[0] = th - sum_th;
}

/* Where the velocity turns, for the fits of which it does so on the panel (into `turns`); 1 elsewhere. `lost`: it does so more
 * than once, or where is not found. */
static Each reversal_of(const Swing *w, const LockstepSystem *s, const Course *course, Which *turns, Which *lost) {
    Each low = each(-1.0), high = each(1.0), at_low = s->direction * w->panel.v, at_high = each(0.0);
    Which found = {0};
    *lost = (Which){0};
    for (int i = 0; i <= LN; i++) {
        const Each x = each(i < LN ? 2.0 * LOCKSTEP_nodes[i] - 1.0 : 1.0);
        const Each value = s->direction * value_of(course->v, LN, x);
        const Which now = (Which)(value < 0.0) & ~found;
        high = choose(now, x, high);
        at_high = choose(now, value, at_high);
        *lost |= found & (Which)(value > 0.0);
        found |= now;
        low = choose(found, low, x);
        at_low = choose(found, at_low, value);
    }
    *turns = found;
    if (!any(found)) return each(1.0);
    Each x = low + (high - low) * at_low / (at_low - at_high), step = each(1.0);
    for (int k = 0; k < ROOT_STEPS; k++) {
        Each value = course->v[LN], slope = each(0.0);
        for (int j = LN - 1; j >= 0; j--) {
            slope = slope * x + value;
            value = value * x + course->v[j];
        }
        step = value / slope;
        x -= step;
    }
    *lost |= found & ~((Which)(size_of(step) < ROOT) & (Which)(x >= low) & (Which)(x <= high));
    return choose(found, x, each(1.0));
}

/* The acceleration at rest, were the pendulum to move in a direction. */
static Each acceleration_at_rest(LockstepSystem *s, Each th, Each t, double direction) {
    LockstepPanel still; /* of which no more than the time is looked at */
    const Each kept = s->direction;
    Each angles[LN], zero[LN], f[LN];
    for (int i = 0; i < LN; i++) {
        angles[i] = th;
        zero[i] = each(0.0);
    }
    still.h = each(0.0);
    still.t = t;
    s->direction = each(direction);
    lockstep_accelerations(s, angles, zero, &still, f, NULL);
    s->direction = kept;
    return f[0];
}

/* The way the pendulum leaves rest, having come the other way, or first that of the stronger pull; `held`: none, or either;
 * `stuck`: none, for friction holds it. */
static Each way_from_rest(LockstepSystem *s, Each th, Each t, Each came, Each *acceleration, Which *held, Which *stuck) {
    const Each up = acceleration_at_rest(s, th, t, 1.0), down = acceleration_at_rest(s, th, t, -1.0);
    const Which rises = (Which)(up > 0.0), falls = (Which)(down < 0.0);
    *stuck = ~(rises | falls);
    *held = (rises & falls) | *stuck;
    const Each way = choose(rises, each(1.0), each(-1.0));
    *held |= (Which)(way * came > 0.0); /* driven on by friction */
    *acceleration = choose(rises, up, down);
    return way;
}

static void start_swing(Lockstep *s, Swing *w, Which *which) {
    LockstepPanel *panel = &w->panel;
    start_lockstep(s, panel, w->th, w->v);
    panel->t = w->since = each(0.0);
    Which held, stuck;
    Each acceleration, way = way_from_rest(&s->system, panel->th, panel->t, each(0.0), &acceleration, &held, &stuck);
    const Which moves = (Which)(panel->v != 0.0);
    *which &= moves | ~held;
    s->system.direction = choose(moves, choose((Which)(panel->v < 0.0), each(-1.0), each(1.0)), way);
    for (int l = 0; l < WIDTH; l++) {
        const double omega = swing_frequency(s->values[0][l], panel->th[l], panel->v[l]), v = panel->v[l];
        w->duration[l] = PI / omega;
        if (v != 0.0) {
            const Each a = acceleration_at_rest(&s->system, panel->th, panel->t, v < 0.0 ? -1.0 : 1.0);
            w->duration[l] = time_to_reversal(v < 0.0 ? -1.0 : 1.0, v, a[l], omega);
        }
        w->part[l] = w->sample[l] = 0;
        w->half[l] = !(v * panel->th[l] > 0.0); /* pushed outwards it first comes to rest there */
        w->released[l] = 1;
    }
}

/* The length of a lane's next panel: what the last point's swing tells, or else the half-swing before. */
static void choose_lengths(const Lockstep *s, Swing *w, int has_last) {
    for (int l = 0; l < WIDTH; l++) {
        const double last = s->durations[w->half[l]][l];
        if (w->part[l] == 0 && has_last && !w->released[l] && last > 0.0) w->duration[l] = last * s->last_omega[l] / s->values[0][l];
        const double h = PAST_REVERSAL * w->duration[l] / s->parts, least = LEAST_PART * s->half_swing / s->parts;
        w->panel.h[l] = w->part[l] < s->parts && h > least ? h : least;
    }
}

/* At the reversals of the fits chosen: the changes of the velocity, and the new direction; the fits that go on. */
static Which reverse_swings(Lockstep *s, Swing *w, Which turns, Each t, const Course *course, Each x, int has_last) {
    Each before = each(0.0), after;
    Which held, stuck;
    for (int j = LN; j > 0; j--) before = before * x + (double)j * course->v[j];
    before *= 2.0 / w->panel.h;
    const Each way = way_from_rest(&s->system, w->panel.th, t, s->system.direction, &after, &held, &stuck);
    for (int l = 0; l < WIDTH && !s->timed; l++)
        if (turns[l] && stuck[l]) {
            read_at_rest(s, w, l, has_last);
            held[l] = 0;
        }
    const Each ratio = after / before;
    for (int f = 0; f < s->free.n; f++)
        if (s->free.moves[f]) w->v[f] = choose(turns, w->v[f] * ratio, w->v[f]);
    w->panel.v = choose(turns, each(0.0), w->panel.v);
    s->system.direction = choose(turns, way, s->system.direction);
    return ~(turns & held);
}

/* One panel of each lane; the fits that go on. */
static Which advance_swings(Lockstep *s, Swing *w, Which which, int has_last) {
    const int n = s->free.n, np = s->batch->model->n_parameters;
    LockstepPanel *panel = &w->panel;
    Course course, by;
    Each changes[MOST_FREE][LN + 2], change[LN], x, angle_at_end[MOST_FREE], velocity_at_end[MOST_FREE];
    Which turns, lost;
    int at[WIDTH];
    find_kept(s, w, at);
    choose_lengths(s, w, has_last);
    if (has_last) guess_from_last(s, at, panel);
    else guess_harmonic(s, panel);
    Which good = solve_lockstep(&s->system, panel, which);
    lay_course(panel->h, panel->th, panel->v, panel->u, &course);
    x = reversal_of(w, &s->system, &course, &turns, &lost);
    good &= ~lost;
    keep_panel(s, at, good, panel);
    for (int f = 0; f < n; f++) {
        if (!s->free.moves[f]) continue;
        change_lockstep(panel, w->th[f], w->v[f], s->free.value[f] < np ? s->free.value[f] : -1, change);
        lay_course(panel->h, w->th[f], w->v[f], change, &by);
        for (int j = 0; j < LN + 2; j++) changes[f][j] = by.th[j];
        angle_at_end[f] = value_of(by.th, LN + 1, x);
        velocity_at_end[f] = value_of(by.v, LN, x);
    }
    const Each end = panel->t + 0.5 * panel->h * (x + 1.0);
    read_swings(s, w, good, &course, (const Each(*)[LN + 2])changes, end, has_last);
    for (int f = 0; f < n; f++)
        if (s->free.moves[f]) {
            w->th[f] = angle_at_end[f];
            w->v[f] = velocity_at_end[f];
        }
    panel->th = value_of(course.th, LN + 1, x);
    panel->v = value_of(course.v, LN, x);
    if (any(turns & good)) good &= reverse_swings(s, w, turns & good, end, &course, x, has_last);
    panel->t = end;
    for (int l = 0; l < WIDTH; l++) {
        w->part[l]++;
        if (!which[l]) continue;
        if (!turns[l]) continue;
        w->duration[l] = end[l] - w->since[l];
        s->durations[w->half[l]][l] = w->duration[l];
        w->since[l] = end[l];
        w->part[l] = 0;
        if (++w->half[l] >= s->n_half_swings) {
            w->half[l] = 0;
            good[l] = 0;
        }
        /* the first half-swing after a push is no measure of the next */
        if (w->released[l]) w->duration[l] = fmax(w->duration[l], PI / swing_frequency(s->values[0][l], panel->th[l], 0.0));
        w->released[l] = 0;
    }
    return good;
}

static Which evaluate_swings(Lockstep *s, Which which, int has_last) {
    Swing w;
    Which under_way = which, done = {0};
    start_swing(s, &w, &under_way);
    const Each omega = s->values[0];
    for (int k = 0; k < s->record.n_panels && any(under_way); k++) {
        under_way &= advance_swings(s, &w, under_way, has_last);
        for (int l = 0; l < WIDTH; l++)
            if (under_way[l] && w.sample[l] >= s->batch->n_samples) {
                under_way[l] = 0;
                done[l] = -1;
            }
    }
    s->last_omega = choose(which, omega, s->last_omega);
    if (has_last) done &= (Which)(s->squares < INFINITY); /* at the first point no series is looked at */
    return done;
}
