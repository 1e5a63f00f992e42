/* codegen.h - functions of one robot as straight-line C: recorded from rbd.h, and written. The interface.
   SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_CODEGEN_H
#define TOOLS_CODEGEN_CODEGEN_H

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
    bool by_rows;      /* sums of rows are calls; not with lanes, short sums or reproducible */
};

/* The names of all algorithms; of a body: "NAME:LINK". */
std::vector<std::string> algorithm_names();
std::string name_in_c(std::string name); /* of "jacobian:left foot": "jacobian_left_foot" */
bool takes_constraints(const std::string &name);
bool takes_stances(const std::string &name);

/* The call that rbd.h makes for an algorithm, with constants of the model in double or float. Throws
   std::runtime_error where it cannot be recorded. */
function record_double(const robot &r, const std::string &algorithm);
function record_float(const robot &r, const std::string &algorithm);

/* For constrained_id: independent joints without motors, those that depend least on others in random
   states. */
std::vector<bool> independent_joints(const robot &r, int stance);

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

/* ---- like limbs of one state as lanes ---- */

/* Of a body: where its joint stands in q and v. */
struct joint {
    int parent, iq, nq, iv, nv;
};
std::vector<joint> joints(const robot &r);

/* How many limbs of this robot, up to `most`, are best computed at once: 4, 2, or 1 if none are alike. */
int like_limbs(const std::vector<joint> &joints, int most);

/* The same function: what is done alike to `width` like limbs is done to vectors. */
function pack_limbs(const function &f, const std::vector<joint> &joints, int width);

/* ---- the text of a set of functions ---- */

struct target {
    std::string name;          /* what all names begin with */
    bool is_float, is_bounded; /* is_bounded: no angle is beyond what the polynomials take */
    bool is_reproducible;      /* the same bits wherever it is compiled: functions are of exact graphs */
    bool long_sums;            /* of up to eight terms: for machines that run several instructions at once */
    bool is_cuda;              /* C++ for CUDA: angles are bounded, sums short, and a block has all */
    int lanes;                 /* 1: plain scalars */
    int limbs;                 /* like limbs of a state at once; 1: none are */
    int block;                 /* most statements of one C function */
};

/* A function, and states with rbd.h's results for them. */
struct tested {
    function f;
    std::vector<example> examples;
    double tolerance; /* of the self-test, relative to the largest result of an array, or to `least` */
    double least;
};

std::string declarations(const std::vector<tested> &functions, const target &t);
std::string definitions(const std::vector<tested> &functions, const target &t);
std::string cuda_text(const std::vector<tested> &functions, const target &t); /* of a file without the head */

/* A main that calls a function at rest at q, and how to compile it. */
std::string example_command(const std::string &path); /* of the files: FOLDER/NAME */
std::string example_text(const function &f, const target &t, const std::vector<double> &q,
                         const std::vector<double> &gravity);

} // namespace codegen
#endif
