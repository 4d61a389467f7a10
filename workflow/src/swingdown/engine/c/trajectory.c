/* The driver: from reversal to reversal, a panel each where the motion is smooth enough (panel.h). Where it is not, the panels
 * of a half-swing begin with the lengths, the motion and the inverses that did for those of the last one.
 *
 * Between the nodes the equations are checked where an effect may be too narrow for them (dense_output.h). The reversal is
 * the root of the velocity polynomial (events.h); the next panel starts there with the other sign, or the pendulum sticks:
 * then its panels have no acceleration until a torque frees it. Sensitivities go along (sensitivities.h), and the samples
 * are read from the dense output (record.h). */
#include "trajectory.h"

#include <stdlib.h>

#include "events.h"
#include "record.h"

#define OVERSHOOT 1.012 /* a panel reaches this far past the reversal that is expected */
#define MOST_PANELS 100 /* a half-swing, beyond the first thousand: more is no pendulum's motion */
#define PANELS_A_PIECE 20.0 /* of the input, beyond those of the swing */
#define ATTEMPTS 60     /* at a panel */
#define DRIVES 1e-4     /* of the acceleration: less drive by friction at rest is nothing that a swing would show */
#define ORDER 14.0      /* of the error in the panel's length */
#define PARTS 24        /* panels of a half-swing that are remembered */
#define ALIKE 0.1       /* of a panel's length: so nearly of one length are panels whose motions are alike */
#define SAFE 0.95       /* of the length that an error estimate allows */
#define TOO_ROUGH 3e-7  /* rad; estimated, of a rough trajectory: those that are off by a micro-radian are among those beyond */
#define FORGETS 1.03    /* of a length that was refused, each half-swing: swings die down */

/* A panel of the last half-swing, which the one that comes as late in the next is much like: its length, the longest that its
 * error estimate allows and the shortest that was refused (s), velocity, acceleration and unknowns, and the inverse of its
 * equations. */
typedef struct {
    double h, longest, refused, v, a, *u, *inverse;
    int has_inverse;
} Part;

typedef struct {
    System s;
    Panel panel;
    Sensitivities d;
    Record record;
    TrajectoryReport *report;
    PhasePoint here;
    double omega, omega_at_release; /* rad/s, of the present swing, and of an undamped one from the release */
    double last_reversal;           /* s, or -1 where the pendulum has stuck since */
    double expected;                /* s from the panel's start to the next reversal, by omega */
    double piece_ends;              /* s: until when the input is the same polynomial */
    double longest, refused;        /* panel that the last error estimates allow, and that they do not, s */
    Part parts[PARTS];              /* of this half-swing, and beyond where it is those of the last one */
    int in_parts;                   /* a half-swing may have many panels */
    int n_parts, part;              /* of the last half-swing; where this one is */
    double *memory;                 /* of the parts */
    double budget, budget_a_second; /* panels in advance, and for each second of the motion */
} Trajectory;

/* A broken power of the speed has no Taylor series where the speed is zero: panels get shorter and shorter up to every
 * reversal, the more so the smaller the exponent (60 tried a half-swing at 0.2). */
static double usual_panels(const Model *m) {
    for (int k = 0; k < m->n_motions; k++)
        if (EFFECTS[m->motions[k].row].fractional_power) return 20.0;
    return 5.0;
}

static int takes_many_panels(const Model *m) {
    for (int k = 0; k < m->n_motions; k++) {
        const Effect *e = &EFFECTS[m->motions[k].row];
        if (e->fractional_power || e->localised || e->n_switches || e->n_states) return 1;
    }
    return 0;
}

/* Pieces of the input, on each of which is a panel at least. */
static double pieces_a_second(const Model *m) {
    const Input *u = m->input;
    return u ? u->n_pieces / (u->knots[u->n_pieces] - u->knots[0]) : 0.0;
}

static inline double sign_of(double x) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0); }

static void start_at_release(Trajectory *r, const InitialValueProblem *problem) {
    System *s = &r->s;
    PhasePoint *here = &r->here;
    r->panel.has_inverse = 0;
    s->coarseness = problem->coarseness;
    r->d.n = r->record.free.n_free;
    r->d.by = r->record.free.free_values;
    *here = (PhasePoint){r->record.times[0], problem->release_angle, problem->release_velocity, {0.0}};
    set_release(s, here, &r->d);
    s->direction = sign_of(here->v);
    if (s->n_switches) freeze_signs(s, here);
    r->record.play.parameter = problem->model->play;
    r->record.play.reading = here->th;
    for (int f = 0; f < r->d.n; f++) r->record.play.slope[f] = r->d.th[f];
    r->omega = r->omega_at_release = swing_frequency(s->p[0], here->th, here->v);
    s->largest_angle = hypot(here->th, here->v / r->omega);
    r->last_reversal = -1.0;
    r->longest = INFINITY;
    r->n_parts = r->part = 0;
    r->budget = isfinite(problem->most_panels) ? 50.0 : 1000.0;
    r->budget_a_second = fmin(problem->most_panels, MOST_PANELS * r->omega / PI) + PANELS_A_PIECE * pieces_a_second(problem->model);
}

