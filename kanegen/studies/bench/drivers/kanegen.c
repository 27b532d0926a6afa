/* Driver of kanegen's C for a model without loads and parameters; compile with -DMODEL=<name of the model>, and for
 * derivatives with -DINVERSE=<name of the model of those of inverse dynamics>. */
#include "driver.h"

#include <stdlib.h>

#define JOINED(model, name) model##_##name
#define NAMED(model, name) JOINED(model, name)
#define FUNCTION(name) NAMED(MODEL, name)

void FUNCTION(evaluate)(const double *x, const double *y, double *A, double *f);
void FUNCTION(evaluate_batch)(size_t count, const double *x, const double *y, double *A, double *f);
int FUNCTION(forward_dynamics)(const double *x, const double *y, const double *tau, double *ydot);
size_t FUNCTION(forward_dynamics_batch)(
    size_t count, const double *x, const double *y, const double *tau, double *ydot);
#ifdef INVERSE
int FUNCTION(forward_dynamics_derivatives)(const double *x, const double *y, const double *tau, double *values);
size_t FUNCTION(forward_dynamics_derivatives_batch)(
    size_t count, const double *x, const double *y, const double *tau, double *values);

/* [A] with the derivatives of inverse dynamics by x and y; what drivers call tau is ydot. */
void NAMED(INVERSE, evaluate)(const double *x, const double *y, const double *ydot, double *A, double *values);
void NAMED(INVERSE, evaluate_batch)(
    size_t count, const double *x, const double *y, const double *ydot, double *A, double *values);
#endif

/* Number of states of a batch. The next batch overwrites the results, as in a program that works block by block. */
enum { BLOCK = 32 };

static States pool;
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

static size_t block(size_t first)
{
    return pool.count - first < BLOCK ? pool.count - first : BLOCK;
}

static void equations_batch(size_t state)
{
    const size_t first = state - state % BLOCK, row = first * pool.n;
    FUNCTION(evaluate_batch)(block(first), pool.x + row, pool.y + row, A, f);
}

static void dynamics_batch(size_t state)
{
    const size_t first = state - state % BLOCK, row = first * pool.n;
    FUNCTION(forward_dynamics_batch)(block(first), pool.x + row, pool.y + row, pool.tau + row, ydot);
}

#ifdef INVERSE
static double *jacobians; /* of BLOCK states */

static void derivatives(size_t state)
{
    const size_t row = state * pool.n;
    FUNCTION(forward_dynamics_derivatives)(pool.x + row, pool.y + row, pool.tau + row, jacobians);
}

static void derivatives_batch(size_t state)
{
    const size_t first = state - state % BLOCK, row = first * pool.n;
    FUNCTION(forward_dynamics_derivatives_batch)
    (block(first), pool.x + row, pool.y + row, pool.tau + row, jacobians);
}

static void inverse_derivatives(size_t state)
{
    const size_t row = state * pool.n;
    NAMED(INVERSE, evaluate)(pool.x + row, pool.y + row, pool.tau + row, A, jacobians);
}

static void inverse_derivatives_batch(size_t state)
{
    const size_t first = state - state % BLOCK, row = first * pool.n;
    NAMED(INVERSE, evaluate_batch)(block(first), pool.x + row, pool.y + row, pool.tau + row, A, jacobians);
}
#endif

static double *copied(double *to, const double *from, size_t count)
{
    while (count--) *to++ = *from++;
    return to;
}

static void give_equations(size_t state, double *values)
{
    (void)state;
    copied(copied(values, A, pool.n * pool.n), f, pool.n);
}

static void give_dynamics(size_t state, double *values)
{
    (void)state;
    copied(values, ydot, pool.n);
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

#ifdef INVERSE
static void give_derivatives(size_t state, double *values)
{
    (void)state;
    copied(values, jacobians, 3 * pool.n * pool.n);
}

static void give_derivatives_batch(size_t state, double *values)
{
    const size_t size = 3 * pool.n * pool.n;
    copied(values, jacobians + state % BLOCK * size, size);
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
#endif

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    A = aligned_numbers(BLOCK * pool.n * pool.n);
    f = aligned_numbers(BLOCK * pool.n);
    ydot = aligned_numbers(BLOCK * pool.n);
#ifdef INVERSE
    jacobians = aligned_numbers(BLOCK * 3 * pool.n * pool.n);
#endif
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"equations", equations, give_equations, 0, 1},
        {"dynamics", dynamics, give_dynamics, 0, 1},
        {"equations batch", equations_batch, give_equations_batch, 0, BLOCK},
        {"dynamics batch", dynamics_batch, give_dynamics_batch, 0, BLOCK},
#ifdef INVERSE
        {"derivatives", derivatives, give_derivatives, 0, 1},
        {"derivatives batch", derivatives_batch, give_derivatives_batch, 0, BLOCK},
        {"inverse derivatives", inverse_derivatives, give_inverse_derivatives, 0, 1},
        {"inverse derivatives batch", inverse_derivatives_batch, give_inverse_derivatives_batch, 0, BLOCK},
#endif
    };
    every[0].size = every[2].size = pool.n * pool.n + pool.n;
    every[1].size = every[3].size = pool.n;
#ifdef INVERSE
    for (size_t i = 4; i < sizeof every / sizeof *every; i++) every[i].size = 3 * pool.n * pool.n;
#endif
    *tasks = every;
    return sizeof every / sizeof *every;
}
