/* Driver of one output of kanegen's C, for a model without loads and parameters, one state a call and in batches.
 *
 * Compile with -DHEADER=<"header of the model"> -DMODEL=<its name> -DOUTPUT=<name of the output>
 * -DSIZE=<number of entries> -DARRAYS=<arrays that the output reads: 1 x, 2 x and y, 3 x, y and tau or ydot>.
 */
#include "driver.h"

#include HEADER

#define JOINED(model, output, kind) model##_##output##kind
#define NAMED(model, output, kind) JOINED(model, output, kind)
#define SINGLE NAMED(MODEL, OUTPUT, )
#define BATCH NAMED(MODEL, OUTPUT, _batch)

#if ARRAYS == 1
#define READ(row) pool.x + (row)
#elif ARRAYS == 2
#define READ(row) pool.x + (row), pool.y + (row)
#else
#define READ(row) pool.x + (row), pool.y + (row), pool.tau + (row)
#endif

/* Number of states of a batch. The next batch overwrites the results, as in a program that works block by block. */
enum { BLOCK = 32 };

static States pool;
static double *values; /* of BLOCK states; single states use the first */

static void single(size_t state)
{
    const size_t row = state * pool.n;
    SINGLE(READ(row), values);
}

static void batch(size_t state)
{
    const size_t first = state - state % BLOCK, row = first * pool.n, left = pool.count - first;
    BATCH(left < BLOCK ? left : BLOCK, READ(row), values);
}

static void give(double *to, size_t place)
{
    for (size_t i = 0; i < SIZE; i++) to[i] = values[place * SIZE + i];
}

static void give_single(size_t state, double *to)
{
    (void)state;
    give(to, 0);
}

static void give_batch(size_t state, double *to)
{
    give(to, state % BLOCK);
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    (void)argv;
    pool = *states;
    values = aligned_numbers(BLOCK * SIZE);
}

size_t driver_tasks(const Task **tasks)
{
    static const Task every[] = {{"single", single, give_single, SIZE, 1}, {"batch", batch, give_batch, SIZE, BLOCK}};
    *tasks = every;
    return sizeof every / sizeof *every;
}
