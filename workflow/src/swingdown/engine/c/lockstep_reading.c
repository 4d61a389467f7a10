#include "lockstep_swings.h"

/* Powers of a position, for values of several polynomials there. */
typedef struct {
    Each x, x2, x4, x8;
} Powers;

/* The value of an angle's polynomial: its parts side by side, as the processor takes them (Estrin's scheme). */
static inline __attribute__((always_inline)) Each angle_at(const Each *c, const Powers *p) {
    Each part[(LN + 4) / 4 * 2];
    UNROLL
    for (int k = 0; k < (LN + 4) / 4 * 2; k++) {
        part[k] = 2 * k < LN + 2 ? c[2 * k] : each(0.0);
        if (2 * k + 1 < LN + 2) part[k] += c[2 * k + 1] * p->x;
    }
    return ((part[0] + part[1] * p->x2) + (part[2] + part[3] * p->x2) * p->x4) + part[4] * p->x8;
}

/* Of each lane, how many of its next samples are on its panel. */
static Which count_samples(const Lockstep *s, const Swing *w, Which which, Each end, int *most) {
    const int n = s->batch->n_samples;
    const double *times = s->batch->times;
    Which count = {0};
    *most = 0;
    for (int l = 0; l < WIDTH; l++) {
        if (!which[l]) continue;
        int next = w->sample[l];
        while (next < n && times[next] - times[0] <= end[l]) next++;
        count[l] = next - w->sample[l];
        if (count[l] > *most) *most = (int)count[l];
    }
    return count;
}

/* The i-th next sample's time in each lane; the series' angle there, and the reference's. */
static inline void read_samples(const Lockstep *s, const Swing *w, int i, Each *t, Each *angle, Each *reference) {
    const int last = s->batch->n_samples - 1;
    for (int l = 0; l < WIDTH; l++) {
        const int at = w->sample[l] + i < last ? w->sample[l] + i : last;
        (*t)[l] = s->batch->times[at] - s->batch->times[0];
        (*angle)[l] = s->series_of[l][at];
        (*reference)[l] = s->reference_of[at];
    }
}

static void read_swings(Lockstep *s, Swing *w, Which which, const Course *course, const Each (*changes)[LN + 2], Each end, int has_last) {
    const int n = s->free.n, n_samples = s->batch->n_samples;
    const Each per_second = 2.0 / w->panel.h;
    Each row[MOST_FREE], gradient[MOST_FREE], off_gradient[MOST_FREE], squares = s->squares, off = s->off;
    for (int f = 0; f < n; f++) {
        gradient[f] = s->gradient[f];
        off_gradient[f] = s->off_gradient[f];
    }
    int most;
    const Which count = count_samples(s, w, which, end, &most);
    for (int i = 0; i < most; i++) {
        Each t, angle, reference;
        read_samples(s, w, i, &t, &angle, &reference);
        const Which there = (Which){0} + i < count;
        const Each x = (t - w->panel.t) * per_second - 1.0, x2 = x * x, x4 = x2 * x2;
        const Powers powers = {x, x2, x4, x4 * x4};
        const Each th = angle_at(course->th, &powers);
        const Each read = s->gain * th + s->zero, residual = choose(there, read - angle, each(0.0));
        for (int f = 0; f < n; f++) {
            Each own = s->gain_by[f] * th + s->zero_by[f];
            if (s->free.moves[f]) own += s->gain * angle_at(changes[f], &powers);
            row[f] = choose(there, own, each(0.0));
        }
        squares += residual * residual;
        const Each from_reference = choose(there, read - reference, each(0.0));
        off += from_reference * from_reference;
        for (int f = 0; f < n; f++) {
            gradient[f] += row[f] * residual;
            off_gradient[f] += row[f] * from_reference;
            Each *normal = s->normal + f * n;
            for (int g = 0; g <= f; g++) normal[g] += row[f] * row[g];
        }
        if (has_last || !there[0]) continue;
        s->first_angles[w->sample[0] + i] = read[0];
        for (int f = 0; f < n; f++) s->first_slopes[(size_t)f * n_samples + w->sample[0] + i] = row[f][0];
    }
    s->squares = squares;
    s->off = off;
    for (int f = 0; f < n; f++) {
        s->gradient[f] = gradient[f];
        s->off_gradient[f] = off_gradient[f];
    }
    for (int l = 0; l < WIDTH; l++) w->sample[l] += (int)count[l];
}

/* The sum of (read - series), and into `squares` that of its squares, over samples that all read the same. */
static double sum_at_rest(double read, const double *series, int n, double *squares) {
    double part[8] = {0.0}, square[8] = {0.0};
    int i = 0;
    for (; i + 8 <= n; i += 8)
        for (int j = 0; j < 8; j++) {
            const double residual = read - series[i + j];
            part[j] += residual;
            square[j] += residual * residual;
        }
    for (int j = 0; i < n; i++, j++) {
        part[j] += read - series[i];
        square[j] += (read - series[i]) * (read - series[i]);
    }
    *squares = ((square[0] + square[1]) + (square[2] + square[3])) + ((square[4] + square[5]) + (square[6] + square[7]));
    return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
}

static void read_at_rest(Lockstep *s, Swing *w, int l, int has_last) {
    const int n = s->free.n, first = w->sample[l], left = s->batch->n_samples - first;
    const double th = w->panel.th[l], read = s->gain[l] * th + s->zero[l];
    double row[MOST_FREE], squares = 0.0;
    for (int f = 0; f < n; f++)
        row[f] = s->gain_by[f][l] * th + s->zero_by[f][l] + (s->free.moves[f] ? s->gain[l] * w->th[f][l] : 0.0);
    const double residual = sum_at_rest(read, s->series_of[l] + first, left, &squares);
    s->squares[l] += squares;
    for (int f = 0; f < n; f++) {
        s->gradient[f][l] += row[f] * residual;
        for (int g = 0; g <= f; g++) s->normal[f * n + g][l] += left * row[f] * row[g];
    }
    if (s->reference) {
        const double from_reference = sum_at_rest(read, s->reference + first, left, &squares);
        s->off[l] += squares;
        for (int f = 0; f < n; f++) s->off_gradient[f][l] += row[f] * from_reference;
    }
    for (int i = first; i < s->batch->n_samples && !has_last && l == 0; i++) {
        s->first_angles[i] = read;
        for (int f = 0; f < n; f++) s->first_slopes[(size_t)f * s->batch->n_samples + i] = row[f];
    }
    w->sample[l] = s->batch->n_samples;
}
