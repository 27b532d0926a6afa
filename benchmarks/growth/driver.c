/* Time the call CALL for about argv[1] seconds, over a few states in turn, and print its nanoseconds. */
#define _POSIX_C_SOURCE 199309L
#include HEADER
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define STATES 8

static double states[STATES][3][FREEDOMS];
static double out[RESULTS];
static volatile double sink;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Uniform in (-1, 1): no angle comes near a quarter turn, where three free angles are singular. */
static double uniform(unsigned long *seed)
{
    *seed = (*seed * 1103515245UL + 12345UL) & 0x7fffffffUL;
    return (double)*seed / 1073741824.0 - 1.0;
}

static void evaluate(long count)
{
    for (long i = 0; i < count; ++i) {
        const double *x = states[i % STATES][0], *y = states[i % STATES][1], *tau = states[i % STATES][2];
        (void)y;
        (void)tau;
        CALL;
        sink = out[0];
    }
}

int main(int argc, char **argv)
{
    const double seconds = argc > 1 ? atof(argv[1]) : 0.05;
    unsigned long seed = 1;
    for (int i = 0; i < STATES; ++i)
        for (int j = 0; j < FREEDOMS; ++j)
            for (int k = 0; k < 3; ++k)
                states[i][k][j] = uniform(&seed);
    evaluate(STATES);
    for (long count = 1;; count *= 2) {
        const double start = now();
        evaluate(count);
        const double elapsed = now() - start;
        if (elapsed >= seconds) {
            printf("%.6g\n", 1e9 * elapsed / (double)count);
            return 0;
        }
    }
}
