/* Driver of MuJoCo, without contacts, constraints and actuators: it calls only the stages that the results need.
 * The model is an XML file; every joint has one freedom, and its name is the index of its coordinate in x, y and
 * tau. */
#include "driver.h"

#include <mujoco/mujoco.h>

#include <stdio.h>
#include <stdlib.h>

static States pool; /* in the order of MuJoCo */
static mjModel *model;
static mjData *data;
static int *place; /* index in x of every freedom */

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
    (void)argc;
    model = mj_loadXML(argv[0], NULL, error, sizeof error);
    for (char *at = error; *at; at++)
        if (*at == '\n') *at = ' ';
    if (!model || (size_t)model->nv != states->n || model->nq != model->nv) {
        fprintf(stderr, "%s\n", model ? "the model has other freedoms" : error);
        exit(2);
    }
    data = mj_makeData(model);
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
    };
    every[0].size = pool.n * pool.n + pool.n;
    every[1].size = pool.n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
