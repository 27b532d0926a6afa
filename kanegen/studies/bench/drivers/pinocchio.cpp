// Driver of Pinocchio for [A] and {f}, and for {ydot} by two methods. pinocchio_model.h describes the first
// argument. A second argument asks for derivatives, too, of a model without free-flyers.
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/cholesky.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "pinocchio_model.h"

static Vector acceleration;

static void equations(std::size_t state)
{
    pin::crba(model, *data, q[state]);
    pin::nonLinearEffects(model, *data, q[state], v[state]);
}

static void aba(std::size_t state)
{
    pin::aba(model, *data, q[state], v[state], tau[state]);
    acceleration = data->ddq;
}

static void cholesky(std::size_t state)
{
    equations(state);
    pin::cholesky::decompose(model, *data);
    acceleration = tau[state] - data->nle;
    pin::cholesky::solve(model, *data, acceleration);
}

static void give_equations(std::size_t, double *values)
{
    const int n = model.nv;
    for (int i = 0; i < n; i++) {
        for (int j = i; j < n; j++)
            values[place[i] * n + place[j]] = values[place[j] * n + place[i]] = data->M(i, j);
        values[n * n + place[i]] = -data->nle[i];
    }
}

static void give_acceleration(std::size_t, double *values)
{
    for (int i = 0; i < model.nv; i++) values[place[i]] = acceleration[i];
}

static void derivatives(std::size_t state)
{
    pin::computeABADerivatives(model, *data, q[state], v[state], tau[state]);
}

// Copy the derivatives by x, y and tau side by side. Only the upper half of the inverse mass matrix is filled.
static void give_derivatives(std::size_t, double *values)
{
    const int n = model.nv;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double *row = values + place[i] * 3 * n;
            row[place[j]] = data->ddq_dq(i, j);
            row[n + place[j]] = data->ddq_dv(i, j);
            row[2 * n + place[j]] = data->Minv(std::min(i, j), std::max(i, j));
        }
}

// tau of a state is its acceleration here.
static void inverse_derivatives(std::size_t state)
{
    pin::computeRNEADerivatives(model, *data, q[state], v[state], tau[state]);
}

// Copy the derivatives by x, y and the acceleration, of which the last is [A] and has only its upper half.
static void give_inverse_derivatives(std::size_t, double *values)
{
    const int n = model.nv;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double *row = values + place[i] * 3 * n;
            row[place[j]] = data->dtau_dq(i, j);
            row[n + place[j]] = data->dtau_dv(i, j);
            row[2 * n + place[j]] = data->M(std::min(i, j), std::max(i, j));
        }
}

static std::vector<Task> tasks;

void driver_setup(const States *states, int argc, char **argv)
{
    read_model(argv[0]);
    data = new pin::Data(model);
    read_states(*states);
    const std::size_t n = model.nv;
    tasks = {{"equations", equations, give_equations, n * n + n, 1},
             {"aba", aba, give_acceleration, n, 1},
             {"cholesky", cholesky, give_acceleration, n, 1}};
    if (argc > 1) {
        tasks.push_back({"derivatives", derivatives, give_derivatives, 3 * n * n, 1});
        tasks.push_back({"inverse derivatives", inverse_derivatives, give_inverse_derivatives, 3 * n * n, 1});
    }
}

std::size_t driver_tasks(const Task **result)
{
    *result = tasks.data();
    return tasks.size();
}
