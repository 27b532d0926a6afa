/* Driver of kanegen's C for a model without loads and parameters; compile with -DMODEL=<name of the model>. */
#include "kanegen_blocks.h"

#define FUNCTION(name) NAMED(MODEL, name)

void FUNCTION(evaluate)(const double *x, const double *y, double *A, double *f);
void FUNCTION(evaluate_batch)(size_t count, const double *x, const double *y, double *A, double *f);
int FUNCTION(forward_dynamics)(const double *x, const double *y, const double *tau, double *ydot);
size_t FUNCTION(forward_dynamics_batch)(
    size_t count, const double *x, const double *y, const double *tau, double *ydot);

static double *A, *f, *ydot; /* of BLOCK states; single states use the first */

static void equations(size_t state)
{
    const size_t row = state * pool.n;
    FUNCTION(evaluate)(pool.x + row, pool.y + row, A, f);
}

static void dynamics(size_t state)
{
    const size_t row = state * pool.n;
    FUNCTION(forward_dynamics)(pool.x + row, pool.y + row, pool.tau + row, ydot);
}

static void equations_batch(size_t state)
{
    const size_t first = first_of(state), row = first * pool.n;
    FUNCTION(evaluate_batch)(block(first), pool.x + row, pool.y + row, A, f);
}

static void dynamics_batch(size_t state)
{
    const size_t first = first_of(state), row = first * pool.n;
    FUNCTION(forward_dynamics_batch)(block(first), pool.x + row, pool.y + row, pool.tau + row, ydot);
}

static void give_equations_batch(size_t state, double *values)
{
    const size_t n = pool.n, at = state % BLOCK;
    copied(copied(values, A + at * n * n, n * n), f + at * n, n);
}

static void give_dynamics_batch(size_t state, double *values)
{
    copied(values, ydot + state % BLOCK * pool.n, pool.n);
}

static void give_equations(size_t state, double *values)
{
    (void)state;
    give_equations_batch(0, values);
}

static void give_dynamics(size_t state, double *values)
{
    (void)state;
    give_dynamics_batch(0, values);
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    A = aligned_numbers(BLOCK * pool.n * pool.n);
    f = aligned_numbers(BLOCK * pool.n);
    ydot = aligned_numbers(BLOCK * pool.n);
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"equations", equations, give_equations, 0, 1},
        {"equations batch", equations_batch, give_equations_batch, 0, BLOCK},
        {"dynamics", dynamics, give_dynamics, 0, 1},
        {"dynamics batch", dynamics_batch, give_dynamics_batch, 0, BLOCK},
    };
    every[0].size = every[1].size = pool.n * pool.n + pool.n;
    every[2].size = every[3].size = pool.n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
