/* Driver of dynibo, which is written in Rust; dynibo.rs has the functions that it calls. The model is a URDF file; the
 * name of a joint is the index of its coordinate in x, y and tau. */
#include "driver.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct Peer Peer;
Peer *peer_open(const char *path);
int peer_joint(const Peer *peer, size_t index);
int peer_equations(Peer *peer, size_t n, const double *q, const double *v, double *mass, double *bias);
int peer_dynamics(
    Peer *peer, size_t n, const double *q, const double *v, const double *tau, double *acceleration);

static States pool; /* in the order of dynibo */
static Peer *peer;
static int *place; /* index in x of every freedom */
static double *mass, *bias, *acceleration;

static void require(int failed)
{
    if (!failed) return;
    fprintf(stderr, "it refuses a state\n");
    exit(2);
}

static void equations(size_t state)
{
    const size_t row = state * pool.n;
    require(peer_equations(peer, pool.n, pool.x + row, pool.y + row, mass, bias));
}

static void dynamics(size_t state)
{
    const size_t row = state * pool.n;
    require(peer_dynamics(peer, pool.n, pool.x + row, pool.y + row, pool.tau + row, acceleration));
}

static void give_equations(size_t state, double *values)
{
    const size_t n = pool.n;
    (void)state;
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) values[(size_t)place[i] * n + (size_t)place[j]] = mass[i * n + j];
        values[n * n + (size_t)place[i]] = -bias[i];
    }
}

static void give_dynamics(size_t state, double *values)
{
    (void)state;
    for (size_t i = 0; i < pool.n; i++) values[place[i]] = acceleration[i];
}

static const double *ordered(const double *values)
{
    double *result = malloc(pool.count * pool.n * sizeof *result);
    for (size_t state = 0; state < pool.count; state++)
        for (size_t i = 0; i < pool.n; i++) result[state * pool.n + i] = values[state * pool.n + (size_t)place[i]];
    return result;
}

void driver_setup(const States *states, int argc, char **argv)
{
    (void)argc;
    peer = peer_open(argv[0]);
    if (!peer) exit(2);
    pool = *states;
    place = malloc(pool.n * sizeof *place);
    for (size_t i = 0; i < pool.n; i++) place[i] = peer_joint(peer, i);
    pool.x = ordered(states->x);
    pool.y = ordered(states->y);
    pool.tau = ordered(states->tau);
    mass = aligned_numbers(pool.n * pool.n);
    bias = aligned_numbers(pool.n);
    acceleration = aligned_numbers(pool.n);
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"equations", equations, give_equations, 0, 1},
        {"dynamics", dynamics, give_dynamics, 0, 1},
    };
    every[0].size = pool.n * pool.n + pool.n;
    every[1].size = pool.n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