/* The rates jump at a reversal, which for a change of a free value comes later by -dv/a; none moves a pendulum that sticks. */
static void reverse_sensitivities(Trajectory *r, int way) {
    double before[BLOCKS], after[BLOCKS], later[MAX_PARAMETERS];
    System *s = &r->s;
    const int was_stuck = s->stuck;
    rates_at(s, &r->here, s->direction, before);
    s->stuck = way == 0;
    rates_at(s, &r->here, way ? way : s->direction, after);
    for (int f = 0; f < r->d.n; f++) later[f] = before[0] != 0.0 ? -r->d.v[f] / before[0] : 0.0;
    if (!was_stuck) saltate(&r->d, s->model->n_states, before, after, later);
    for (int f = 0; f < r->d.n && s->stuck; f++) r->d.v[f] = 0.0;
}

/* Held from the release on: no small push moves it. The states' equations need a direction, though nothing moves. */
static void hold_at_release(Trajectory *r) {
    r->s.direction = 1.0;
    for (int f = 0; f < r->d.n; f++) r->d.v[f] = 0.0;
}

/* At rest: turn round, or stick; the status. */
static int leave_or_stick(Trajectory *r) {
    System *s = &r->s;
    const int was_stuck = s->stuck;
    const Freed freed = freed_at(s, &r->here);
    if (freed.up > 0.0 && freed.down < 0.0) return NOT_UNIQUE;
    const int way = leaves_rest(&freed, was_stuck ? 0.0 : s->direction);
    r->report->driven |= freed.up - freed.down > DRIVES * (fabs(freed.up) + fabs(freed.down));
    if (r->d.n && s->direction != 0.0) reverse_sensitivities(r, way);
    s->stuck = way == 0;
    if (!s->stuck) {
        s->direction = way;
        return DONE;
    }
    if (s->direction == 0.0) hold_at_release(r);
    if (!was_stuck) r->report->stuck_after = r->here.t + r->record.problem->times[0];
    r->last_reversal = -1.0;
    return DONE;
}

/* ---- Panels like those of the last half-swing ----
 *
 * Where a half-swing has no more than a panel or two, what is remembered is the last panel, if it began at rest. */

static int is_known(const Trajectory *r) { return r->part < r->n_parts && !r->s.stuck; }

/* The panel that the next one is like, were it as long; or NULL. */
static const Part *part_alike(const Trajectory *r, double h) {
    const Part *part = &r->parts[r->part];
    return is_known(r) && fabs(h - part->h) < ALIKE * h && (part->v == 0.0) == (r->here.v == 0.0) ? part : NULL;
}

/* Its motion, larger or smaller, and its inverse, to begin with. */
static void begin_from(Trajectory *r, const Part *part, double acceleration) {
    const size_t size = (size_t)r->s.blocks * N;
    const double omega = r->omega * r->omega, v = r->here.v;
    const double ratio = v == 0.0 ? acceleration / part->a
                                  : (acceleration * part->a + omega * v * part->v) / (part->a * part->a + omega * part->v * part->v);
    for (size_t i = 0; i < size; i++) r->panel.u[i] = ratio * part->u[i];
    if (!r->in_parts) return; /* the inverse is still there */
    r->panel.has_inverse = part->has_inverse;
    if (part->has_inverse) memcpy(r->panel.inverse, part->inverse, size * size * sizeof(double));
}

/* Remember the panel just followed. */
static void remember(Trajectory *r, double acceleration) {
    const size_t size = (size_t)r->s.blocks * N;
    const Panel *panel = &r->panel;
    if (!r->in_parts) r->n_parts = panel->from.v == 0.0 && !r->s.stuck;
    if (r->part >= PARTS || r->s.stuck) return;
    Part *part = &r->parts[r->part];
    part->h = panel->h;
    part->longest = r->longest;
    part->refused = r->in_parts ? r->refused : INFINITY;
    part->v = panel->from.v;
    part->a = acceleration;
    part->has_inverse = panel->has_inverse;
    memcpy(part->u, panel->u, size * sizeof(double));
    if (!r->in_parts) return;
    if (panel->has_inverse) memcpy(part->inverse, panel->inverse, size * size * sizeof(double));
    r->part++;
}

