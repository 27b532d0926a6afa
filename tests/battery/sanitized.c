/* Calls forward dynamics state by state and as a batch; sanitizers end the program at what they object to. What is
 * printed is how many states are refused, not in how many a result is said to be inaccurate. */
#include <stdio.h>
#include <stdlib.h>

#include HEADER
#include "states.h"

int main(int argc, char **argv)
{
    const size_t count = argc > 1 ? strtoul(argv[1], NULL, 10) : 0;
    REAL *x = read_array("x", count * N), *y = read_array("y", count * N), *tau = read_array("tau", count * N);
    REAL *found = malloc(count * N * sizeof *found);
    int wrong = 0;
    if (!found) return 1;
    for (size_t i = 0; i < count; ++i) wrong += ONE(x + N*i, y + N*i, tau + N*i, found + N*i) > 0;
    MANY(count, x, y, tau, found);
    printf("%d\n", wrong);
    free(x), free(y), free(tau), free(found);
    return 0;
}
