/* Segments of a smooth motion: panels that stand still in time, of whole numbers of samples (lockstep_point.c). */
#include <stdlib.h>

#include "segments.h"

/* Panels of whole numbers of samples, none longer than that; the samples that are left are one more. */
static int share_smooth(Segments *s, double longest, LockstepRecord *record) {
    const int whole = (int)(longest / s->cut.spacing);
    if (whole < 1) return 0;
    s->n_panels = (s->cut.each + whole - 1) / whole;
    const int few = s->cut.each / s->n_panels, kinds = 3;
    s->longer = s->cut.each % s->n_panels;
    s->h[0] = (few + 1) * s->cut.spacing;
    s->h[1] = few * s->cut.spacing;
    *record = (LockstepRecord){.n_panels = s->n_panels + (s->cut.left > 0)};
    record->panels = malloc(record->n_panels * sizeof(PanelSamples));
    record->bases = malloc(kinds * sizeof(SampleBasis));
    const int sizes[] = {few + 1, few, s->cut.left};
    const size_t samples = 2 * (size_t)few + 1 + s->cut.left;
    record->memory = malloc((samples * (BASIS_ROW + TERMS) + few + 1 + SEGMENTS) * sizeof(double));
    if (!record->panels || !record->bases || !record->memory) return 0;
    double *room = record->memory, *positions = room + samples * (BASIS_ROW + TERMS);
    for (int kind = 0; kind < kinds; kind++) {
        SampleBasis *basis = &record->bases[kind];
        basis->n_samples = sizes[kind];
        basis->by_sample = room;
        basis->by_column = room + (size_t)sizes[kind] * BASIS_ROW;
        room += (size_t)sizes[kind] * (BASIS_ROW + TERMS);
        if (!sizes[kind] || (kind == 0 && !s->longer)) continue;
        for (int i = 0; i < sizes[kind]; i++) positions[i] = 2.0 * i / sizes[kind] - 1.0;
        set_up_basis(basis, positions);
    }
    for (int k = 0, next = 0; k < record->n_panels; k++) {
        const int kind = k == s->n_panels ? 2 : k >= s->longer;
        record->panels[k] = (PanelSamples){next, &record->bases[kind]};
        next += sizes[kind];
    }
    return 1;
}

/* The samples behind the last segment, which count for that one alone. */
static Which read_left(Lockstep *s, int is_last, int k, LockstepPanel *panel, Each *th, Each *v, Which which) {
    const int n = s->free.n;
    const Each squares = s->squares;
    Each gradient[MOST_FREE], normal[MOST_FREE * MOST_FREE];
    Which last = {0};
    last[WIDTH - 1] = is_last ? -1 : 0;
    memcpy(gradient, s->gradient, n * sizeof(Each));
    memcpy(normal, s->normal, (size_t)n * n * sizeof(Each));
    const Which good = solve_lockstep(&s->system, panel, which & last);
    follow_panel(s, k, panel, th, v);
    read_lockstep(s, s->record.panels[k].basis, s->angles);
    add_lockstep_normal(s, k);
    s->squares = choose(last, s->squares, squares);
    for (int f = 0; f < n; f++) {
        s->gradient[f] = choose(last, s->gradient[f], gradient[f]);
        for (int g = 0; g <= f; g++) s->normal[f * n + g] = choose(last, s->normal[f * n + g], normal[f * n + g]);
    }
    return which & (good | ~last);
}

/* Sums of squares and slopes of a group at its values, and where its segments end; 0 where one cannot be computed. */
static int evaluate_smooth(const Segments *all, int g, int has_last) {
    Lockstep *s = all->group[g];
    LockstepPanel panel;
    Each th[MOST_FREE], v[MOST_FREE], step[MOST_FREE], *end = all->end[g];
    Which which = (Which)(each(0.0) == each(0.0));
    const int n = s->free.n;
    for (int l = 0; l < WIDTH; l++) set_sensors(s, l);
    start_lockstep(s, &panel, th, v);
    panel.t = each(0.0); /* nothing depends on it */
    for (int f = 0; f < n; f++) {
        const Each x = s->values[s->free.value[f]];
        step[f] = x - s->last.x[f];
        s->last.x[f] = x;
    }
    for (int k = 0; k < all->n_panels; k++) {
        panel.h = each(all->h[k >= all->longer]);
        guess_lockstep(s, k, has_last, step, &panel);
        which &= solve_lockstep(&s->system, &panel, which);
        follow_panel(s, k, &panel, th, v);
        read_lockstep(s, s->record.panels[k].basis, s->angles);
        add_lockstep_normal(s, k);
    }
    end[0] = panel.th;
    end[1] = panel.v;
    for (int f = 0; f < n; f++) {
        end[2 + 2 * f] = th[f];
        end[3 + 2 * f] = v[f];
    }
    if (all->cut.left) {
        panel.h = each(all->cut.left * all->cut.spacing);
        guess_lockstep(s, all->n_panels, has_last, step, &panel);
        which = read_left(s, g == GROUPS - 1, all->n_panels, &panel, th, v, which);
    }
    which &= (Which)(s->squares < INFINITY);
    return all_of(which, WIDTH);
}
