// pinocchio_write.cpp - has Pinocchio's code generation (pinocchio/codegen, with CppAD and CppADCodeGen)
// write C for one of the bench's robots: pinocchio_write ROBOT FOLDER. A file for each function of
// pinocchio_codegen.hpp; pinocchio_codegen.cpp calls them. SPDX-License-Identifier: MIT
#include <pinocchio/codegen/cppadcg.hpp> // before what includes Eigen
#include <cstring>
#include <fstream>
#include <memory>
#include <pinocchio/codegen/code-generator-base.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include "pinocchio_codegen.hpp"
#include "pinocchio_model.hpp"
#include "../../models/iiwa.h"
#include "../../models/hyq.h"
#include "../../models/atlas.h"

namespace {

// Longer functions are cut into C functions of so many statements: without, GCC takes more than seven minutes
// and 4 GB for derivatives of Atlas's forward dynamics, instead of half a minute. No more instructions are
// executed for it.
const size_t most_statements = 3000;

// The texts of a function by file name.
struct texts : CppAD::cg::ModelLibraryProcessor<double> {
    using ModelLibraryProcessor::ModelLibraryProcessor;
    const std::map<std::string, std::string> &of(CppAD::cg::ModelCSourceGen<double> &function) {
        return getSources(function);
    }
};

// As the classes of pinocchio/codegen/code-generator-algo.hpp, but: in the local convention, which is the
// faster one, where they have that of the world; with gravity as an argument; and derivatives of inverse
// dynamics without M.
class function : pinocchio::CodeGenBase<double> {
    const int algorithm;
    Eigen::DenseIndex written = 0;

    void put_upper(const ADMatrixXs &A) {
        for (int i = 0; i < ad_model.nv; i++)
            for (int j = i; j < ad_model.nv; j++) ad_Y[written++] = A(i, j);
    }

    void put_whole(const ADMatrixXs &A) {
        for (int i = 0; i < ad_model.nv; i++)
            for (int j = 0; j < ad_model.nv; j++) ad_Y[written++] = A(i, j);
    }

    void compute(const ADVectorXs &q, const ADVectorXs &v, const ADVectorXs &x) {
        using pinocchio::Convention;
        switch (algorithm) {
        case ID: ad_Y = pinocchio::rnea(ad_model, ad_data, q, v, x); break;
        case FD: ad_Y = pinocchio::aba(ad_model, ad_data, q, v, x, Convention::LOCAL); break;
        case MM: put_upper(pinocchio::crba(ad_model, ad_data, q, Convention::LOCAL)); break;
        case MINV: put_upper(pinocchio::computeMinverse(ad_model, ad_data, q)); break;
        case ID_DERIVATIVES:
            pinocchio::computeRNEADerivatives(ad_model, ad_data, q, v, x);
            put_whole(ad_data.dtau_dq);
            put_whole(ad_data.dtau_dv);
            break;
        case FD_DERIVATIVES:
            pinocchio::computeABADerivatives(ad_model, ad_data, q, v, x);
            put_whole(ad_data.ddq_dq);
            put_whole(ad_data.ddq_dv);
            put_whole(ad_data.Minv);
            break;
        }
    }

    void buildMap() override {
        const int nq = ad_model.nq, nv = ad_model.nv;
        ad_X.setZero();
        CppAD::Independent(ad_X);
        const ADVectorXs q = ad_X.head(nq), v = ad_X.segment(nq, nv), x = ad_X.segment(nq + nv, nv);
        ad_model.gravity.linear() = ad_X.tail(3);
        compute(q, v, x);
        ad_fun.Dependent(ad_X, ad_Y);
        ad_fun.optimize("no_compare_op");
    }

  public:
    function(const pinocchio::Model &m, const std::string &name, const codegen_function &f)
        : CodeGenBase(m, inputs_of(m), f.results(m.nv), name, name), algorithm(f.algorithm) {
        build_jacobian = false;
        initLib();
        cgen_ptr->setMaxAssignmentsPerFunc(most_statements);
    }

    static int inputs_of(const pinocchio::Model &m) { return m.nq + 2 * m.nv + 3; }

    // In one file: each text but the first without the declarations that all begin with. The first, which
    // calls the others, may be without this header.
    std::string source() {
        std::string all;
        for (const auto &[file, text] : texts(*libcgen_ptr).of(*cgen_ptr))
            if (file.find("_forward_zero") != file.npos)
                all += all.empty() ? "#include <math.h>\n" + text
                                   : text.substr(text.find("void " + file.substr(0, file.size() - 2)));
        return all;
    }
};

struct robot {
    const char *name;
    const rbd_body *bodies;
    int nb;
};
const robot robots[] = {
    {"iiwa", iiwa_bodies, IIWA_NB}, {"hyq", hyq_bodies, HYQ_NB}, {"atlas", atlas_bodies, ATLAS_NB}};

} // namespace

int main(int argc, char **argv) {
    for (const robot &r : robots) {
        if (argc != 3 || std::strcmp(r.name, argv[1]) != 0) continue;
        char text[160] = "";
        alignas(model) unsigned char memory[sizeof(model)];
        const void *m;
        if (model_build(r.bodies, r.nb, memory, sizeof memory, &m, text) != RBD_OK) {
            std::fprintf(stderr, "pinocchio_write: %s: %s\n", r.name, text);
            return 1;
        }
        for (const codegen_function &f : codegen_functions) {
            const std::string name = std::string("pinocchio_") + r.name + "_" + f.name;
            std::ofstream file(argv[2] + ("/" + name) + ".c");
            file << function(static_cast<const model *>(m)->m, name, f).source();
            if (!file.flush()) return std::perror(name.c_str()), 1;
        }
        return 0;
    }
    std::fprintf(stderr, "usage: pinocchio_write ROBOT FOLDER\n");
    return 1;
}
