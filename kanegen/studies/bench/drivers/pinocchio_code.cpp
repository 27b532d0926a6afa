// Pinocchio's own code generation: records its algorithms on symbols of CppADCodeGen and writes them as C.
//
//     pinocchio_code JOINTS FOLDER [derivatives]
//
// pinocchio_model.h describes JOINTS. Each file in FOLDER holds one function of all coordinates, speeds and forces
// in the order of kanegen. A third argument asks for derivatives, too.
#include <pinocchio/codegen/cppadcg.hpp>

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "pinocchio_model.h"

using Symbol = CppAD::cg::CG<double>;
using Number = CppAD::AD<Symbol>;
using Numbers = Eigen::Matrix<Number, Eigen::Dynamic, 1>;
using SymbolicModel = pin::ModelTpl<Number>;
using SymbolicData = pin::DataTpl<Number>;

struct State {
    Numbers q, v, tau;
};

using Algorithm = void (*)(const SymbolicModel &, SymbolicData &, const State &, std::vector<Number> &values);

static void equations(const SymbolicModel &tree, SymbolicData &at, const State &s, std::vector<Number> &values)
{
    pin::crba(tree, at, s.q);
    pin::nonLinearEffects(tree, at, s.q, s.v);
    const int n = tree.nv;
    values.resize(n * n + n);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            values[place[i] * n + place[j]] = at.M(std::min(i, j), std::max(i, j));
        values[n * n + place[i]] = -at.nle[i];
    }
}

static void dynamics(const SymbolicModel &tree, SymbolicData &at, const State &s, std::vector<Number> &values)
{
    pin::aba(tree, at, s.q, s.v, s.tau);
    values.resize(tree.nv);
    for (int i = 0; i < tree.nv; i++) values[place[i]] = at.ddq[i];
}

// Put three matrices side by side, the last of which has only its upper half.
template <class Matrix, class Half>
static void beside(const Matrix &by_x, const Matrix &by_y, const Half &last, std::vector<Number> &values)
{
    const int n = (int)place.size();
    values.resize(3 * n * n);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            Number *row = values.data() + place[i] * 3 * n;
            row[place[j]] = by_x(i, j);
            row[n + place[j]] = by_y(i, j);
            row[2 * n + place[j]] = last(std::min(i, j), std::max(i, j));
        }
}

static void derivatives(const SymbolicModel &tree, SymbolicData &at, const State &s, std::vector<Number> &values)
{
    pin::computeABADerivatives(tree, at, s.q, s.v, s.tau);
    beside(at.ddq_dq, at.ddq_dv, at.Minv, values);
}

static void inverse_derivatives(
    const SymbolicModel &tree, SymbolicData &at, const State &s, std::vector<Number> &values)
{
    pin::computeRNEADerivatives(tree, at, s.q, s.v, s.tau);
    beside(at.dtau_dq, at.dtau_dv, at.M, values);
}

// Record an algorithm and write the C function `name` of x, y and tau, one behind the other.
static void write(const std::string &folder, const std::string &name, Algorithm algorithm)
{
    const SymbolicModel tree = model.cast<Number>();
    SymbolicData at(tree);
    const int n = model.nv;
    std::vector<Number> inputs(3 * n, Number(0.0)), values;
    CppAD::Independent(inputs);
    State s{Numbers(n), Numbers(n), Numbers(n)};
    for (int i = 0; i < n; i++) {
        s.q[i] = inputs[place[i]];
        s.v[i] = inputs[n + place[i]];
        s.tau[i] = inputs[2 * n + place[i]];
    }
    algorithm(tree, at, s, values);
    CppAD::ADFun<Symbol> recorded(inputs, values);
    recorded.optimize();
    CppAD::cg::CodeHandler<double> handler;
    std::vector<Symbol> symbols(3 * n);
    handler.makeVariables(symbols);
    std::vector<Symbol> results = recorded.Forward(0, symbols);
    CppAD::cg::LanguageC<double> language("double");
    CppAD::cg::LangCDefaultVariableNameGenerator<double> names;
    std::ostringstream statements;
    handler.generateCode(statements, language, results, names);
    std::ofstream file(folder + "/" + name + ".c");
    file << "#include <math.h>\n\nvoid " << name << "(const double *x, double *y)\n{\n";
    file << "   double v[" << handler.getTemporaryVariableCount() + 1 << "];\n" << statements.str() << "}\n";
}

int main(int argc, char **argv)
{
    if (argc < 3) return 2;
    read_model(argv[1]);
    write(argv[2], "equations", equations);
    write(argv[2], "dynamics", dynamics);
    if (argc > 3) {
        write(argv[2], "derivatives", derivatives);
        write(argv[2], "inverse_derivatives", inverse_derivatives);
    }
}
