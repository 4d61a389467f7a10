/* As many doubles at once as the processor takes. Each lane rounds as a double alone would, so their number changes no
 * bit. */
#ifndef LANE_TYPES_H
#define LANE_TYPES_H

/* GCC's and Clang's vectors; wider ones than the processor's are taken apart, at several times the cost. */
#if defined __AVX512F__
#define WIDTH 8
#elif defined __AVX__
#define WIDTH 4
#else
#define WIDTH 2
#endif
typedef double Lanes __attribute__((vector_size(WIDTH * sizeof(double)), aligned(8), may_alias));

/* A number for each of several fits, and a choice among them (all bits or none). */
typedef double Each __attribute__((vector_size(WIDTH * sizeof(double)), may_alias));
typedef long long Which __attribute__((vector_size(WIDTH * sizeof(double)), may_alias));
#endif
