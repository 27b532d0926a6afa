// The model and the states of the drivers of Pinocchio, header-only. The model comes from a table of joints rather
// than from a URDF file, so that it has the coordinates in which it is compared. A line is one joint, in depth-first
// order:
//
//     parent kind columns armatures  placement: 9 of R by rows, 3 of p
//     body: mass, 3 of the mass centre, 9 of the inertia
//
// `columns` are the indices of the joint's velocities in x, y and tau. For a free-flyer, x holds three
// translations and the angles 1-2-3 there, and y and tau hold Pinocchio's own velocities and forces. The first
// line is gravity.
#ifndef PINOCCHIO_MODEL_H
#define PINOCCHIO_MODEL_H

#include "driver.h"

#include <pinocchio/multibody.hpp>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;

static pin::Model model;
static pin::Data *data;
static std::vector<int> place; // index in x of every velocity
static std::vector<Vector> q, v, tau;

static pin::JointModel joint(const std::string &kind)
{
    if (kind == "RX") return pin::JointModelRX();
    if (kind == "RY") return pin::JointModelRY();
    if (kind == "RZ") return pin::JointModelRZ();
    if (kind == "PX") return pin::JointModelPX();
    if (kind == "PY") return pin::JointModelPY();
    if (kind == "PZ") return pin::JointModelPZ();
    if (kind == "translation") return pin::JointModelTranslation();
    if (kind == "free-flyer") return pin::JointModelFreeFlyer();
    std::cerr << "unknown joint " << kind << "\n";
    std::exit(2);
}

template <int Rows, int Columns> static Eigen::Matrix<double, Rows, Columns> read(std::istream &in)
{
    Eigen::Matrix<double, Rows, Columns> values;
    for (int i = 0; i < Rows; i++)
        for (int j = 0; j < Columns; j++) in >> values(i, j);
    return values;
}

static void read_model(const char *path)
{
    std::ifstream in(path);
    model.gravity.linear(read<3, 1>(in));
    std::string kind;
    std::size_t parent;
    while (in >> parent >> kind) {
        const pin::JointModel kinematics = joint(kind);
        for (int k = 0, column; k < kinematics.nv() && in >> column; k++) place.push_back(column);
        Vector armature(kinematics.nv());
        for (int k = 0; k < kinematics.nv(); k++) in >> armature[k];
        Eigen::Matrix3d rotation = read<3, 3>(in);
        Eigen::Vector3d position = read<3, 1>(in);
        auto id = model.addJoint(parent, kinematics, pin::SE3(rotation, position), std::to_string(model.njoints));
        model.armature.segment(model.joints[id].idx_v(), kinematics.nv()) = armature;
        double mass;
        in >> mass;
        Eigen::Vector3d centre = read<3, 1>(in);
        Eigen::Matrix3d inertia = read<3, 3>(in);
        model.appendBodyToJoint(id, pin::Inertia(mass, centre, inertia), pin::SE3::Identity());
    }
}

// Bring states into the order of Pinocchio. A free-flyer, which has nq > nv, gets a quaternion after its translation.
static void read_states(const States &states)
{
    for (std::size_t state = 0; state < states.count; state++) {
        const std::size_t row = state * states.n;
        Vector position = pin::neutral(model), velocity(model.nv), force(model.nv);
        for (pin::JointIndex id = 1; id < (pin::JointIndex)model.njoints; id++) {
            const auto &at = model.joints[id];
            const bool floating = at.nq() > at.nv();
            for (int k = 0; k < at.nv(); k++) {
                const int column = place[at.idx_v() + k];
                velocity[at.idx_v() + k] = states.y[row + column];
                force[at.idx_v() + k] = states.tau[row + column];
                if (!floating || k < 3) position[at.idx_q() + k] = states.x[row + column];
            }
            if (floating) {
                Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
                for (int k = 0; k < 3; k++)
                    turn = turn * Eigen::AngleAxisd(states.x[row + place[at.idx_v() + 3 + k]], Eigen::Vector3d::Unit(k));
                position.segment<4>(at.idx_q() + 3) = turn.coeffs();
            }
        }
        q.push_back(position);
        v.push_back(velocity);
        tau.push_back(force);
    }
}

#endif
