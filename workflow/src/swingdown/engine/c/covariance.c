/* What a fit's J'J says of its variables: its inverse, the covariance over the variance of the noise. */
#include <math.h>

#include "least_squares.h"

/* The lower triangle of the inverse, in place of the lower triangle of Cholesky's factor (n by n). */
static void invert_factored(int n, double *a) {
    for (int j = 0; j < n; j++) { /* of the factor, by columns */
        a[j * n + j] = 1.0 / a[j * n + j];
        for (int i = j + 1; i < n; i++) {
            double sum = 0.0;
            for (int l = j; l < i; l++) sum -= a[i * n + l] * a[l * n + j];
            a[i * n + j] = sum / a[i * n + i];
        }
    }
    for (int i = 0; i < n; i++) /* its transpose times itself, by rows */
        for (int j = 0; j <= i; j++) {
            double sum = 0.0;
            for (int l = i; l < n; l++) sum += a[l * n + i] * a[l * n + j];
            a[i * n + j] = sum;
        }
}

double invert_normal(int n, const double *x, const double *lower, const double *upper, const double *normal, double *inverse) {
    double scale[MAX_VARIABLES], squares = 0.0, inverse_squares = 0.0;
    if (n > MAX_VARIABLES) return INFINITY;
    for (int i = 0; i < n; i++) {
        if (!(x[i] > lower[i] && x[i] < upper[i])) return INFINITY;
        scale[i] = sqrt(normal[i * n + i]);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            const double scaled = inverse[i * n + j] = normal[i * n + j] / (scale[i] * scale[j]);
            squares += scaled * scaled;
        }
    if (!factorise(n, inverse)) return INFINITY;
    invert_factored(n, inverse);
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            const double scaled = inverse[i * n + j];
            inverse_squares += (i == j ? 1.0 : 2.0) * scaled * scaled;
            inverse[i * n + j] = inverse[j * n + i] = scaled / (scale[i] * scale[j]);
        }
    return sqrt(squares * inverse_squares);
}
