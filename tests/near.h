/* near.h: comparisons of numbers in tests; after cmocka.h. NaN is near nothing. */
#ifndef TEST_NEAR_H
#define TEST_NEAR_H

#include <math.h>

#define NEAR_TEXT(x) #x
#define NEAR_LINE(x) NEAR_TEXT(x)
#define NEAR_PLACE __FILE__ ":" NEAR_LINE(__LINE__)
#define near(got, wanted, tolerance) near_absolute(got, wanted, tolerance, NEAR_PLACE)
#define close_to(got, wanted, tolerance) near_relative(got, wanted, tolerance, NEAR_PLACE)
#define near_to(what, got, wanted, tolerance) near_relative(got, wanted, tolerance, what)

static inline void near_absolute(double got, double wanted, double tolerance, const char *what) {
    if (!(fabs(got - wanted) <= tolerance))
        fail_msg("%s: %.17g, not %.17g (off by %.2g)", what, got, wanted, got - wanted);
}
static inline void near_relative(double got, double wanted, double tolerance, const char *what) {
    if (!(fabs(got - wanted) <= tolerance * fabs(wanted)))
        fail_msg("%s: %.17g, not %.17g (off by %.2g of it)", what, got, wanted, got / wanted - 1.0);
}

#endif