/* Room for the parts; 0 where there is none. */
static int open_parts(Trajectory *r) {
    const size_t size = (size_t)r->s.blocks * N, squared = r->in_parts ? size * size : 0;
    const int n = r->in_parts ? PARTS : 1;
    double *room = r->memory = malloc(n * (size + squared) * sizeof(double));
    for (int k = 0; k < n && room; k++) {
        r->parts[k].u = room;
        r->parts[k].inverse = room + size;
        room += size + squared;
    }
    return room != NULL;
}

/* ---- Panels ---- */

/* A first guess of the unknowns, where no panel was alike: a harmonic. */
static void guess_unknowns(Trajectory *r, const double *start) {
    const System *s = &r->s;
    Panel *panel = &r->panel;
    const double omega = r->omega;
    for (int i = 0; i < N; i++) {
        const double phase = omega * panel->h * T_nodes[i];
        panel->u[i] = s->stuck ? 0.0 : start[0] * cos(phase) - omega * r->here.v * sin(phase);
    }
    for (int i = N; i < s->blocks * N; i++) panel->u[i] = start[s->row[i / N]];
    panel->has_inverse = 0;
}

/* How much shorter the panel is to be tried again; 0 where it is solved to the accuracy. */
static double attempt_panel(Trajectory *r, double *ratio) {
    System *s = &r->s;
    Panel *panel = &r->panel;
    if (!solve_panel(s, panel, r->report) || !invert_lags(s, panel)) return 0.5;
    lay_dense_output(s, panel);
    *ratio = s->stuck ? fmax(error_ratio(s, panel, r->omega), hold_ratio(s, panel)) : error_ratio(s, panel, r->omega);
    return *ratio <= 1.0 ? 0.0 : fmin(0.7, fmax(0.2, 0.8 * pow(*ratio, -1.0 / ORDER)));
}

/* The length (s) to try first: up to just past the reversal that is expected, or a whole part of that. */
static double first_length(Trajectory *r, double acceleration) {
    r->expected = r->s.stuck ? 3.0 / r->omega : time_to_reversal(r->s.direction, r->here.v, acceleration, r->omega);
    const double left = r->s.stuck ? r->expected : r->expected * OVERSHOOT;
    const double h = fmin(left / fmax(1.0, ceil(left / r->longest)), r->piece_ends - r->here.t);
    return h > 1e-12 ? h : 1e-12;
}

/* The next panel, as long as the accuracy allows; its error ratio, or -1 where there is none. start: the rates there. */
static double next_panel(Trajectory *r, const double *start) {
    double ratio = 0.0;
    Panel *panel = &r->panel;
    r->refused = INFINITY;
    if (is_known(r)) {
        r->refused = FORGETS * r->parts[r->part].refused;
        r->longest = fmin(r->parts[r->part].longest, r->refused);
    }
    double h = first_length(r, start[0]);
    const Part *alike = part_alike(r, h);
    panel->from = r->here;
    for (int attempt = 0; attempt < ATTEMPTS; attempt++) {
        panel->h = h;
        if (alike) begin_from(r, alike, start[0]);
        else guess_unknowns(r, start);
        ratio = 0.0;
        const double shorter = attempt_panel(r, &ratio);
        if (shorter == 0.0) {
            /* a short last panel says little about how long the next one may be */
            const double allowed = h * SAFE * pow(fmax(ratio, 1e-12), -1.0 / ORDER);
            if (ratio > 0.05 || allowed > r->longest) r->longest = allowed;
            r->report->panels++;
            return ratio;
        }
        r->refused = ratio > 1.0 ? h * SAFE * pow(ratio, -1.0 / ORDER) : h * shorter;
        h *= shorter;
        r->longest = h;
        r->report->rejected++;
        alike = NULL;
    }
    return -1.0;
}

/* A reversal that was expected did not come. After a shake that turned the pendulum round for a moment, its frequency says
 * nothing of the swing that follows. */
static void expect_later(Trajectory *r) {
    if (r->panel.h >= r->expected && r->omega > 2.0 * r->omega_at_release) r->omega *= 0.5;
}

static void reverse(Trajectory *r) {
    r->here.v = 0.0;
    if (r->s.stuck) return;
    if (r->d.n) come_to_rest(&r->s, &r->here, &r->d);
    r->report->reversals++;
    if (r->last_reversal >= 0.0) r->omega = PI / (r->here.t - r->last_reversal);
    r->last_reversal = r->here.t;
    if (!r->in_parts) return;
    r->n_parts = r->part;
    r->part = 0;
}

