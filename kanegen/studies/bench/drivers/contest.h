/* What every contestant's driver has in common: states in, results or times out.
 *
 *     driver results STATES OUT    one row of OUT for each state: every task's result, one task after the other
 *     driver times STATES SECONDS  a line "task nanoseconds" for each task, the mean over about SECONDS
 *
 * STATES is three int64, how many states there are, the elements of x and n, those of y and of tau; then all x,
 * all y and all tau, as doubles.
 */
#ifndef CONTEST_H
#define CONTEST_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    size_t count, m, n;
    const double *x, *y, *tau;
} States;

typedef struct {
    const char *name;
    void (*run)(size_t state);                    /* computes a state, and the others of its block */
    void (*result)(size_t state, double *values); /* fetches what `run` computed */
    size_t size;                                  /* doubles of one state's result */
    size_t block;                                 /* states that `run` computes, from a multiple of it on */
} Task;

/* Defined by each driver. `setup` is called once, `tasks` returns how many there are. */
void contest_setup(const States *states, int argc, char **argv);
size_t contest_tasks(const Task **tasks);

/* `count` zeros at the beginning of a cache line, where results are written fastest. */
double *aligned_numbers(size_t count);

#ifdef __cplusplus
}
#endif

#endif
