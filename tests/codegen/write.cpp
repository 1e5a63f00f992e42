// write.cpp - writes code of the first N of the chosen robots, NAME0_code.c and so on: all functions, with
// all arguments. usage: write NAME N double|float LANES LIMBS BLOCK long|short|reproducible|cuda BOUNDED FOLDER
// cuda: NAME0_code.cuh, and NAME0_code.cpp, whose functions in C call the kernels on a host.
#include "../../tools/codegen/codegen.h"
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" const rbd_body *chosen_robot(int index, int *nb, const rbd_constraint **constraints, int *nc,
                                        unsigned char **actuated, int *nv);

static void write(const std::string &path, const std::string &text) {
    FILE *file = std::fopen(path.c_str(), "w");
    if (!file || std::fputs(text.c_str(), file) < 0 || std::fclose(file) != 0) std::exit(1);
}

/* A function as in C, by its kernel for one state. */
static std::string shim(const std::string &robot, const codegen::function &f, const std::string &scalar) {
    const bool has_status = !f.pivots.empty();
    std::string arguments, names;
    for (const codegen::array &a : f.arrays()) {
        arguments += ", " + scalar + " *" + a.name;
        names += ", " + a.name;
    }
    return "extern \"C\" int " + robot + "_" + f.name + "(" + arguments.substr(2) +
           ") {\n    int status = 0;\n    " + robot + "::" + f.name + "_kernel<rbd::columns>(1" + names +
           (has_status ? ", &status" : "") + ");\n    return status;\n}\n";
}

static void write_cuda(const std::string &path, const codegen::target &t, const codegen::robot &r,
                       const std::vector<codegen::tested> &functions) {
    std::string upper = t.name, shims = "#include \"" + t.name + "_code.cuh\"\n";
    int nq = 0, nv = 0;
    for (char &c : upper) c = char(toupper(static_cast<unsigned char>(c)));
    for (const codegen::joint &j : codegen::joints(r)) nq += j.nq, nv += j.nv;
    write(path + "_code.cuh", "enum { " + upper + "_NB = " + std::to_string(r.nb) + ", " + upper +
                                  "_NQ = " + std::to_string(nq) + ", " + upper +
                                  "_NV = " + std::to_string(nv) + " };\n" + codegen::cuda_text(functions, t));
    for (const codegen::tested &x : functions) shims += shim(t.name, x.f, t.is_float ? "float" : "double");
    write(path + "_code.cpp", shims);
}

int main(int argc, char **argv) {
    if (argc != 10) return 2;
    for (int k = 0; k < std::atoi(argv[2]); k++) {
        codegen::target t = {};
        codegen::robot r = {};
        unsigned char *actuated;
        int nv;
        r.bodies = chosen_robot(k, &r.nb, &r.constraints, &r.nc, &actuated, &nv);
        r.actuated.assign(actuated, actuated + nv);
        r.f_ext = r.gravity_argument = true;
        t.name = argv[1] + std::to_string(k);
        t.is_float = std::strcmp(argv[3], "float") == 0;
        t.lanes = std::atoi(argv[4]);
        t.limbs = codegen::like_limbs(codegen::joints(r), std::atoi(argv[5]));
        t.block = std::atoi(argv[6]);
        t.is_bounded = std::atoi(argv[8]) != 0;
        t.is_cuda = std::strcmp(argv[7], "cuda") == 0;
        t.long_sums = std::strcmp(argv[7], "long") == 0;
        t.is_reproducible = r.reproducible = std::strcmp(argv[7], "reproducible") == 0;
        r.limbs_alike = t.limbs > 1;
        r.by_rows = t.lanes == 1 && t.long_sums;
        std::vector<codegen::tested> functions;
        for (std::string name : codegen::algorithm_names()) {
            if ((name == "constrained_id" || name == "delta") && t.is_reproducible) continue;
            name = name.substr(0, name.find("LINK")) + (name.find("LINK") != name.npos ? "tip" : "");
            const codegen::function f =
                t.is_float ? codegen::record_float(r, name) : codegen::record_double(r, name);
            functions.push_back(
                {r.limbs_alike ? codegen::pack_limbs(f, codegen::joints(r), t.limbs) : f, {}, 0, 1});
        }
        const std::string path = argv[9] + ("/" + t.name);
        if (t.is_cuda) {
            write_cuda(path, t, r, functions);
            continue;
        }
        write(path + "_code.h", codegen::declarations(functions, t));
        write(path + "_code.c", "#include \"" + t.name + "_code.h\"\n" + codegen::definitions(functions, t));
    }
    return 0;
}
