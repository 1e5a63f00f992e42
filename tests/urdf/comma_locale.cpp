/* comma_locale.cpp - C++'s global locale gets a comma wherever this runs; C's only if the system has one. */
#include "comma_locale.h"
#include <clocale>
#include <locale>

struct comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

void comma_locale(void) {
    std::locale::global(std::locale(std::locale::classic(), new comma));
    std::setlocale(LC_ALL, "de_DE.UTF-8");
}

void classic_locale(void) {
    std::locale::global(std::locale::classic());
    std::setlocale(LC_ALL, "C");
}
