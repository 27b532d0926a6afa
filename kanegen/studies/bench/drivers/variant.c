/* Driver of forward dynamics in a compiled library, for a model without loads and parameters; compile with
 * -DREAL=<type of the arrays>, or with -DDOUBLE_DOUBLE if the arrays hold sums of two doubles.
 *
 *     driver results|times STATES OUT|SECONDS LIBRARY FUNCTION
 *
 * The library is opened, not linked, so that the file that is timed is the file whose errors were measured. */
#include "driver.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef DOUBLE_DOUBLE
typedef struct {
    double high, low;
} real;
static real of(double value) { return (real){value, 0}; }
static double nearest(real value) { return value.high; }
#else
typedef REAL real;
static real of(double value) { return (real)value; }
static double nearest(real value) { return (double)value; }
#endif
typedef int One(const real *x, const real *y, const real *tau, real *ydot);
typedef size_t Many(size_t count, const real *x, const real *y, const real *tau, real *ydot);

/* Number of states of a batch. The next batch overwrites the results, as in a program that works block by block. */
enum { BLOCK = 32 };

static One *one;
static Many *many;
static size_t count, m, n;
static real *x, *y, *tau, *y_now, *ydot;
static double nothing;

/* The speeds of the next state depend on the accelerations of the last one, as in an integrator, so that calls
 * cannot overlap. The accelerations enter times zero; one that is not finite is left out. */
static void latency(size_t state)
{
    const size_t row = state * n;
    for (size_t i = 0; i < n; i++) {
        const double last = nearest(ydot[i]);
        y_now[i] = of(nearest(y[row + i]) + nothing * (last - last == 0 ? last : 0));
    }
    one(x + state * m, y_now, tau + row, ydot);
}

static void batch(size_t state)
{
    const size_t first = state - state % BLOCK, row = first * n;
    many(count - first < BLOCK ? count - first : BLOCK, x + first * m, y + row, tau + row, ydot);
}

static void give(size_t from, double *values)
{
    for (size_t i = 0; i < n; i++) values[i] = nearest(ydot[from * n + i]);
}

static void give_latency(size_t state, double *values)
{
    (void)state;
    give(0, values);
}

static void give_batch(size_t state, double *values)
{
    give(state % BLOCK, values);
}

static void fail(const char *what)
{
    fprintf(stderr, "%s\n", what);
    exit(2);
}

static real *reals(const double *values, size_t amount)
{
    real *memory = (real *)aligned_numbers(amount * sizeof(real) / sizeof(double) + 1);
    for (size_t i = 0; values && i < amount; i++) memory[i] = of(values[i]);
    return memory;
}

static void *found(void *library, const char *name, const char *ending)
{
    char whole[1024];
    if (snprintf(whole, sizeof whole, "%s%s", name, ending) >= (int)sizeof whole) fail("the name is too long");
    void *function = library ? dlsym(library, whole) : NULL;
    if (!function) fail(dlerror());
    return function;
}

void driver_setup(const States *states, int argc, char **argv)
{
    if (argc < 2) fail("the library and the function are missing");
    void *library = dlopen(argv[0], RTLD_NOW);
    *(void **)&one = found(library, argv[1], "");
    *(void **)&many = found(library, argv[1], "_batch");
    volatile double zero = 0;
    nothing = zero;
    count = states->count;
    m = states->m;
    n = states->n;
    x = reals(states->x, count * m);
    y = reals(states->y, count * n);
    tau = reals(states->tau, count * n);
    y_now = reals(NULL, n);
    ydot = reals(NULL, BLOCK * n);
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"latency", latency, give_latency, 0, 1},
        {"batch", batch, give_batch, 0, BLOCK},
    };
    every[0].size = every[1].size = n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
