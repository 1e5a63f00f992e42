/* record.h - rbd.h run with a scalar that records, and with doubles. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_RECORD_H
#define TOOLS_CODEGEN_RECORD_H

#include "function.h"

struct rbd_body;
struct rbd_constraint;

namespace codegen {

/* A robot, and what the functions take as arguments. */
struct robot {
    const rbd_body *bodies;
    int nb;
    const rbd_constraint *constraints;
    int nc;
    std::vector<std::vector<int>> stances; /* which of them hold; none: all */
    std::vector<unsigned char> actuated;   /* of constrained_id: its flags, or none */
    double gravity[3];
    bool f_ext, gravity_argument;
    bool reproducible; /* rbd.h's bits under RBD_REPRODUCIBLE */
    bool limbs_alike;  /* the same operations for limbs of one size, if it takes more of them */
    bool by_rows;      /* sums of rows are calls */
};

/* Of a body: where its joint stands in q and v. */
struct joint {
    int parent, iq, nq, iv, nv;
};
std::vector<joint> joints(const robot &r);

/* The names of all algorithms; of a body: "NAME:LINK". */
std::vector<std::string> algorithm_names();
bool takes_constraints(const std::string &name);
bool takes_stances(const std::string &name);

/* For constrained_id: joints without motors that are independent, those that are it best in random states. */
std::vector<bool> independent_joints(const robot &r, int stance);

/* The call that rbd.h makes for an algorithm, with constants of the model in double or float. Throws
   std::runtime_error where it cannot be recorded. */
function record_double(const robot &r, const std::string &algorithm);
function record_float(const robot &r, const std::string &algorithm);

/* States drawn at random, an array for each of `inputs` (the same array for the same name), and rbd.h's
   results for it in double. */
struct example {
    std::vector<std::vector<double>> in;
    std::vector<double> out;
    int stance, rows, rank; /* of the constraints */
};
example compute(const robot &r, const std::string &algorithm, unsigned state, int stance);
example compute(const robot &r, const std::string &algorithm, const std::vector<std::vector<double>> &in,
                int stance = 0);

} // namespace codegen
#endif
