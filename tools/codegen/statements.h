/* statements.h - the C text of values and statements. SPDX-License-Identifier: MIT */
#ifndef TOOLS_CODEGEN_STATEMENTS_H
#define TOOLS_CODEGEN_STATEMENTS_H

#include "text.h"
#include <map>

namespace codegen {

class statements {
  public:
    std::vector<std::string> name; /* of each statement's value, once it has one */

    statements(const program &p, const target &t);

    std::string of(value x) const;        /* an operand */
    std::string of_angle(value x) const;  /* as one expression of the inputs */
    std::string statement(int i);         /* with the stores of what it computes; it gets a name */
    std::string stores_of_others() const; /* of results that are no statements */
    bool is_copied(value x) const;        /* a result that stands in rows */
    bool is_cleared(value x) const;       /* a zero, which is stored before all statements */
    bool is_cleared(const row_call::store &x) const { return !x.late && is_cleared(x.x); }
    void begin_block() { named = 0; } /* short names, for they are half of the text */

  private:
    const program &p;
    const target &t;
    int named = 0;                     /* statements of the block */
    std::map<wanted_angle, int> angle; /* its index among the angles */
    struct store {
        std::string array;
        size_t k;
        bool negative;
        int lane; /* of a vector; or -1 */
        uint32_t stances;
    };
    std::map<int, std::vector<store>> stores; /* of a node */

    void store_at(value x, const std::string &array, size_t k, uint32_t stances);
    std::string stores_of(int i) const;
    std::string leaf(int i) const;
    std::string elements(int i) const;
    std::string gathered(int i) const;
    std::string unsigned_of(int i) const;
    std::string sum(int i) const;
    std::string expression(int i) const;
};

} // namespace codegen
#endif
