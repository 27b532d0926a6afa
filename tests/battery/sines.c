/* Print the largest errors of sine and cosine over every argv[1]-th float, in units of the last place. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kanegen_sincosf.h"

static double last_place(double exact)
{
    const int exponent = ilogb(exact);
    return ldexp(1.0, exact == 0.0 || exponent < -126 ? -149 : exponent - 23);
}

static void compare(float found, double exact, double *worst)
{
    const double error = fabs((double)found - exact)/last_place(exact);
    if (!(error <= *worst)) *worst = error;
}

int main(int argc, char **argv)
{
    const uint32_t step = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 1;
    double worst[2] = {0.0, 0.0};
    for (uint32_t pattern = 0; pattern < 0x7f800000U; pattern += step) {
        float angle, sine, cosine;
        memcpy(&angle, &pattern, sizeof angle);
        kanegen_sincosf(angle, &sine, &cosine);
        compare(sine, sin(angle), worst);
        compare(cosine, cos(angle), worst + 1);
    }
    printf("%.17g %.17g\n", worst[0], worst[1]);
    return 0;
}
