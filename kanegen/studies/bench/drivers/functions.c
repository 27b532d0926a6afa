/* Driver of the functions `equations` and `dynamics`, or with -DDERIVATIVES of `derivatives` and
 * `inverse_derivatives`, each of which takes x, y and tau one behind the other and returns one array. */
#include "driver.h"

#include <stdlib.h>

typedef void Function(const double *arguments, double *values);
Function equations, dynamics, derivatives, inverse_derivatives;

static size_t n;
static double *arguments; /* of all states */
static double *results;

#define TASK(function, count)                                             \
    static void run_##function(size_t state)                              \
    {                                                                     \
        function(arguments + state * 3 * n, results);                     \
    }                                                                     \
    static void give_##function(size_t state, double *values)             \
    {                                                                     \
        (void)state;                                                      \
        for (size_t i = 0; i < (count); i++) values[i] = results[i];      \
    }

#ifdef DERIVATIVES
TASK(derivatives, 3 * n * n)
TASK(inverse_derivatives, 3 * n * n)
#else
TASK(equations, n *n + n)
TASK(dynamics, n)
#endif

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    n = states->n;
    results = aligned_numbers(3 * n * n + n);
    arguments = aligned_numbers(states->count * 3 * n);
    for (size_t state = 0; state < states->count; state++)
        for (size_t i = 0; i < n; i++) {
            double *row = arguments + state * 3 * n;
            row[i] = states->x[state * n + i];
            row[n + i] = states->y[state * n + i];
            row[2 * n + i] = states->tau[state * n + i];
        }
}

size_t driver_tasks(const Task **tasks)
{
#ifdef DERIVATIVES
    static Task every[] = {
        {"derivatives", run_derivatives, give_derivatives, 0, 1},
        {"inverse derivatives", run_inverse_derivatives, give_inverse_derivatives, 0, 1},
    };
    every[0].size = every[1].size = 3 * n * n;
#else
    static Task every[] = {
        {"equations", run_equations, give_equations, 0, 1},
        {"dynamics", run_dynamics, give_dynamics, 0, 1},
    };
    every[0].size = n * n + n;
    every[1].size = n;
#endif
    *tasks = every;
    return sizeof every / sizeof *every;
}
