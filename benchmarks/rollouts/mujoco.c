/* Driver of rollouts by MuJoCo's mj_step, without contacts, constraints and actuators, with two of its integrators. The
 * arguments are the model as an XML file, whose joints have one freedom and the name of its index in x, y and tau; the
 * length of a step (s); and the number of steps. */
#include "driver.h"

#include <mujoco/mujoco.h>

#include <stdio.h>
#include <stdlib.h>

static States pool;
static mjModel *model;
static mjData *data;
static int *place; /* index in x of every freedom */
static size_t steps;

static void rollout(size_t state, int integrator)
{
    const size_t row = state * pool.n;
    model->opt.integrator = integrator;
    mj_resetData(model, data);
    for (int i = 0; i < model->nv; i++) {
        data->qpos[i] = pool.x[row + (size_t)place[i]];
        data->qvel[i] = pool.y[row + (size_t)place[i]];
        data->qfrc_applied[i] = pool.tau[row + (size_t)place[i]];
    }
    for (size_t s = 0; s < steps; s++) mj_step(model, data);
}

static void rk4(size_t state)
{
    rollout(state, mjINT_RK4);
}

static void implicitfast(size_t state)
{
    rollout(state, mjINT_IMPLICITFAST);
}

static void give(size_t state, double *values)
{
    (void)state;
    for (int i = 0; i < model->nv; i++) {
        values[place[i]] = data->qpos[i];
        values[model->nv + place[i]] = data->qvel[i];
    }
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
    model->opt.timestep = atof(argv[1]);
    steps = (size_t)atol(argv[2]);
    data = mj_makeData(model);
    place = malloc(states->n * sizeof *place);
    for (int i = 0; i < model->nv; i++) place[i] = atoi(mj_id2name(model, mjOBJ_JOINT, model->dof_jntid[i]));
    pool = *states;
}

size_t driver_tasks(const Task **tasks)
{
    static Task every[] = {{"rk4", rk4, give, 0, 1}, {"implicitfast", implicitfast, give, 0, 1}};
    every[0].size = every[1].size = 2 * pool.n;
    *tasks = every;
    return sizeof every / sizeof *every;
}
