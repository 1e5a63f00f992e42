/* report.h - what the programs are asked for, and the rows of CSV that they print.
   SPDX-License-Identifier: MIT */
#ifndef RBD_BENCH_REPORT_H
#define RBD_BENCH_REPORT_H

#include <cstdio>
#include <cstdlib>
#include <cstring>

#define PASTE_(a, b) a##b
#define PASTE(a, b) PASTE_(a, b)
#define TEXT_(a) #a
#define TEXT(a) TEXT_(a)

#ifndef SCALAR
#define SCALAR float
#endif

/* The generated C in double that results are compared with. */
#define REFERENCE(function) PASTE(PASTE(ROBOT, _ref_), function)

struct options {
    bool check = false;     /* compare, and time one size only */
    bool profile = false;   /* one launch, for a profiler: nothing is compared or timed */
    int least_states = 256; /* sizes grow by four from here */
    int most_states = 1 << 22;
    int groups = 9;               /* of which the median counts */
    double least_seconds = 5e-4;  /* that a group takes */
    const char *only = nullptr;   /* one algorithm */
    const char *layout = nullptr; /* one layout */

    options(int argc, char **argv) {
        for (int k = 1; k < argc; ++k) {
            const bool more = k + 1 < argc;
            if (!std::strcmp(argv[k], "--check"))
                check = true;
            else if (!std::strcmp(argv[k], "--profile"))
                profile = true;
            else if (more && !std::strcmp(argv[k], "--most"))
                most_states = std::atoi(argv[++k]);
            else if (more && !std::strcmp(argv[k], "--least"))
                least_states = std::atoi(argv[++k]);
            else if (more && !std::strcmp(argv[k], "--only"))
                only = argv[++k];
            else if (more && !std::strcmp(argv[k], "--layout"))
                layout = argv[++k];
            else
                usage(argv[k]);
        }
        if (!check && !profile) return;
        most_states = least_states = most_states < 1 << 18 ? most_states : 1 << 18;
        groups = 3;
    }

    bool wants(const char *algorithm) const { return !only || !std::strcmp(only, algorithm); }
    bool wants_layout(const char *name) const { return !layout || !std::strcmp(layout, name); }

  private:
    static void usage(const char *argument) {
        std::fprintf(stderr,
                     "%s: options are --check, --profile, --least STATES, --most STATES, --only ALGORITHM, "
                     "--layout LAYOUT\n",
                     argument);
        std::exit(2);
    }
};

/* One result: `error` is the largest difference over the largest entry of its array, `seconds` those of
   one call. */
inline void print_row(const char *program, const char *algorithm, const char *layout, int states,
                      double error, bool right, double seconds, int bytes_a_state) {
    std::printf("%s,%s,%s,%s,%s,%d,%.1e,%s,%.4g,%.4g,%.4g\n", program, TEXT(ROBOT), TEXT(SCALAR), algorithm,
                layout, states, error, right ? "right" : "WRONG", seconds * 1e6, states / seconds,
                bytes_a_state * (states / seconds) * 1e-9);
    std::fflush(stdout);
}
#endif
