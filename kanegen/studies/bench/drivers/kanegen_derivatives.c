/* Driver of kanegen's C for derivatives; compile with -DMODEL=<name of the model with those of forward dynamics> and
 * -DINVERSE=<name of the model with [A] and those of inverse dynamics>. */
#include "kanegen_blocks.h"

#define FORWARD(name) NAMED(MODEL, name)

int FORWARD(forward_dynamics_derivatives)(const double *x, const double *y, const double *tau, double *values);
size_t FORWARD(forward_dynamics_derivatives_batch)(
    size_t count, const double *x, const double *y, const double *tau, double *values);

/* [A] with the derivatives of inverse dynamics by x and y; what drivers call tau is ydot. */
void NAMED(INVERSE, evaluate)(const double *x, const double *y, const double *ydot, double *A, double *values);
void NAMED(INVERSE, evaluate_batch)(
    size_t count, const double *x, const double *y, const double *ydot, double *A, double *values);

static double *A, *jacobians; /* of BLOCK states; single states use the first */

static void derivatives(size_t state)
{
    const size_t row = state * pool.n;
    FORWARD(forward_dynamics_derivatives)(pool.x + row, pool.y + row, pool.tau + row, jacobians);
}

static void derivatives_batch(size_t state)
{
    const size_t first = first_of(state), row = first * pool.n;
    FORWARD(forward_dynamics_derivatives_batch)
    (block(first), pool.x + row, pool.y + row, pool.tau + row, jacobians);
}

static void inverse_derivatives(size_t state)
{
    const size_t row = state * pool.n;
    NAMED(INVERSE, evaluate)(pool.x + row, pool.y + row, pool.tau + row, A, jacobians);
}

static void inverse_derivatives_batch(size_t state)
{
    const size_t first = first_of(state), row = first * pool.n;
    NAMED(INVERSE, evaluate_batch)(block(first), pool.x + row, pool.y + row, pool.tau + row, A, jacobians);
}

static void give_derivatives_batch(size_t state, double *values)
{
    const size_t size = 3 * pool.n * pool.n;
    copied(values, jacobians + state % BLOCK * size, size);
}

static void give_derivatives(size_t state, double *values)
{
    (void)state;
    give_derivatives_batch(0, values);
}

static void give_inverse_derivatives_batch(size_t state, double *values)
{
    const size_t n = pool.n, at = state % BLOCK;
    for (size_t i = 0; i < n; i++) {
        values = copied(values, jacobians + (at * n + i) * 2 * n, 2 * n);
        values = copied(values, A + (at * n + i) * n, n);
    }
}

static void give_inverse_derivatives(size_t state, double *values)
{
    (void)state;
    give_inverse_derivatives_batch(0, values);
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    A = aligned_numbers(BLOCK * pool.n * pool.n);
    jacobians = aligned_numbers(BLOCK * 3 * pool.n * pool.n);
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"derivatives", derivatives, give_derivatives, 0, 1},
        {"derivatives batch", derivatives_batch, give_derivatives_batch, 0, BLOCK},
        {"inverse derivatives", inverse_derivatives, give_inverse_derivatives, 0, 1},
        {"inverse derivatives batch", inverse_derivatives_batch, give_inverse_derivatives_batch, 0, BLOCK},
    };
    for (size_t i = 0; i < sizeof every / sizeof *every; i++) every[i].size = 3 * pool.n * pool.n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
