/* Driver of the functions `equations` and `dynamics` that CasADi wrote, or with -DDERIVATIVES of `derivatives` and
 * `inverse_derivatives`. */
#include "driver.h"

#include <stdlib.h>

typedef int Sizes(long long *arguments, long long *results, long long *integers, long long *work);
typedef int Function(const double **arguments, double **results, long long *integers, double *work, int memory);

typedef struct {
    const double **arguments;
    double **results;
    long long *integers;
    double *work;
} Room;

static States pool;
static double *values_of[2]; /* results of a function */

static Room room(Sizes *sizes)
{
    long long arguments, results, integers, work;
    sizes(&arguments, &results, &integers, &work);
    return (Room){calloc(arguments, sizeof(double *)), calloc(results, sizeof(double *)),
                  calloc(integers + 1, sizeof(long long)), calloc(work + 1, sizeof(double))};
}

/* Call a function with the first `count` of x, y and tau. */
static void call(Function *function, Room r, size_t state, size_t count)
{
    const double *inputs[] = {pool.x, pool.y, pool.tau};
    for (size_t i = 0; i < count; i++) r.arguments[i] = inputs[i] + state * pool.n;
    for (size_t i = 0; i < 4 - count; i++) r.results[i] = values_of[i];
    function(r.arguments, r.results, r.integers, r.work, 0);
}

static double *copied(double *to, const double *from, size_t count)
{
    while (count--) *to++ = *from++;
    return to;
}

#define FUNCTION(name, count)                \
    Function name;                           \
    Sizes name##_work;                       \
    static Room of_##name;                   \
    static void run_##name(size_t state)     \
    {                                        \
        call(name, of_##name, state, count); \
    }

#ifdef DERIVATIVES
FUNCTION(derivatives, 3)
FUNCTION(inverse_derivatives, 3)

static void give_jacobian(size_t state, double *values)
{
    (void)state;
    copied(values, values_of[0], 3 * pool.n * pool.n);
}
#else
FUNCTION(equations, 2)
FUNCTION(dynamics, 3)

static void give_equations(size_t state, double *values)
{
    (void)state;
    copied(copied(values, values_of[0], pool.n * pool.n), values_of[1], pool.n);
}

static void give_dynamics(size_t state, double *values)
{
    (void)state;
    copied(values, values_of[0], pool.n);
}
#endif

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    for (int i = 0; i < 2; i++) values_of[i] = aligned_numbers(3 * pool.n * pool.n);
#ifdef DERIVATIVES
    of_derivatives = room(derivatives_work);
    of_inverse_derivatives = room(inverse_derivatives_work);
#else
    of_equations = room(equations_work);
    of_dynamics = room(dynamics_work);
#endif
}

size_t driver_tasks(const Task **tasks)
{
#ifdef DERIVATIVES
    static Task every[] = {
        {"derivatives", run_derivatives, give_jacobian, 0, 1},
        {"inverse derivatives", run_inverse_derivatives, give_jacobian, 0, 1},
    };
    every[0].size = every[1].size = 3 * pool.n * pool.n;
#else
    static Task every[] = {
        {"equations", run_equations, give_equations, 0, 1},
        {"dynamics", run_dynamics, give_dynamics, 0, 1},
    };
    every[0].size = pool.n * pool.n + pool.n;
    every[1].size = pool.n;
#endif
    *tasks = every;
    return sizeof every / sizeof *every;
}
