#include "lockstep.h"

/* ---- Sensors ---- */

/* One sensor more. */
static void add_sensor(const Lockstep *s, const double *p, PlacedEffect at, Affine *all) {
    const Model *m = s->batch->model;
    const Effect *e = &EFFECTS[at.row];
    const double th[2] = {0.0, 1.0}, sn[2] = {0.0, sine(1.0)}, cs[2] = {1.0, cosine(1.0)}, zero[2] = {0.0};
    double read[2] = {0.0}, by[6] = {0.0}, by_parameter[MAX_PARAMETERS * 2] = {0.0};
    const Points q = {2, 2, th, zero, zero, zero, sn, cs, zero, p[0], m->duration, 1.0, NULL};
    const Partials d = {by, by_parameter, 3, m->n_parameters, 2};
    e->reading(&q, p + at.first_parameter, NULL, read, at);
    e->reading_partials(&q, p + at.first_parameter, NULL, &d, at);
    for (int f = 0; f < s->free.n; f++) {
        const double *own = by_parameter + 2 * s->free.value[f];
        const int is_parameter = s->free.value[f] < m->n_parameters;
        all->zero_by[f] = by[0] * all->zero_by[f] + (is_parameter ? own[0] + (own[1] - own[0]) * all->zero : 0.0);
        all->gain_by[f] = by[0] * all->gain_by[f] + (is_parameter ? (own[1] - own[0]) * all->gain : 0.0);
    }
    all->zero = by[0] * all->zero + read[0];
    all->gain *= by[0];
}

static void set_sensors(Lockstep *s, int lane) {
    const Model *m = s->batch->model;
    Affine all = {.gain = 1.0};
    double p[MAX_PARAMETERS];
    for (int i = 0; i < m->n_parameters; i++) p[i] = s->values[i][lane];
    for (int k = 0; k < m->n_sensors; k++) add_sensor(s, p, m->sensors[k], &all);
    s->gain[lane] = all.gain;
    s->zero[lane] = all.zero;
    for (int f = 0; f < s->free.n; f++) {
        s->gain_by[f][lane] = all.gain_by[f];
        s->zero_by[f][lane] = all.zero_by[f];
    }
}

/* ---- A point of each fit ---- */

/* The coordinates of a panel's angle, or its change, from where it starts and the accelerations. */
static void angle_coordinates(const SampleBasis *p, Each h, Each th, Each v, const Each *u, Each *out) {
    Each terms[TERMS];
    terms[0] = th;
    terms[1] = h * v;
    UNROLL
    for (int j = 0; j < LN; j++) terms[2 + j] = h * h * u[j];
    if (p->triangular) {
        UNROLL
        for (int r = 0; r < TERMS; r++) {
            Each sum = each(0.0);
            UNROLL
            for (int c = r; c < TERMS; c++) sum += p->matrix[r * TERMS + c] * terms[c];
            out[r] = sum;
        }
    } else
        for (int r = 0; r < TERMS; r++) {
            out[r] = each(0.0);
            for (int c = 0; c < TERMS; c++) out[r] += p->matrix[r * TERMS + c] * terms[c];
        }
}

/* The angles and slopes of a panel become what the sensors read. */
static void read_lockstep(const Lockstep *s, const SampleBasis *p, Each *angles) {
    for (int f = 0; f < s->free.n; f++) {
        Each *slope = angles + (1 + f) * TERMS;
        UNROLL
        for (int r = 0; r < TERMS; r++) {
            const Each own = s->gain_by[f] * angles[r] + s->zero_by[f] * p->matrix[r * TERMS];
            slope[r] = own + (s->free.moves[f] ? s->gain : each(0.0)) * slope[r];
        }
    }
    UNROLL
    for (int r = 0; r < TERMS; r++) angles[r] = s->gain * angles[r] + s->zero * p->matrix[r * TERMS];
}

/* Add a panel's part to the sum of squares, J'r and J'J. */
static void add_lockstep_normal(Lockstep *s, int k) {
    Each residual[TERMS], from_reference[TERMS], squares = s->squares, off = s->off;
    const Each *data = s->data + k * TERMS;
    const double *reference = s->reference ? s->reference + k * TERMS : NULL;
    const int n = s->free.n;
    UNROLL
    for (int r = 0; r < TERMS; r++) {
        residual[r] = s->angles[r] - data[r];
        squares += residual[r] * residual[r];
        from_reference[r] = s->angles[r] - each(reference ? reference[r] : 0.0);
        off += from_reference[r] * from_reference[r];
    }
    s->squares = squares;
    s->off = off;
    for (int f = 0; f < n; f++) {
        Each one[TERMS], sum = each(0.0);
        UNROLL
        for (int r = 0; r < TERMS; r++) one[r] = s->angles[(1 + f) * TERMS + r];
        UNROLL
        for (int r = 0; r < TERMS; r++) sum += one[r] * residual[r];
        s->gradient[f] += sum;
        sum = each(0.0);
        UNROLL
        for (int r = 0; r < TERMS; r++) sum += one[r] * from_reference[r];
        s->off_gradient[f] += sum;
        for (int g = 0; g <= f; g++) {
            const Each *other = s->angles + (1 + g) * TERMS;
            Each product[2] = {each(0.0), each(0.0)};
            UNROLL
            for (int r = 0; r < TERMS; r++) product[r % 2] += one[r] * other[r];
            s->normal[f * n + g] += product[0] + product[1];
        }
    }
}

