/* main() of every driver; driver.h describes its command line. */
#define _POSIX_C_SOURCE 199309L
#include "driver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void fail(const char *what)
{
    fprintf(stderr, "%s\n", what);
    exit(2);
}

double *aligned_numbers(size_t count)
{
    char *memory = calloc(count + 8, sizeof(double));
    if (!memory) fail("no memory");
    return (double *)(memory + (64 - (uintptr_t)memory % 64) % 64);
}

static double *numbers(FILE *file, size_t count)
{
    double *values = malloc(count * sizeof *values);
    if (!values || fread(values, sizeof *values, count, file) != count) fail("cannot read the states");
    return values;
}

static States read_states(const char *path)
{
    int64_t sizes[3];
    States states;
    FILE *file = fopen(path, "rb");
    if (!file || fread(sizes, sizeof *sizes, 3, file) != 3) fail("cannot read the states");
    states.count = (size_t)sizes[0];
    states.m = (size_t)sizes[1];
    states.n = (size_t)sizes[2];
    states.x = numbers(file, states.count * states.m);
    states.y = numbers(file, states.count * states.n);
    states.tau = numbers(file, states.count * states.n);
    fclose(file);
    return states;
}

static void write_results(const Task *tasks, size_t number, size_t states, const char *path)
{
    FILE *file = fopen(path, "wb");
    if (!file) fail("cannot write the results");
    for (size_t state = 0; state < states; state++)
        for (size_t t = 0; t < number; t++) {
            double *values = malloc(tasks[t].size * sizeof *values);
            if (!values) fail("no memory");
            tasks[t].run(state);
            tasks[t].result(state, values);
            fwrite(values, sizeof *values, tasks[t].size, file);
            free(values);
        }
    if (fclose(file)) fail("cannot write the results");
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void pass(const Task *task, size_t states)
{
    for (size_t state = 0; state < states; state += task->block) task->run(state);
}

/* Return the mean nanoseconds of one evaluation, over whole passes through all states, after a first pass that
 * is not timed. */
static double nanoseconds(const Task *task, size_t states, double seconds)
{
    pass(task, states);
    size_t passes = 0;
    double start = now(), elapsed;
    do {
        pass(task, states);
        passes++;
        elapsed = now() - start;
    } while (elapsed < seconds);
    return 1e9 * elapsed / (double)(passes * states);
}

int main(int argc, char **argv)
{
    if (argc < 4) fail("usage: driver results|times STATES OUT|SECONDS [...]");
    States states = read_states(argv[2]);
    const Task *tasks;
    driver_setup(&states, argc - 4, argv + 4);
    size_t number = driver_tasks(&tasks);
    if (!strcmp(argv[1], "results")) write_results(tasks, number, states.count, argv[3]);
    else
        for (size_t t = 0; t < number; t++)
            printf("%s %.6g\n", tasks[t].name, nanoseconds(&tasks[t], states.count, atof(argv[3])));
    return 0;
}
