#include <stdlib.h>

#include "lockstep.h"

#define SAME_POSITION 1e-11 /* of samples on their panels, whose length is 2 */
#define MISSED_AT_ONCE 64

/* The angle at a position of a panel, -1 to 1, by each of its terms: 1, x, and the accelerations' double integrals. */
static void terms_at(double x, double *out) {
    out[0] = 1.0;
    out[1] = 0.5 * (x + 1.0);
    for (int j = 0; j < LN; j++) {
        double power = x, sign = -1.0, sum = 0.0; /* x^(k + 1), (-1)^(k + 1) */
        for (int k = 0; k < LN; k++) {
            const double twice = (power * x + sign) / (k + 2) - sign * (x + 1.0);
            sum += LOCKSTEP_monomial[j * LN + k] * twice / (4.0 * (k + 1));
            power *= x;
            sign = -sign;
        }
        out[2 + j] = sum;
    }
}

static double product_of_columns(const double *a, const double *b, int n, int a_stride, int b_stride) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) sum += a[i * a_stride] * b[i * b_stride];
    return sum;
}

/* Gram and Schmidt's orthonormal basis of the columns, each made orthogonal twice over (Giraud, Langou and Rozloznik, The loss of
 * orthogonality in the Gram-Schmidt orthogonalization process, 2005), in place; the columns' coordinates in it. */
static void orthonormalise(double *basis, int n, double *matrix) {
    double column[TERMS];
    for (int c = 0; c < TERMS; c++) {
        for (int r = 0; r < TERMS; r++) column[r] = 0.0;
        for (int again = 0; again < 2; again++)
            for (int r = 0; r < c; r++) {
                const double part = product_of_columns(basis + r, basis + c, n, BASIS_ROW, BASIS_ROW);
                for (int i = 0; i < n; i++) basis[i * BASIS_ROW + c] -= part * basis[i * BASIS_ROW + r];
                column[r] += part;
            }
        const double size = sqrt(product_of_columns(basis + c, basis + c, n, BASIS_ROW, BASIS_ROW));
        for (int i = 0; i < n; i++) basis[i * BASIS_ROW + c] /= size;
        column[c] = size;
        for (int r = 0; r < TERMS; r++) matrix[r * TERMS + c] = column[r];
    }
}

static void set_up_basis(SampleBasis *b, const double *positions) {
    const int n = b->n_samples;
    memset(b->by_sample, 0, (size_t)n * BASIS_ROW * sizeof(double));
    memset(b->matrix, 0, sizeof b->matrix);
    for (int i = 0; i < n; i++) terms_at(positions[i], b->by_sample + (size_t)i * BASIS_ROW);
    b->triangular = n > TERMS;
    b->rows = b->triangular ? TERMS : n;
    if (b->triangular) orthonormalise(b->by_sample, n, b->matrix);
    for (int i = 0; i < n && !b->triangular; i++) {
        double *row = b->by_sample + (size_t)i * BASIS_ROW;
        memcpy(b->matrix + i * TERMS, row, TERMS * sizeof(double));
        for (int k = 0; k < TERMS; k++) row[k] = k == i;
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < TERMS; j++) b->by_column[(size_t)j * n + i] = b->by_sample[(size_t)i * BASIS_ROW + j];
}

static int same_positions(const double *a, const double *b, int n) {
    for (int i = 0; i < n; i++)
        if (!(fabs(a[i] - b[i]) < SAME_POSITION)) return 0;
    return 1;
}

/* Of equally spaced samples a whole number, so that one basis does for nearly all panels; else the longest. */
static double panel_length(const double *times, int n, double longest) {
    const double spacing = (times[n - 1] - times[0]) / (n - 1);
    for (int i = 0; i < n; i++)
        if (!(fabs(times[i] - times[0] - i * spacing) < 1e-9 * spacing)) return longest;
    return longest > spacing ? floor(longest / spacing) * spacing : longest;
}

/* The samples of each panel, and their positions on it, -1 to 1. */
static void share_samples(LockstepRecord *r, const double *times, int n, double *positions) {
    for (int k = 0, next = 0; k < r->n_panels; k++) {
        PanelSamples *p = &r->panels[k];
        SampleBasis *b = &r->bases[k];
        p->first = next;
        for (; next < n && (k == r->n_panels - 1 || times[next] - times[0] < (k + 1 - SAME_POSITION) * r->h); next++)
            positions[next] = 2.0 * ((times[next] - times[0]) / r->h - k) - 1.0;
        b->n_samples = next - p->first;
        b->by_sample = r->memory + (size_t)p->first * (BASIS_ROW + TERMS);
        b->by_column = b->by_sample + (size_t)b->n_samples * BASIS_ROW;
        const PanelSamples *before = k ? p - 1 : NULL;
        const int same = before && before->basis->n_samples == b->n_samples
                         && same_positions(positions + p->first, positions + before->first, b->n_samples);
        p->basis = same ? before->basis : b;
        if (!same) set_up_basis(b, positions + p->first);
    }
}

static int open_lockstep_record(LockstepRecord *r, const double *times, int n, double longest) {
    const double h = panel_length(times, n, longest), seconds = times[n - 1] - times[0];
    *r = (LockstepRecord){.n_panels = (int)ceil(seconds / h - SAME_POSITION), .h = h};
    r->panels = malloc(r->n_panels * sizeof(PanelSamples));
    r->bases = malloc(r->n_panels * sizeof(SampleBasis));
    r->memory = malloc((size_t)n * (BASIS_ROW + TERMS) * sizeof(double));
    double *positions = malloc(n * sizeof(double));
    const int ready = r->panels && r->bases && r->memory && positions;
    if (ready) share_samples(r, times, n, positions);
    free(positions);
    return ready;
}

static void close_lockstep_record(LockstepRecord *r) {
    free(r->panels);
    free(r->bases);
    free(r->memory);
}

/* The sum of squares of what the basis misses of its samples. */
static double missed_squares(const SampleBasis *b, const double *found, const double *y) {
    double rest[MISSED_AT_ONCE], part[8] = {0.0};
    for (int start = 0; start < b->n_samples; start += MISSED_AT_ONCE) {
        const int n = b->n_samples - start < MISSED_AT_ONCE ? b->n_samples - start : MISSED_AT_ONCE;
        memcpy(rest, y + start, n * sizeof(double));
        for (int j = 0; j < TERMS; j++)
            for (int i = 0; i < n; i++) rest[i] -= b->by_column[(size_t)j * b->n_samples + start + i] * found[j];
        for (int i = 0; i < n; i++) part[i % 8] += rest[i] * rest[i];
    }
    return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
}

static double compress(const LockstepRecord *r, const double *series, double *coordinates) {
    double missed = 0.0;
    for (int k = 0; k < r->n_panels; k++) {
        const SampleBasis *b = r->panels[k].basis;
        const double *y = series + r->panels[k].first;
        Lanes sum[BASIS_ROW / WIDTH] = {{0.0}};
        double found[BASIS_ROW];
        for (int i = 0; i < b->n_samples; i++)
            for (int j = 0; j < BASIS_ROW / WIDTH; j++) sum[j] += y[i] * READ_LANES(b->by_sample + (size_t)i * BASIS_ROW, j);
        memcpy(found, sum, sizeof found);
        memcpy(coordinates + (size_t)k * TERMS, found, TERMS * sizeof(double));
        if (b->triangular) missed += missed_squares(b, found, y);
    }
    return missed;
}
