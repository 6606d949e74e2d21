/* The little of a C library that the headers ask for, for WebAssembly without one. Bodies in libc.c. */
#ifndef RIDDLE_WEB_MATH_H
#define RIDDLE_WEB_MATH_H
#define NAN (__builtin_nanf(""))
#define INFINITY (__builtin_inff())
#define HUGE_VAL (__builtin_huge_val())
#define isnan(x) __builtin_isnan(x)
#define isinf(x) __builtin_isinf(x)
#define isfinite(x) __builtin_isfinite(x)
#define signbit(x) __builtin_signbit(x)
#define sqrt __builtin_sqrt /* one instruction each */
#define fabs __builtin_fabs
#define floor __builtin_floor
#define ceil __builtin_ceil
#define copysign __builtin_copysign
double fmin(double a, double b);
double fmax(double a, double b);
double frexp(double x, int *exponent);
double ldexp(double x, int exponent);
#endif
