/* Sine and cosine, exponential, logarithm and powers that compilers vectorise and that give the same bits on every machine,
 * whatever its mathematical library: straight lines of sums and products, with no branch and no table. */
#ifndef ELEMENTARY_H
#define ELEMENTARY_H
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "lane_types.h"

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* Reduce by whole turns, take a quarter of the angle (Cephes polynomials on +-pi/4), double twice. Adding `big`, 1.5 * 2^52,
 * rounds to whole numbers. */
#define DEFINE_SINE_COSINE(name, Real) \
ALWAYS_INLINE void name(Real x, Real *s, Real *c) {                                                                             \
    const double big = 6755399441055744.0;                                                                                      \
    Real turns = x * 0.15915494309189535 + big;                                                                                 \
    turns -= big;                                                                                                               \
    Real z = ((x - turns * 6.28318530717958623) - turns * 2.44929359829470635e-16) * 0.25;                                      \
    Real zz = z * z;                                                                                                            \
    Real ps = ((((1.58962301576546568060e-10 * zz - 2.50507477628578072866e-8) * zz + 2.75573136213857245213e-6) * zz           \
                  - 1.98412698295895385996e-4) * zz + 8.33333333332211858878e-3) * zz - 1.66666666666666307295e-1;              \
    Real pc = ((((-1.13585365213876817300e-11 * zz + 2.08757008419747316778e-9) * zz - 2.75573141792967388112e-7) * zz          \
                  + 2.48015872888517045348e-5) * zz - 1.38888888888730564116e-3) * zz + 4.16666666666665929218e-2;              \
    Real s0 = z + z * zz * ps, c0 = 1.0 - 0.5 * zz + zz * zz * pc;                                                              \
    Real s1 = 2.0 * s0 * c0, c1 = 1.0 - 2.0 * s0 * s0;                                                                          \
    *s = 2.0 * s1 * c1;                                                                                                         \
    *c = 1.0 - 2.0 * s1 * s1;                                                                                                   \
}
DEFINE_SINE_COSINE(sine_cosine, double)
DEFINE_SINE_COSINE(sines_cosines, Each)
ALWAYS_INLINE double sine(double x) { double s, c; sine_cosine(x, &s, &c); return s; }
ALWAYS_INLINE double cosine(double x) { double s, c; sine_cosine(x, &s, &c); return c; }
ALWAYS_INLINE Each sines(Each x) { Each s, c; sines_cosines(x, &s, &c); return s; }
ALWAYS_INLINE Each cosines(Each x) { Each s, c; sines_cosines(x, &s, &c); return c; }

ALWAYS_INLINE uint64_t bits_of(double x) { uint64_t bits; memcpy(&bits, &x, sizeof bits); return bits; }
ALWAYS_INLINE double of_bits(uint64_t bits) { double x; memcpy(&x, &bits, sizeof x); return x; }

/* e^x to a unit in the last place: 2^k times Taylor's series of what is left, at most ln 2 / 2 in size. Zero below -708,
 * infinite above 709. */
ALWAYS_INLINE double exponential(double x) {
    const double big = 6755399441055744.0, held = x < -708.0 ? -708.0 : (x > 709.0 ? 709.0 : x);
    const double rounded = held * 1.4426950408889634 + big, k = rounded - big;
    const double r = (held - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
    double sum = 1.0 / 6227020800.0;
    sum = sum * r + 1.0 / 479001600.0;
    sum = sum * r + 1.0 / 39916800.0;
    sum = sum * r + 1.0 / 3628800.0;
    sum = sum * r + 1.0 / 362880.0;
    sum = sum * r + 1.0 / 40320.0;
    sum = sum * r + 1.0 / 5040.0;
    sum = sum * r + 1.0 / 720.0;
    sum = sum * r + 1.0 / 120.0;
    sum = sum * r + 1.0 / 24.0;
    sum = sum * r + 1.0 / 6.0;
    sum = sum * r + 0.5;
    const double value = of_bits((bits_of(rounded) + 1023) << 52) * (1.0 + (r + r * r * sum));
    return x < -708.0 ? 0.0 : (x > 709.0 ? INFINITY : value);
}

/* ln x to a unit in the last place, for a normal x > 0: of the part between 1/sqrt 2 and sqrt 2 by the polynomial of fdlibm's
 * e_log.c (Sun Microsystems, 1993). */
ALWAYS_INLINE double logarithm(double x) {
    const uint64_t bits = bits_of(x);
    const double part = of_bits((bits & 0xfffffffffffffULL) | 0x3ff0000000000000ULL);
    const double power = of_bits((bits >> 52) | 0x4330000000000000ULL) - (4503599627370496.0 + 1023.0);
    const int above = part > 1.4142135623730951;
    const double f = (above ? 0.5 * part : part) - 1.0, k = above ? power + 1.0 : power;
    const double s = f / (2.0 + f), z = s * s, w = z * z, half = 0.5 * f * f;
    const double even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const double odd = z * (6.666666666666735130e-01
                            + w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    return k * 6.93147180369123816490e-01 - ((half - (s * (half + (even + odd)) + k * 1.90821492927058770002e-10)) - f);
}

/* x to any power, for a normal x > 0; relative to the value as exact as the product of power and logarithm is to one. */
ALWAYS_INLINE double power_of(double x, double power) { return exponential(power * logarithm(x)); }
#endif