/* The status at the end of a panel. */
static int check(const Trajectory *r) {
    const double spent = r->report->panels + r->report->rejected;
    for (int k = 0; k < r->s.model->n_states; k++)
        if (!isfinite(r->here.z[k])) return RAN_AWAY;
    if (!(fabs(r->here.th) < 1e4) || !(fabs(r->here.v) < 1e8)) return RAN_AWAY;
    return spent > r->budget + r->budget_a_second * (r->here.t - r->record.times[0]) ? LOST_ACCURACY : DONE;
}

/* From here to the next event, or to the end of a panel before it; the status. */
static int advance(Trajectory *r) {
    System *s = &r->s;
    Panel *panel = &r->panel;
    s->largest_angle = fmax(s->largest_angle, fabs(r->here.th));
    r->piece_ends = choose_piece(s, r->here.t);
    if (r->here.v == 0.0 && leave_or_stick(r) == NOT_UNIQUE) return NOT_UNIQUE;
    if (s->stuck && !s->timed && !s->model->n_states) { /* nothing changes any more */
        read_rest(&r->record, r->here.th, r->d.th);
        return DONE;
    }
    if (s->model->n_states) set_linear_states(s);
    double start[BLOCKS];
    rates_at(s, &r->here, s->direction, start);
    const double ratio = next_panel(r, start), h = panel->h;
    if (ratio < 0.0) return LOST_ACCURACY;
    const Event event = first_event(s, panel);
    const double x_end = fmin(event.position, 1.0);
    const double t_end = r->here.t + (event.position <= 1.0 ? 0.5 * h * (event.position + 1.0) : h);
    r->report->error += ratio * s->coarseness * TRUNCATION * largest(panel->u) * h * h / (64.0 * N * N);
    if (r->d.n) {
        if (!linearise(s, panel)) return LOST_ACCURACY;
        propagate(s, panel, &r->d, x_end);
    }
    remember(r, start[0]);
    read_panel(&r->record, s, panel, &r->d, t_end);
    r->here = point_at(s, panel, x_end);
    r->here.t = t_end;
    if (r->d.n) move_to(s, panel, &r->d, x_end);
    push_play_on(&r->record, r->here.th, r->d.th);
    if (event.position <= 1.0) {
        if (event.kind == REVERSAL) reverse(r);
        else if (event.kind >= 0) cross_switch(s, &r->here, event.kind, &r->d);
    } else expect_later(r);
    return check(r);
}

/* By how much a change of the release angle has grown at most; 1 where that is not among the slopes. */
static double growth(const InitialValueProblem *problem, const double *slopes) {
    double most = 1.0;
    for (int f = 0; f < problem->n_free; f++) {
        if (problem->free_values[f] != RELEASE_ANGLE) continue;
        for (int i = 0; i < problem->n_times; i++) most = fmax(most, fabs(slopes[(size_t)f * problem->n_times + i]));
    }
    return most;
}

static int follow(const InitialValueProblem *problem, double *angles, double *slopes, TrajectoryReport *report) {
    Trajectory r;
    *report = (TrajectoryReport){.stuck_after = -1.0};
    r.report = report;
    if (!set_up_system(&r.s, problem->model, problem->parameters, slopes ? problem->n_free : 0))
        return report->status = TOO_LARGE;
    report->status = open_record(&r.record, problem, angles, slopes);
    if (report->status == NO_MEMORY) return NO_MEMORY;
    r.in_parts = takes_many_panels(problem->model) && !problem->model->input;
    if (!open_parts(&r)) report->status = NO_MEMORY;
    start_at_release(&r, problem);
    while (r.record.next < problem->n_times && report->status == DONE) report->status = advance(&r);
    report->largest_angle = r.s.largest_angle;
    finish_record(&r.record, report->status);
    close_record(&r.record);
    free(r.memory);
    return report->status;
}

int swing_trajectory(const InitialValueProblem *problem, double *angles, double *slopes, TrajectoryReport *report) {
    const int status = follow(problem, angles, slopes, report);
    if (status != DONE || !slopes || problem->coarseness <= 1.0 || report->error * growth(problem, slopes) < TOO_ROUGH) return status;
    InitialValueProblem exact = *problem;
    exact.coarseness = 1.0;
    const int panels = report->panels, rejected = report->rejected, evaluations = report->evaluations;
    follow(&exact, angles, slopes, report);
    report->anew = 1;
    report->panels += panels;
    report->rejected += rejected;
    report->evaluations += evaluations;
    return report->status;
}
