// write.cpp - writes code of the first N of the chosen robots, NAME0_code.c and so on: all functions, with
// all arguments. usage: write NAME N double|float LANES LIMBS BLOCK long|short|reproducible BOUNDED FOLDER
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
        write(path + "_code.h", codegen::declarations(functions, t));
        write(path + "_code.c", "#include \"" + t.name + "_code.h\"\n" + codegen::definitions(functions, t));
    }
    return 0;
}
