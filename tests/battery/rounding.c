/* Print the results of forward dynamics in hexadecimal for every rounding mode: nearest, upward, downward, toward
 * zero. */
#include <fenv.h>
#include <stdio.h>
#include <stdlib.h>

#include HEADER
#include "states.h"

static const int MODES[4] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

int main(int argc, char **argv)
{
    const size_t count = argc > 1 ? strtoul(argv[1], NULL, 10) : 0;
    REAL *x = read_array("x", count * N), *y = read_array("y", count * N), *tau = read_array("tau", count * N);
    for (int mode = 0; mode < 4; ++mode) {
        for (size_t i = 0; i < count; ++i) {
            REAL found[N];
            fesetround(MODES[mode]);
            const int wrong = ONE(x + N*i, y + N*i, tau + N*i, found);
            fesetround(FE_TONEAREST);
            if (wrong) return 1;
            for (int j = 0; j < N; ++j) printf("%a ", (double)found[j]);
        }
        printf("\n");
    }
    return 0;
}