static void guess_harmonic(const Lockstep *s, LockstepPanel *panel) {
    const Each omega = s->system.p[0];
    UNROLL
    for (int i = 0; i < LN; i++) {
        const Each phase = omega * panel->h * LOCKSTEP_nodes[i];
        panel->u[i] = -omega * (omega * sines(panel->th) * cosines(phase) + panel->v * sines(phase));
    }
}

/* What the last solution foretells of a panel's accelerations; or, where there is none, a harmonic. */
static void guess_lockstep(const Lockstep *s, int k, int has_last, const Each *step, LockstepPanel *panel) {
    const int n = s->free.n;
    if (!has_last) {
        guess_harmonic(s, panel);
        return;
    }
    const Each *u = s->last.u + k * LN, *changes = s->last.changes + (size_t)k * n * LN;
    UNROLL
    for (int i = 0; i < LN; i++) panel->u[i] = u[i];
    for (int f = 0; f < n; f++)
        if (s->free.moves[f])
            UNROLL
            for (int i = 0; i < LN; i++) panel->u[i] += changes[f * LN + i] * step[f];
}

/* Where the panels of the motion and its changes start. */
static void start_lockstep(Lockstep *s, LockstepPanel *panel, Each *th, Each *v) {
    const int np = s->batch->model->n_parameters;
    panel->h = each(s->record.h);
    panel->th = s->values[np];
    panel->v = s->values[np + 1];
    for (int i = 0; i < np; i++) s->system.p[i] = s->values[i];
    const Each angle = size_of(panel->th) + size_of(panel->v / s->system.p[0]);
    s->system.least = 1e-3 * s->system.p[0] * s->system.p[0] * angle + 1e-12;
    s->squares = s->missed;
    s->off = each(s->reference_missed);
    for (int f = 0; f < s->free.n; f++) {
        th[f] = each(s->free.value[f] == np);
        v[f] = each(s->free.value[f] == np + 1);
        s->gradient[f] = s->off_gradient[f] = each(0.0);
        for (int g = 0; g <= f; g++) s->normal[f * s->free.n + g] = each(0.0);
    }
}

/* The angles of a panel, its slopes and the solution, for the solved panel; on to the next. */
static void follow_panel(Lockstep *s, int k, LockstepPanel *panel, Each *th, Each *v) {
    const int n = s->free.n, np = s->batch->model->n_parameters;
    const SampleBasis *samples = s->record.panels[k].basis;
    angle_coordinates(samples, panel->h, panel->th, panel->v, panel->u, s->angles);
    UNROLL
    for (int i = 0; i < LN; i++) s->last.u[k * LN + i] = panel->u[i];
    for (int f = 0; f < n; f++) {
        Each *change = s->last.changes + ((size_t)k * n + f) * LN;
        if (!s->free.moves[f]) continue;
        change_lockstep(panel, th[f], v[f], s->free.value[f] < np ? s->free.value[f] : -1, change);
        angle_coordinates(samples, panel->h, th[f], v[f], change, s->angles + (1 + f) * TERMS);
        end_lockstep(panel, change, &th[f], &v[f]);
    }
    end_lockstep(panel, panel->u, &panel->th, &panel->v);
}

static Which evaluate_lockstep(Lockstep *s, Which which, int has_last) {
    LockstepPanel panel;
    Each th[MOST_FREE], v[MOST_FREE], step[MOST_FREE];
    start_lockstep(s, &panel, th, v);
    for (int f = 0; f < s->free.n; f++) {
        const Each x = s->values[s->free.value[f]];
        step[f] = x - s->last.x[f];
        s->last.x[f] = x;
    }
    for (int k = 0; k < s->record.n_panels && any(which); k++) {
        panel.t = each(k * s->record.h);
        guess_lockstep(s, k, has_last, step, &panel);
        which &= solve_lockstep(&s->system, &panel, which);
        follow_panel(s, k, &panel, th, v);
        read_lockstep(s, s->record.panels[k].basis, s->angles);
        if (has_last) add_lockstep_normal(s, k);
        else
            UNROLL
            for (int r = 0; r < TERMS; r++) {
                s->first_angles[k * TERMS + r] = s->angles[r][0];
                for (int f = 0; f < s->free.n; f++)
                    s->first_slopes[((size_t)f * s->record.n_panels + k) * TERMS + r] = s->angles[(1 + f) * TERMS + r][0];
            }
    }
    return which & (Which)(s->squares < INFINITY);
}
