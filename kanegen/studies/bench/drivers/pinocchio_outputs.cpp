// Driver of Pinocchio for quantities beside [A], {f} and {ydot}. pinocchio_model.h describes the first argument. The
// second has the numbers of the joints that carry the bodies, by body. The third is the body whose frame is chosen,
// whose origin is held in contact; the others name the tasks.
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "pinocchio_model.h"

#include <map>
#include <sstream>

using Matrix = Eigen::MatrixXd;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

static std::vector<pin::JointIndex> carriers; // joint of each body
static pin::JointIndex chosen;
static Matrix jacobian;
static Vector vector;
static Matrix6 operational;
static std::vector<pin::RigidConstraintModel> contacts;
static std::vector<pin::RigidConstraintData> contact_data;

static void gravity_forces(std::size_t state)
{
    pin::computeGeneralizedGravity(model, *data, q[state]);
}

static void velocity_forces(std::size_t state)
{
    const auto gravity = model.gravity;
    model.gravity.setZero();
    pin::nonLinearEffects(model, *data, q[state], v[state]);
    model.gravity = gravity;
}

static void coriolis_matrix(std::size_t state)
{
    pin::computeCoriolisMatrix(model, *data, q[state], v[state]);
}

static void mass_matrix_inverse(std::size_t state)
{
    pin::computeMinverse(model, *data, q[state]);
}

static void frame_jacobians(std::size_t state)
{
    pin::computeJointJacobians(model, *data, q[state]);
    jacobian.setZero();
    pin::getJointJacobian(model, *data, chosen, pin::LOCAL_WORLD_ALIGNED, jacobian);
}

static void frame_bias_accelerations(std::size_t state)
{
    static const Vector still = Vector::Zero(model.nv);
    pin::forwardKinematics(model, *data, q[state], v[state], still);
    const pin::Motion a = pin::getClassicalAcceleration(model, *data, chosen, pin::LOCAL_WORLD_ALIGNED);
    vector.resize(6);
    vector << a.angular(), a.linear();
}

static void centroidal_momentum_matrix(std::size_t state)
{
    pin::computeCentroidalMap(model, *data, q[state]);
}

static void operational_inertia_inverse(std::size_t state)
{
    frame_jacobians(state);
    pin::computeMinverse(model, *data, q[state]);
    data->Minv.triangularView<Eigen::StrictlyLower>() =
        data->Minv.transpose().triangularView<Eigen::StrictlyLower>();
    operational.noalias() = jacobian * data->Minv * jacobian.transpose();
}

static void regressor(std::size_t state)
{
    pin::computeJointTorqueRegressor(model, *data, q[state], v[state], tau[state]);
}

static void contact_dynamics(std::size_t state)
{
    static pin::ProximalSettings settings(1e-14, 0.0, 1);
    pin::constraintDynamics(model, *data, q[state], v[state], tau[state], contacts, contact_data, settings);
}

// Copy a vector, with a sign, in the order of kanegen's freedoms.
static void placed(const Vector &from, double sign, double *to)
{
    for (int i = 0; i < model.nv; i++) to[place[i]] = sign * from[i];
}

// Copy a matrix with a column for each freedom, beginning with row `first`; the rows before it come last.
template <typename Columns> static void columns(const Columns &from, int first, double *to)
{
    const int rows = (int)from.rows(), n = model.nv;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < n; j++) to[i * n + place[j]] = from((i + first) % rows, j);
}

static void give_gravity_forces(std::size_t, double *to) { placed(data->g, -1, to); }
static void give_velocity_forces(std::size_t, double *to) { placed(data->nle, -1, to); }
static void give_contact_dynamics(std::size_t, double *to) { placed(data->ddq, 1, to); }
static void give_frame_jacobians(std::size_t, double *to) { columns(jacobian, 3, to); }
static void give_centroidal_momentum_matrix(std::size_t, double *to) { columns(data->Ag, 0, to); }

static void give_coriolis_matrix(std::size_t, double *to)
{
    for (int i = 0; i < model.nv; i++)
        for (int j = 0; j < model.nv; j++) to[place[i] * model.nv + place[j]] = data->C(i, j);
}

static void give_mass_matrix_inverse(std::size_t, double *to)
{
    for (int i = 0; i < model.nv; i++)
        for (int j = 0; j < model.nv; j++)
            to[place[i] * model.nv + place[j]] = data->Minv(std::min(i, j), std::max(i, j));
}

static void give_frame_bias_accelerations(std::size_t, double *to)
{
    for (int i = 0; i < 6; i++) to[i] = vector[i];
}

static void give_operational_inertia_inverse(std::size_t, double *to)
{
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) to[6 * i + j] = operational((i + 3) % 6, (j + 3) % 6);
}

static void give_regressor(std::size_t, double *to)
{
    const std::size_t width = 10 * carriers.size();
    for (int i = 0; i < model.nv; i++)
        for (std::size_t body = 0; body < carriers.size(); body++)
            for (int k = 0; k < 10; k++)
                to[place[i] * width + 10 * body + k] = data->jointTorqueRegressor(i, 10 * (carriers[body] - 1) + k);
}

struct Quantity {
    void (*run)(std::size_t);
    void (*result)(std::size_t, double *);
    std::size_t (*size)();
};

static std::size_t n() { return model.nv; }
static std::size_t square() { return n() * n(); }
static std::size_t six_rows() { return 6 * n(); }
static std::size_t six() { return 6; }
static std::size_t six_by_six() { return 36; }

static std::size_t ten_a_body() { return n() * 10 * carriers.size(); }

#define QUANTITY(name, size) {#name, {name, give_##name, size}}

static const std::map<std::string, Quantity> quantities = {
    QUANTITY(gravity_forces, n),
    QUANTITY(velocity_forces, n),
    QUANTITY(coriolis_matrix, square),
    QUANTITY(mass_matrix_inverse, square),
    QUANTITY(frame_jacobians, six_rows),
    QUANTITY(frame_bias_accelerations, six),
    QUANTITY(centroidal_momentum_matrix, six_rows),
    QUANTITY(operational_inertia_inverse, six_by_six),
    QUANTITY(regressor, ten_a_body),
    QUANTITY(contact_dynamics, n),
};

static std::vector<Task> tasks;

void driver_setup(const States *states, int argc, char **argv)
{
    read_model(argv[0]);
    data = new pin::Data(model);
    read_states(*states);
    std::istringstream numbers(argv[1]);
    for (pin::JointIndex id; numbers >> id;) carriers.push_back(id);
    chosen = carriers[std::stoul(argv[2]) - 1];
    jacobian.setZero(6, model.nv);
    contacts.emplace_back(pin::CONTACT_3D, model, chosen);
    contact_data.emplace_back(contacts[0]);
    pin::initConstraintDynamics(model, *data, contacts, contact_data);
    for (int k = 3; k < argc; k++) {
        const auto &[name, quantity] = *quantities.find(argv[k]);
        tasks.push_back({name.c_str(), quantity.run, quantity.result, quantity.size(), 1});
    }
}

std::size_t driver_tasks(const Task **result)
{
    *result = tasks.data();
    return tasks.size();
}
