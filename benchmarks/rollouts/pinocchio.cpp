// Driver of rollouts by the classical Runge-Kutta method with Pinocchio's aba, for a model whose joints have one
// freedom each. pinocchio_model.h describes the first argument; then follow the length of a step (s) and the number
// of steps.
#include <pinocchio/algorithm/aba.hpp>

#include "pinocchio_model.h"

#include <cstdlib>

static double length;
static long steps;
static Vector x, y, x_stage, y_stage, a, x_rate, y_rate;

static void rollout(std::size_t state)
{
    x = q[state];
    y = v[state];
    const double half = 0.5 * length, sixth = length / 6.0;
    for (long s = 0; s < steps; s++) {
        y_rate = pin::aba(model, *data, x, y, tau[state]);
        x_rate = y;
        x_stage = x + half * y;
        y_stage = y + half * y_rate;
        for (int middle = 0; middle < 2; middle++) {
            const double to_next = middle ? length : half;
            a = pin::aba(model, *data, x_stage, y_stage, tau[state]);
            x_rate += 2.0 * y_stage;
            y_rate += 2.0 * a;
            x_stage = x + to_next * y_stage;
            y_stage = y + to_next * a;
        }
        a = pin::aba(model, *data, x_stage, y_stage, tau[state]);
        x += sixth * (x_rate + y_stage);
        y += sixth * (y_rate + a);
    }
}

static void give(std::size_t, double *values)
{
    for (int i = 0; i < model.nv; i++) {
        values[place[i]] = x[i];
        values[model.nv + place[i]] = y[i];
    }
}

static Task task = {"rk4", rollout, give, 0, 1};

void driver_setup(const States *states, int, char **argv)
{
    read_model(argv[0]);
    data = new pin::Data(model);
    read_states(*states);
    length = std::atof(argv[1]);
    steps = std::atol(argv[2]);
    task.size = 2 * model.nv;
    for (Vector *one : {&x, &y, &x_stage, &y_stage, &a, &x_rate, &y_rate}) one->setZero(model.nv);
}

std::size_t driver_tasks(const Task **tasks)
{
    *tasks = &task;
    return 1;
}
