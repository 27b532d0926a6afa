/* Driver of rollouts of kanegen's C by the classical Runge-Kutta method, from one state a call and from all at once,
 * for a model without loads whose speeds are the rates of its coordinates.
 *
 * Compile with -DHEADER=<"header of the model"> -DMODEL=<its name>, and for a model with parameters with
 * -DPREPARED=<number of prepared constants> -DDEFAULTS=<values of the parameters, separated by commas>, and
 * -DBY_STATE=<1 if each state has its own, else 0>. Arguments: length of a step (s), number of steps.
 */
#include "driver.h"

#include HEADER

#include <stdlib.h>

#define JOINED(model, name) model##_##name
#define NAMED(model, name) JOINED(model, name)
#define SINGLE NAMED(MODEL, rollout_rk4)
#define BATCH NAMED(MODEL, rollout_rk4_batch)

#ifdef PREPARED
static double *prepared; /* a row for each state, or one */
#define CONSTANTS(state) prepared + BY_STATE * PREPARED * (state),
#else
#define CONSTANTS(state)
#endif

static States pool;
static double length, *x_path, *y_path; /* start and end of each state */
static size_t steps, *made;

static void single(size_t state)
{
    const size_t row = state * pool.n;
    SINGLE(CONSTANTS(state) pool.x + row, pool.y + row, pool.tau + row, 1, &length, steps, steps, 0, x_path, y_path, made);
}

static void batch(size_t state)
{
    (void)state;
    BATCH(pool.count, CONSTANTS(0) pool.x, pool.y, pool.tau, 1, &length, steps, steps, 0, x_path, y_path, made);
}

static void give(double *to, size_t state)
{
    for (size_t i = 0; i < pool.n; i++) {
        to[i] = x_path[(2 * state + 1) * pool.n + i];
        to[pool.n + i] = y_path[(2 * state + 1) * pool.n + i];
    }
}

static void give_single(size_t state, double *to)
{
    (void)state;
    give(to, 0);
}

static void give_batch(size_t state, double *to)
{
    give(to, state);
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    pool = *states;
    length = atof(argv[0]);
    steps = (size_t)atol(argv[1]);
    x_path = aligned_numbers(2 * pool.count * pool.n);
    y_path = aligned_numbers(2 * pool.count * pool.n);
    made = calloc(pool.count, sizeof *made);
#ifdef PREPARED
    static const double defaults[] = {DEFAULTS};
    prepared = aligned_numbers(pool.count * PREPARED);
    for (size_t k = 0; k < pool.count; k++) NAMED(MODEL, prepare)(defaults, prepared + k * PREPARED);
#endif
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {{"single", single, give_single, 0, 1}, {"batch", batch, give_batch, 0, 0}};
    every[0].size = every[1].size = 2 * pool.n;
    every[1].block = pool.count;
    *tasks = every;
    return sizeof every / sizeof *every;
}
