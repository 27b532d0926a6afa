/* What the drivers of kanegen's C share: names of generated functions, and blocks of states for batches. */
#ifndef KANEGEN_BLOCKS_H
#define KANEGEN_BLOCKS_H

#include "driver.h"

#define JOINED(model, name) model##_##name
#define NAMED(model, name) JOINED(model, name)

/* Number of states of a batch. The next batch overwrites the results, as in a program that works block by block. */
enum { BLOCK = 32 };

static States pool;

/* Return the first state of the block to which a state belongs. */
static inline size_t first_of(size_t state)
{
    return state - state % BLOCK;
}

/* Return the number of states of the block that begins at `first`. */
static inline size_t block(size_t first)
{
    return pool.count - first < BLOCK ? pool.count - first : BLOCK;
}

static inline double *copied(double *to, const double *from, size_t count)
{
    while (count--) *to++ = *from++;
    return to;
}

#endif
