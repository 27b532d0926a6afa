/* kanegen's C of a model without loads and parameters; compile with -DMODEL=<its name>. */
#include "contest.h"

#include <stdlib.h>

#define JOINED(model, name) model##_##name
#define NAMED(model, name) JOINED(model, name)
#define FUNCTION(name) NAMED(MODEL, name)

void FUNCTION(evaluate)(const double *x, const double *y, double *A, double *f);
void FUNCTION(evaluate_batch)(size_t count, const double *x, const double *y, double *A, double *f);
int FUNCTION(forward_dynamics)(const double *x, const double *y, const double *tau, double *ydot);
size_t FUNCTION(forward_dynamics_batch)(
    size_t count, const double *x, const double *y, const double *tau, double *ydot);

static States pool;
static double *A, *f, *ydot, *all_A, *all_f, *all_ydot;

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
    (void)state;
    FUNCTION(evaluate_batch)(pool.count, pool.x, pool.y, all_A, all_f);
}

static void dynamics_batch(size_t state)
{
    (void)state;
    FUNCTION(forward_dynamics_batch)(pool.count, pool.x, pool.y, pool.tau, all_ydot);
}

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
    const size_t n = pool.n;
    copied(copied(values, all_A + state * n * n, n * n), all_f + state * n, n);
}

static void give_dynamics_batch(size_t state, double *values)
{
    copied(values, all_ydot + state * pool.n, pool.n);
}

void contest_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    A = calloc(pool.n * pool.n, sizeof *A);
    f = calloc(pool.n, sizeof *f);
    ydot = calloc(pool.n, sizeof *ydot);
    all_A = calloc(pool.count * pool.n * pool.n, sizeof *A);
    all_f = calloc(pool.count * pool.n, sizeof *f);
    all_ydot = calloc(pool.count * pool.n, sizeof *ydot);
}

size_t contest_tasks(const Task **tasks)
{
    static Task every[] = {
        {"equations", equations, give_equations, 0, 0},
        {"dynamics", dynamics, give_dynamics, 0, 0},
        {"equations batch", equations_batch, give_equations_batch, 0, 1},
        {"dynamics batch", dynamics_batch, give_dynamics_batch, 0, 1},
    };
    every[0].size = every[2].size = pool.n * pool.n + pool.n;
    every[1].size = every[3].size = pool.n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
