/* Arithmetic on the N nodes of a panel, as many doubles at once as the processor takes: products with tables, inverses,
 * and polynomials in the position x on a panel, -1 at its start and 1 at its end. */
#ifndef LANES_H
#define LANES_H
#include <math.h>
#include <string.h>

#include "effect.h"

#include "catalogue.h" /* generated: N, the tables T_ of the collocation, and the table EFFECTS */

#define LANES(array, k) (((Lanes *)(array))[k])
#define READ_LANES(array, k) (((const Lanes *)(array))[k])
#define LANES_OF(size) ((size) / WIDTH)

/* ---- Matrices, stored by column ---- */

/* out[i] = sum over j of table[j * N + i] * weight[j] */
static inline void multiply(const double *table, const double *weight, double *out) {
    Lanes sum[LANES_OF(N)] = {{0.0}};
    for (int j = 0; j < N; j++)
        for (int k = 0; k < LANES_OF(N); k++) sum[k] += READ_LANES(table + j * N, k) * weight[j];
    for (int k = 0; k < LANES_OF(N); k++) LANES(out, k) = sum[k];
}

/* the same for a table of several blocks of N rows and columns */
static inline void multiply_blocks(int blocks, const double *table, const double *weight, double *out) {
    const int size = blocks * N;
    for (int k = 0; k < LANES_OF(size); k++) {
        Lanes sum = {0.0};
        for (int j = 0; j < size; j++) sum += READ_LANES(table + j * size, k) * weight[j];
        LANES(out, k) = sum;
    }
}

static inline void exchange_rows(int size, double *g, int one, int other) {
    for (int i = 0; i < size; i++) {
        const double kept = g[one * size + i];
        g[one * size + i] = g[other * size + i];
        g[other * size + i] = kept;
    }
}

static inline void exchange_columns(int size, double *g, int one, int other) {
    for (int r = 0; r < size; r++) {
        const double kept = g[r * size + one];
        g[r * size + one] = g[r * size + other];
        g[r * size + other] = kept;
    }
}

/* Invert the size x size matrix (at most MOST_ROWS) in place by Gauss-Jordan; 0 where it is singular. Rows are exchanged
 * only for a small pivot: the matrices are one less the integrals up to each node, so nearly triangular with a diagonal
 * near one. */
#define MOST_ROWS ((1 + MAX_STATES) * N)
#define SMALL_PIVOT 0.1
static inline int gauss_jordan(int size, double *g) {
    static const double ones[2 * MOST_ROWS] = {[MOST_ROWS] = 1.0};
    int swapped[MOST_ROWS];
    for (int c = 0; c < size; c++) {
        int pivot = c;
        for (int r = c + 1; r < size && !(fabs(g[c * size + c]) > SMALL_PIVOT); r++)
            if (fabs(g[r * size + c]) > fabs(g[pivot * size + c])) pivot = r;
        swapped[c] = pivot;
        if (!(fabs(g[pivot * size + c]) > 1e-300)) return 0;
        double *row = g + c * size;
        if (pivot != c) exchange_rows(size, g, c, pivot);
        const double unit = 1.0 / row[c];
        /* one at c; added by lanes, for a store of one double before lanes are read stalls */
        const double *one = ones + MOST_ROWS - c;
        Lanes pivot_row[LANES_OF(MOST_ROWS)];
        /* 1 + unit at c, so that each other row's own entry, factor, becomes -factor * unit */
        for (int k = 0; k < LANES_OF(size); k++) pivot_row[k] = (READ_LANES(row, k) + READ_LANES(one, k)) * unit;
        for (int r = 0; r < size; r++) {
            double *other = g + r * size;
            const double factor = other[c];
            for (int k = 0; k < LANES_OF(size); k++) LANES(other, k) -= pivot_row[k] * factor;
        }
        for (int k = 0; k < LANES_OF(size); k++) LANES(row, k) = pivot_row[k] - READ_LANES(one, k);
    }
    for (int c = size - 1; c >= 0; c--)
        if (swapped[c] != c) exchange_columns(size, g, c, swapped[c]);
    return 1;
}

static inline double largest(const double *x) {
    double most = 0.0;
    for (int i = 0; i < N; i++) most = fabs(x[i]) > most ? fabs(x[i]) : most;
    return most;
}

/* Whether all N are finite; `largest` passes over what is no number. */
static inline int all_finite(const double *x) {
    double sum[4] = {0.0};
    for (int i = 0; i < N; i++) sum[i % 4] += x[i];
    return isfinite((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/* ---- Polynomials: coefficients of the powers of x ---- */

/* The integral over the panel's time, from `start`, of a rate of degree N - 1 or N. */
static inline void integrate(const double *rate, int degree, double h, double start, double *out) {
    double sum[8] = {0.0};
    for (int k = 0; k < LANES_OF(N); k++) {
        const Lanes part = READ_LANES(rate, k) * READ_LANES(T_reciprocal, k) * (0.5 * h);
        LANES(out + 1, k) = part;
        LANES(sum, k % LANES_OF(8)) += part;
    }
    if (degree == N) sum[0] += out[N + 1] = 0.5 * h * rate[N] * T_reciprocal[N];
    out[0] = start + (((sum[0] - sum[1]) + (sum[2] - sum[3])) + ((sum[4] - sum[5]) + (sum[6] - sum[7])));
}

static inline double horner(const double *c, int degree, double x) {
    double value = c[degree];
    for (int k = degree - 1; k >= 0; k--) value = value * x + c[k];
    return value;
}

/* The polynomial of degree N + 1 and its slope by time at N positions. */
static inline void values_and_slopes(const double *poly, double h, const double *x, double *value, double *slope) {
    for (int k = 0; k < LANES_OF(N); k++) {
        const Lanes at = READ_LANES(x, k);
        Lanes sum = poly[N + 1] - (Lanes){0.0}, rise = {0.0};
        for (int j = N; j >= 0; j--) {
            rise = rise * at + sum;
            sum = sum * at + poly[j];
        }
        LANES(value, k) = sum;
        LANES(slope, k) = rise * (2.0 / h);
    }
}

/* The polynomial at n positions, ROOM at a time; as many must follow the positions. */
#define ROOM 16
static inline void sample(const double *poly, int degree, const double *x, int n, double *out) {
    for (int start = 0; start < n; start += ROOM) {
        Lanes at[LANES_OF(ROOM)], value[LANES_OF(ROOM)];
        for (int j = 0; j < LANES_OF(ROOM); j++) {
            at[j] = READ_LANES(x + start, j);
            value[j] = poly[degree] - (Lanes){0.0};
        }
        for (int k = degree - 1; k >= 0; k--)
            for (int j = 0; j < LANES_OF(ROOM); j++) value[j] = value[j] * at[j] + poly[k];
        if (n - start >= ROOM) memcpy(out + start, value, sizeof value);
        else memcpy(out + start, value, (n - start) * sizeof(double));
    }
}
#endif
