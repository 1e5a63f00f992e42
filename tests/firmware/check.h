/* check.h - stands in for Check (libcheck) on a microcontroller, as far as scalars.c uses it: the same tests
   run there, without processes, files or signals. The first failure ends the program.
   SPDX-License-Identifier: MIT */
#ifndef FIRMWARE_CHECK_H
#define FIRMWARE_CHECK_H

#include <stdio.h>
#include <stdlib.h>

enum { CK_NORMAL, CHECK_MAX_TESTS = 32 };

typedef struct TCase {
    void (*test[CHECK_MAX_TESTS])(void);
    const char *name[CHECK_MAX_TESTS];
    int tests;
} TCase;
typedef TCase *Suite; /* of one case */
typedef Suite SRunner;

static TCase check_case;
static Suite check_suite;
static const char *check_running;
static unsigned long check_assertions;

#define START_TEST(name) static void name(void)
#define END_TEST

#define ck_assert_msg(condition, ...)                                                                        \
    do {                                                                                                     \
        check_assertions++;                                                                                  \
        if (!(condition)) {                                                                                  \
            printf("FAILED %s: %s:%d: ", check_running, __FILE__, __LINE__);                                 \
            printf(__VA_ARGS__);                                                                             \
            printf("\n");                                                                                    \
            exit(EXIT_FAILURE);                                                                              \
        }                                                                                                    \
    } while (0)
#define ck_assert(condition) ck_assert_msg(condition, "%s", #condition)
#define ck_assert_int_eq(a, b) ck_assert_msg((a) == (b), "%s == %s", #a, #b)
#define ck_assert_int_gt(a, b) ck_assert_msg((a) > (b), "%s > %s", #a, #b)

static inline TCase *tcase_create(const char *name) {
    (void)name;
    return &check_case;
}
static inline void tcase_set_timeout(TCase *c, double seconds) {
    (void)c, (void)seconds; /* the emulator has one */
}
#define tcase_add_test(c, function) check_add(c, function, #function)
static inline void check_add(TCase *c, void (*test)(void), const char *name) {
    if (c->tests == CHECK_MAX_TESTS) {
        printf("FAILED: more than %d tests\n", CHECK_MAX_TESTS);
        exit(EXIT_FAILURE);
    }
    c->name[c->tests] = name;
    c->test[c->tests++] = test;
}
static inline Suite *suite_create(const char *name) {
    (void)name;
    return &check_suite;
}
static inline void suite_add_tcase(Suite *suite, TCase *c) {
    *suite = c;
}
static inline SRunner *srunner_create(Suite *suite) {
    return suite;
}
static inline void srunner_run_all(SRunner *runner, int verbosity) {
    (void)verbosity;
    for (int i = 0; i < (*runner)->tests; i++) {
        check_running = (*runner)->name[i];
        (*runner)->test[i]();
    }
    printf("%d tests passed, %lu assertions\n", (*runner)->tests, check_assertions);
}
static inline int srunner_ntests_failed(SRunner *runner) {
    return (*runner)->tests == 0; /* one that failed has ended the program */
}
static inline void srunner_free(SRunner *runner) {
    (void)runner;
}

#endif
