/* Driver of kanegen's C for [A] as its lower triangle and {f}; compile with -DMODEL=<name of the model>. */
#include "kanegen_blocks.h"

#define FUNCTION(name) NAMED(MODEL, name)

void FUNCTION(evaluate)(const double *x, const double *y, double *A, double *f);
void FUNCTION(evaluate_batch)(size_t count, const double *x, const double *y, double *A, double *f);

static double *A, *f; /* of BLOCK states; single states use the first */

static void lower(size_t state)
{
    const size_t row = state * pool.n;
    FUNCTION(evaluate)(pool.x + row, pool.y + row, A, f);
}

static void lower_batch(size_t state)
{
    const size_t first = first_of(state), row = first * pool.n;
    FUNCTION(evaluate_batch)(block(first), pool.x + row, pool.y + row, A, f);
}

static void give_lower_batch(size_t state, double *values)
{
    const size_t n = pool.n, at = state % BLOCK;
    const double *matrix = A + at * n * n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) values[i * n + j] = values[j * n + i] = matrix[i * n + j];
    copied(values + n * n, f + at * n, n);
}

static void give_lower(size_t state, double *values)
{
    (void)state;
    give_lower_batch(0, values);
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    A = aligned_numbers(BLOCK * pool.n * pool.n);
    f = aligned_numbers(BLOCK * pool.n);
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"lower", lower, give_lower, 0, 1},
        {"lower batch", lower_batch, give_lower_batch, 0, BLOCK},
    };
    every[0].size = every[1].size = pool.n * pool.n + pool.n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
