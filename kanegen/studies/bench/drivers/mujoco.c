/* Driver of MuJoCo, without contacts and constraints: it calls only the stages that the results need. The model is an
 * XML file; every joint has one freedom, and its name is the index of its coordinate in x, y and tau. A second
 * argument asks for derivatives by differences, for which every joint has a motor. */
#include "driver.h"

#include <mujoco/mujoco.h>

#include <stdio.h>
#include <stdlib.h>

static States pool; /* in the order of MuJoCo */
static mjModel *model;
static mjData *data;
static int *place; /* index in x of every freedom */
static int is_derived;

static void move(size_t state)
{
    const size_t row = state * pool.n;
    mju_copy(data->qpos, pool.x + row, model->nq);
    mju_copy(data->qvel, pool.y + row, model->nv);
}

/* Copy data->M, which is sparse, and data->qfrc_bias. */
static void equations(size_t state)
{
    move(state);
    mj_kinematics(model, data);
    mj_comPos(model, data);
    mj_makeM(model, data);
    mj_comVel(model, data);
    mj_rne(model, data, 0, data->qfrc_bias);
}

static void dynamics(size_t state)
{
    equations(state);
    mj_factorM(model, data);
    mju_sub(data->qfrc_smooth, pool.tau + state * pool.n, data->qfrc_bias, model->nv);
    mj_solveM(model, data, data->qacc, data->qfrc_smooth, 1);
}

/* Differences of one step, since MuJoCo has no function for the derivatives of accelerations: the speeds after a step of
 * the length h are v + h a. */
static const double EPSILON = 1e-6;
static double *transition, *by_control, *by_x, *by_y, *by_acceleration;

static void derivatives(size_t state)
{
    move(state);
    mju_copy(data->ctrl, pool.tau + state * pool.n, model->nu);
    mjd_transitionFD(model, data, EPSILON, 0, transition, by_control, NULL, NULL);
}

static void give_derivatives(size_t state, double *values)
{
    const int n = model->nv;
    const double h = model->opt.timestep;
    (void)state;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            const double *speed = transition + (n + i) * 2 * n;
            double *row = values + place[i] * 3 * n;
            row[place[j]] = speed[j] / h;
            row[n + place[j]] = (speed[n + j] - (i == j)) / h;
            row[2 * n + place[j]] = by_control[(n + i) * n + j] / h;
        }
}

static void inverse_derivatives(size_t state)
{
    move(state);
    mju_copy(data->qacc, pool.tau + state * pool.n, model->nv);
    mjd_inverseFD(model, data, EPSILON, 0, by_x, by_y, by_acceleration, NULL, NULL, NULL, NULL);
}

static void give_inverse_derivatives(size_t state, double *values)
{
    const int n = model->nv;
    (void)state;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) { /* each row of MuJoCo's matrices belongs to one variable */
            double *row = values + place[i] * 3 * n;
            row[place[j]] = by_x[j * n + i];
            row[n + place[j]] = by_y[j * n + i];
            row[2 * n + place[j]] = by_acceleration[j * n + i];
        }
}

static void give_equations(size_t state, double *values)
{
    const int n = model->nv;
    double *full = malloc(sizeof *full * (size_t)n * (size_t)n);
    (void)state;
    mj_fullM(model, data, full);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) values[place[i] * n + place[j]] = full[i * n + j];
        values[n * n + place[i]] = -data->qfrc_bias[i];
    }
    free(full);
}

static void give_dynamics(size_t state, double *values)
{
    (void)state;
    for (int i = 0; i < model->nv; i++) values[place[i]] = data->qacc[i];
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
    char error[300] = "";
    is_derived = argc > 1;
    model = mj_loadXML(argv[0], NULL, error, sizeof error);
    for (char *at = error; *at; at++)
        if (*at == '\n') *at = ' ';
    if (!model || (size_t)model->nv != states->n || model->nq != model->nv) {
        fprintf(stderr, "%s\n", model ? "the model has other freedoms" : error);
        exit(2);
    }
    data = mj_makeData(model);
    transition = aligned_numbers(4 * states->n * states->n);
    by_control = aligned_numbers(2 * states->n * states->n);
    by_x = aligned_numbers(states->n * states->n);
    by_y = aligned_numbers(states->n * states->n);
    by_acceleration = aligned_numbers(states->n * states->n);
    place = malloc(states->n * sizeof *place);
    for (int i = 0; i < model->nv; i++) place[i] = atoi(mj_id2name(model, mjOBJ_JOINT, model->dof_jntid[i]));
    pool = *states;
    pool.x = ordered(states->x);
    pool.y = ordered(states->y);
    pool.tau = ordered(states->tau);
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {
        {"equations", equations, give_equations, 0, 1},
        {"dynamics", dynamics, give_dynamics, 0, 1},
        {"derivatives", derivatives, give_derivatives, 0, 1},
        {"inverse derivatives", inverse_derivatives, give_inverse_derivatives, 0, 1},
    };
    every[0].size = pool.n * pool.n + pool.n;
    every[1].size = pool.n;
    every[2].size = every[3].size = 3 * pool.n * pool.n;
    *tasks = every;
    return is_derived ? 4 : 2;
}
