/* The motion between the nodes of a solved panel, and how far it can be trusted. */
#ifndef DENSE_OUTPUT_H
#define DENSE_OUTPUT_H
#include "panel.h"

/* Where a panel's motion, or its change by a free value, starts; and of lags what drives them, with the angle at the nodes. */
typedef struct {
    double th, v;
    const double *z, *input, *th_nodes;
} PanelStart;

/* Angle, velocity and states from the unknowns u, for the motion or its change by a free value. */
static void integrate_unknowns(const System *s, const Panel *panel, const double *u, const PanelStart *start, MotionCurve *out);

/* The dense output of the solved panel. */
static void lay_dense_output(const System *s, Panel *panel);

/* The motion at a position of the panel, -1 to 1. */
static PhasePoint point_at(const System *s, const Panel *panel, double x);

/* The last two Legendre coefficients of a rate given at the nodes, in size. */
static double tail_of(const double *rate);

/* Error estimates over their limits: the panel is good where this is at most 1. omega: rad/s, of the swing. */
static double error_ratio(const System *s, const Panel *panel, double omega);
#define TRUNCATION 3e-6 /* last two Legendre coefficients of a rate against its size */
#endif
