/* A collocation panel: the equations of motion at N Gauss-Legendre nodes, solved by Newton's iteration (Hairer, Norsett and
 * Wanner, Solving Ordinary Differential Equations I, 1993, section II.7).
 *
 * A panel is the time from a reversal to just past the next one (or a part of it). The acceleration on it, and the rate of
 * every collocated state, is a polynomial through the nodes that satisfies the equations of motion at each node; the signs
 * of the velocity and of every abs() in the model are frozen, so the right-hand side is smooth even past the reversal. The
 * inverse Jacobian is kept from panel to panel: successive half-swings are nearly alike, so four or five cheap sweeps do.
 * The same inverse gives the sensitivities exactly. */
#ifndef PANEL_H
#define PANEL_H
#include "states.h"

typedef struct {
    double h; /* length, s */
    PhasePoint from;
    double u[BLOCKS * N]; /* the unknowns at the nodes: a block for the acceleration, one for each collocated state's rate */
    double th[N], v[N], t[N], z[MAX_STATES * N];
    double remaining[MAX_STATES * N]; /* of a rate-independent state, of its value at the start */
    MotionCurve curve; /* its dense output */
    /* derivatives of every rate by angle, velocity, acceleration and states (a rate-independent one: by its value at the
     * start) at the nodes, by the angle at the panel's start, and by the parameters */
    double by[BLOCKS * (3 + MAX_STATES) * N], by_start[BLOCKS * N], by_parameter[BLOCKS * MAX_PARAMETERS * N];
    double lag_inverse[MAX_STATES][N * N];
    double inverse[BLOCKS * N * BLOCKS * N]; /* of the collocation equations, stored by column */
    int has_inverse;
} Panel;

static inline MotionPoints nodes_of(const Panel *panel) {
    return (MotionPoints){N, panel->th, panel->v, panel->u, panel->t, panel->z};
}

/* Solve the panel from the guess in panel->u; 0 where the iteration does not converge. */
static int solve_panel(const System *s, Panel *panel, TrajectoryReport *report);

/* The inverses that the slow lags take; 0 where there is none. */
static int invert_lags(const System *s, Panel *panel);

/* The derivatives at the nodes of the solved panel and the inverse of its equations; 0 where there is none. */
static int linearise(const System *s, Panel *panel);
static void partials_at_nodes(const System *s, Panel *panel);

static inline void apply_inverse(const Panel *panel, int blocks, const double *in, double *out) {
    if (blocks == 1) multiply(panel->inverse, in, out);
    else multiply_blocks(blocks, panel->inverse, in, out);
}

/* The size against which a block's errors count: of the acceleration, or of a thousandth of what it was at the largest
 * angle, for a swing that has died down is all rounding; of a state's rate, or of what would change the state by its own
 * size over the panel, for a state that has settled has no rate to speak of. */
static inline double size_of_block(const System *s, const Panel *panel, int block, const double *rates) {
    const double least = block ? largest(panel->z + (s->row[block] - 1) * N) / panel->h
                               : 1e-3 * s->p[0] * s->p[0] * s->largest_angle;
    return fmax(largest(rates), least) + 1e-12;
}
#endif
