/* Driver of the function `evaluate` that PyDy wrote. */
#include "driver.h"

#include <stdlib.h>

void evaluate(double *x, double *y, double *A, double *f);

static States pool;
static double *A, *f;

static void equations(size_t state)
{
    const size_t row = state * pool.n;
    evaluate((double *)pool.x + row, (double *)pool.y + row, A, f); /* it only reads x and y */
}

static void give_equations(size_t state, double *values)
{
    const size_t n = pool.n;
    (void)state;
    for (size_t i = 0; i < n * n; i++) values[i] = A[i];
    for (size_t i = 0; i < n; i++) values[n * n + i] = f[i];
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    A = aligned_numbers(pool.n * pool.n);
    f = aligned_numbers(pool.n);
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {{"equations", equations, give_equations, 0, 1}};
    every[0].size = pool.n * pool.n + pool.n;
    *tasks = every;
    return 1;
}
