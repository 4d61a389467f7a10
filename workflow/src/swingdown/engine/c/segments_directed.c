/* Segments of a motion that depends on the velocity's sign: panels from reversal to reversal (lockstep_swings.c). A segment's last
 * sample is where the next one starts; there its motion ends in the middle of a panel, and the sample counts for the next. */
#include "segments.h"

#define SPARE_SEGMENT_PANELS 1.5 /* for one where there would be none more */

/* Panels no longer than that: as many as there may be. */
static int share_directed(const Segments *s, double longest, const Seen *seen, LockstepRecord *record) {
    const double seconds = s->cut.each * s->cut.spacing;
    if (!(seconds / longest < 1e5)) return 0;
    const int parts = (int)ceil(seen->half_swing / longest), half_swings = (int)(SPARE_SEGMENT_PANELS * (seconds / seen->half_swing + 4.0));
    *record = (LockstepRecord){.n_panels = half_swings * PANELS_OF(parts), .h = longest};
    return 1;
}

static void set_half_swings(Segments *s, double longest, const Seen *seen) {
    for (int g = 0; g * WIDTH < s->count; g++) {
        s->group[g]->half_swing = seen->half_swing;
        s->group[g]->parts = (int)ceil(seen->half_swing / longest);
        s->group[g]->n_half_swings = s->group[g]->record.n_panels / PANELS_OF(s->group[g]->parts);
    }
}

/* Where a panel starts: time, angle and velocity, and their changes by the free values. */
typedef struct {
    Each t, th, v, th_by[MOST_FREE], v_by[MOST_FREE];
} PanelBegin;

static void keep_begin(const Swing *w, int n, PanelBegin *begin) {
    begin->t = w->panel.t;
    begin->th = w->panel.th;
    begin->v = w->panel.v;
    memcpy(begin->th_by, w->th, n * sizeof(Each));
    memcpy(begin->v_by, w->v, n * sizeof(Each));
}

/* Where the motion of the lanes chosen ends on the panel just followed, at the time `until` (s). */
static void end_on_panel(const Lockstep *s, const PanelBegin *begin, const LockstepPanel *panel, Each until, Which which, Each *end) {
    const int np = s->batch->model->n_parameters;
    Course course;
    Each change[LN];
    const Each x = 2.0 * (until - begin->t) / panel->h - 1.0;
    lay_course(panel->h, begin->th, begin->v, panel->u, &course);
    end[0] = choose(which, value_of(course.th, LN + 1, x), end[0]);
    end[1] = choose(which, value_of(course.v, LN, x), end[1]);
    for (int f = 0; f < s->free.n; f++) {
        Each *own = end + 2 + 2 * f;
        if (!s->free.moves[f]) {
            own[0] = own[1] = each(0.0);
            continue;
        }
        change_lockstep(panel, begin->th_by[f], begin->v_by[f], s->free.value[f] < np ? s->free.value[f] : -1, change);
        lay_course(panel->h, begin->th_by[f], begin->v_by[f], change, &course);
        own[0] = choose(which, value_of(course.th, LN + 1, x), own[0]);
        own[1] = choose(which, value_of(course.v, LN, x), own[1]);
    }
}

/* Take the samples at the ends of the lanes chosen off the sums again. */
static void leave_last_samples(Lockstep *s, const Each *end, Which which) {
    const int n = s->free.n, last = s->batch->n_samples - 1;
    Each angle = each(0.0), row[MOST_FREE];
    for (int l = 0; l < WIDTH; l++)
        if (which[l]) angle[l] = s->series_of[l][last];
    const Each residual = choose(which, s->gain * end[0] + s->zero - angle, each(0.0));
    for (int f = 0; f < n; f++) {
        row[f] = s->gain_by[f] * end[0] + s->zero_by[f];
        if (s->free.moves[f]) row[f] += s->gain * end[2 + 2 * f];
        row[f] = choose(which, row[f], each(0.0));
    }
    s->squares -= residual * residual;
    for (int f = 0; f < n; f++) {
        s->gradient[f] -= row[f] * residual;
        for (int g = 0; g <= f; g++) s->normal[f * n + g] -= row[f] * row[g];
    }
}

static int evaluate_directed(const Segments *all, int g, int has_last) {
    Lockstep *s = all->group[g];
    const int n_samples = s->batch->n_samples, lanes = all->count - g * WIDTH < WIDTH ? all->count - g * WIDTH : WIDTH;
    const Each until = each(s->batch->times[n_samples - 1] - s->batch->times[0]);
    Each *end = all->end[g];
    Swing w;
    PanelBegin begin;
    Which under_way = {0}, done = {0}, shared = {0};
    for (int l = 0; l < lanes; l++) under_way[l] = -1;
    for (int l = 0; l < lanes; l++) shared[l] = g * WIDTH + l < all->count - 1 ? -1 : 0;
    for (int l = 0; l < WIDTH; l++) set_sensors(s, l);
    start_swing(s, &w, &under_way);
    for (int k = 0; k < s->record.n_panels && any(under_way); k++) {
        keep_begin(&w, s->free.n, &begin);
        Which ends = {0};
        under_way &= advance_swings(s, &w, under_way, has_last);
        for (int l = 0; l < lanes; l++)
            if (under_way[l] && w.sample[l] >= n_samples) ends[l] = -1;
        if (!any(ends)) continue;
        end_on_panel(s, &begin, &w.panel, until, ends, end);
        done |= ends;
        under_way &= ~ends;
    }
    leave_last_samples(s, end, shared);
    s->last_omega = s->values[0];
    return all_of(done & (Which)(s->squares < INFINITY), lanes);
}
