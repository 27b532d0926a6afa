/* Call forward dynamics and print the number of calls that raise each floating-point exception: invalid operation,
 * division by zero, overflow. With TRAP, an exception ends the program. */
#define _GNU_SOURCE
#include <fenv.h>
#include <stdio.h>
#include <stdlib.h>

#include HEADER
#include "states.h"

static const int FLAGS[3] = {FE_INVALID, FE_DIVBYZERO, FE_OVERFLOW};

static void count_raised(long raised[3])
{
    for (int i = 0; i < 3; ++i) raised[i] += fetestexcept(FLAGS[i]) != 0;
}

int main(int argc, char **argv)
{
    const size_t count = argc > 1 ? strtoul(argv[1], NULL, 10) : 0;
    REAL *x = read_array("x", count * N), *y = read_array("y", count * N), *tau = read_array("tau", count * N);
    REAL *found = malloc(count * N * sizeof *found);
    long one[3] = {0, 0, 0}, many[3] = {0, 0, 0};
    if (!found) return 1;
#ifdef TRAP
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
#endif
    for (size_t i = 0; i < count; ++i) {
        feclearexcept(FE_ALL_EXCEPT);
        if (ONE(x + N*i, y + N*i, tau + N*i, found + N*i)) return 1;
        count_raised(one);
    }
    feclearexcept(FE_ALL_EXCEPT);
    if (MANY(count, x, y, tau, found)) return 1;
    count_raised(many);
    printf("%ld %ld %ld\n%ld %ld %ld\n", one[0], one[1], one[2], many[0], many[1], many[2]);
    return 0;
}
