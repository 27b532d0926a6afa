/* Driver of the functions `equations` and `dynamics` that CasADi wrote, and with -DDERIVATIVES of `derivatives` and
 * `inverse_derivatives`. */
#include "driver.h"

#include <stdlib.h>

typedef int Function(const double **arguments, double **results, long long *integers, double *work, int memory);
Function equations, dynamics;
int equations_work(long long *arguments, long long *results, long long *integers, long long *work);
int dynamics_work(long long *arguments, long long *results, long long *integers, long long *work);
#ifdef DERIVATIVES
Function derivatives, inverse_derivatives;
int derivatives_work(long long *arguments, long long *results, long long *integers, long long *work);
int inverse_derivatives_work(long long *arguments, long long *results, long long *integers, long long *work);
#endif

typedef struct {
    const double **arguments;
    double **results;
    long long *integers;
    double *work;
} Room;

static States pool;
static double *A, *f, *ydot;
static Room of_equations, of_dynamics;
#ifdef DERIVATIVES
static double *jacobian;
static Room of_derivatives, of_inverse;
#endif

static Room room(int (*sizes)(long long *, long long *, long long *, long long *))
{
    long long arguments, results, integers, work;
    sizes(&arguments, &results, &integers, &work);
    return (Room){calloc(arguments, sizeof(double *)), calloc(results, sizeof(double *)),
                  calloc(integers + 1, sizeof(long long)), calloc(work + 1, sizeof(double))};
}

static void run_equations(size_t state)
{
    Room r = of_equations;
    r.arguments[0] = pool.x + state * pool.n;
    r.arguments[1] = pool.y + state * pool.n;
    r.results[0] = A;
    r.results[1] = f;
    equations(r.arguments, r.results, r.integers, r.work, 0);
}

static void run(Function *function, Room r, size_t state, double *result)
{
    r.arguments[0] = pool.x + state * pool.n;
    r.arguments[1] = pool.y + state * pool.n;
    r.arguments[2] = pool.tau + state * pool.n;
    r.results[0] = result;
    function(r.arguments, r.results, r.integers, r.work, 0);
}

static void run_dynamics(size_t state)
{
    run(dynamics, of_dynamics, state, ydot);
}

#ifdef DERIVATIVES
static void run_derivatives(size_t state)
{
    run(derivatives, of_derivatives, state, jacobian);
}

static void run_inverse_derivatives(size_t state)
{
    run(inverse_derivatives, of_inverse, state, jacobian);
}

static void give_derivatives(size_t state, double *values)
{
    (void)state;
    for (size_t i = 0; i < 3 * pool.n * pool.n; i++) values[i] = jacobian[i];
}
#endif

static void give_equations(size_t state, double *values)
{
    const size_t n = pool.n;
    (void)state;
    for (size_t i = 0; i < n * n; i++) values[i] = A[i];
    for (size_t i = 0; i < n; i++) values[n * n + i] = f[i];
}

static void give_dynamics(size_t state, double *values)
{
    (void)state;
    for (size_t i = 0; i < pool.n; i++) values[i] = ydot[i];
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    A = aligned_numbers(pool.n * pool.n);
    f = aligned_numbers(pool.n);
    ydot = aligned_numbers(pool.n);
    of_equations = room(equations_work);
    of_dynamics = room(dynamics_work);
#ifdef DERIVATIVES
    jacobian = aligned_numbers(3 * pool.n * pool.n);
    of_derivatives = room(derivatives_work);
    of_inverse = room(inverse_derivatives_work);
#endif
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"equations", run_equations, give_equations, 0, 1},
        {"dynamics", run_dynamics, give_dynamics, 0, 1},
#ifdef DERIVATIVES
        {"derivatives", run_derivatives, give_derivatives, 0, 1},
        {"inverse derivatives", run_inverse_derivatives, give_derivatives, 0, 1},
#endif
    };
    every[0].size = pool.n * pool.n + pool.n;
    every[1].size = pool.n;
#ifdef DERIVATIVES
    every[2].size = every[3].size = 3 * pool.n * pool.n;
#endif
    *tasks = every;
    return sizeof every / sizeof *every;
}
