/* Call forward dynamics state by state and as a batch; sanitizers end the program at the first error. Print the
 * number of states that have no result; states whose result may be inaccurate do not count. */
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
