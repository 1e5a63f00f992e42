// quad.h - rbd.h's results in quad precision, rounded to double; in: an array for each argument taken.
#include "../../tools/codegen/codegen.h"

std::vector<double> compute_quad(const codegen::robot &r, const std::string &name,
                                 const std::vector<std::vector<double>> &in, int stance);
