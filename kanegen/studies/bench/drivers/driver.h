/* The interface of every driver, which reads states and writes results or prints times.
 *
 *     driver results STATES OUT    write one row for each state, the results of all tasks in their order
 *     driver times STATES SECONDS  print a line "task nanoseconds" for each task, the mean over about SECONDS
 *
 * STATES is a file of three int64, the number of states and the lengths of x and of y, and then of doubles: all
 * x, all y and all tau. tau is as long as y.
 */
#ifndef DRIVER_H
#define DRIVER_H

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
    void (*run)(size_t state);                    /* compute the block of states that begins at `state` */
    void (*result)(size_t state, double *values); /* copy the result of one state of the last block */
    size_t size;                                  /* number of doubles of the result of one state */
    size_t block;                                 /* number of states that `run` computes; 1 without batches */
} Task;

/* Functions that each driver defines: `driver_setup` is called once, `driver_tasks` returns the number of tasks. */
void driver_setup(const States *states, int argc, char **argv);
size_t driver_tasks(const Task **tasks);

/* Allocate `count` zeros that begin on a cache line, where results are written fastest. */
double *aligned_numbers(size_t count);

#ifdef __cplusplus
}
#endif

#endif
