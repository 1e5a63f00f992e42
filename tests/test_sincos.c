/* test_sincos.c - the header's own sine and cosine, which it uses instead of libm's. One source for all
   scalars: -DRBD_REAL=float, -DRBD_LANES=n, nothing (double). Prints the largest error found. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "quiet_check.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* The bounds that rbd.h states at rbdi_sincos_array; twice as much beyond the limit. */
#if RBDI_REAL_KIND == 2
#define BOUND 1.0e-7
#define LIMIT 1e4
#define LARGEST FLT_MAX
#define SMALLEST FLT_MIN
#define STEP(x, to) nextafterf(x, to)
#else
#define BOUND 2.3e-16
#define LIMIT 1e6
#define LARGEST DBL_MAX
#define SMALLEST DBL_MIN
#define STEP(x, to) nextafter(x, to)
#endif

/* ---- the truth: sine and cosine with more digits than are judged ---- */

#ifdef HAVE_QUADMATH
__extension__ typedef __float128 wide;
void sincosq(wide x, wide *sine, wide *cosine);
static void wide_sincos(wide x, wide *s, wide *c) { sincosq(x, s, c); }
#else
typedef long double wide;
static void wide_sincos(wide x, wide *s, wide *c) {
    *s = sinl(x);
    *c = cosl(x);
}
#endif

/* ---- lanes ---- */

typedef RBD_REAL number; /* a scalar, or what a lane holds */

#ifdef RBD_LANES
enum { LANES = RBD_LANES };
static void put(rbd_real *x, int lane, number value) { (*x)[lane] = value; }
static number get(rbd_real x, int lane) { return x[lane]; }
#else
enum { LANES = 1 };
static void put(rbd_real *x, int lane, number value) {
    (void)lane;
    *x = value;
}
static number get(rbd_real x, int lane) {
    (void)lane;
    return x;
}
#endif

/* ---- the largest errors ---- */

struct worst {
    const char *what;
    double error, x;
};
static struct worst sine_within = {"sine up to the limit", 0, 0};
static struct worst cosine_within = {"cosine up to the limit", 0, 0};
static struct worst sine_beyond = {"sine beyond it", 0, 0};
static struct worst cosine_beyond = {"cosine beyond it", 0, 0};

static void judge(struct worst *w, double x, double found, wide truth) {
    const double error = fabs((double)(found - truth));
    const double bound = fabs(x) > LIMIT ? 2 * BOUND : BOUND;
    ck_assert_msg(error < bound, "%s: x = %.17g gives %.17g, error %.3g, bound %.3g", w->what, x, found,
                  error, bound);
    if (error > w->error) {
        w->error = error;
        w->x = x;
    }
}

static void judge_both(number x, number found_sine, number found_cosine) {
    const int beyond = fabs((double)x) > LIMIT;
    wide s, c;
    wide_sincos(x, &s, &c);
    judge(beyond ? &sine_beyond : &sine_within, (double)x, (double)found_sine, s);
    judge(beyond ? &cosine_beyond : &cosine_within, (double)x, (double)found_cosine, c);
}

static void print_worst(const struct worst *w) {
    printf("%-24s largest error %.3e at x = %.17g\n", w->what, w->error, w->x);
}

/* ---- arrays ---- */

/* Room for the longest array with its padding, and something behind it that must stay. */
enum { LONGEST = 40, ROOM = LONGEST + 3 * RBDI_CHUNK };
static rbd_real angle[ROOM], sine[ROOM], cosine[ROOM];

static int padded(int n) { return (n + RBDI_BATCH - 1) / RBDI_BATCH * RBDI_BATCH; }

/* Fills angles behind the first n, and all results. */
static void prepare(int n, number padding) {
    for (int i = 0; i < ROOM; i++)
        for (int lane = 0; lane < LANES; lane++) {
            if (i >= n) put(&angle[i], lane, padding);
            put(&sine[i], lane, 7);
            put(&cosine[i], lane, 7);
        }
}

static void expect_untouched(int from, int end) {
    for (int i = from; i < end; i++)
        for (int lane = 0; lane < LANES; lane++)
            ck_assert_msg(get(sine[i], lane) == 7 && get(cosine[i], lane) == 7,
                          "entry %d is no part of the batches but written", i);
}

static void compute(int n) {
#ifdef RBDI_POLYNOMIAL_SINCOS
    static rbd_real none[ROOM];
    rbdi_sincos_array(angle, none, 0, n, sine, cosine);
#else
    for (int i = 0; i < n; i++) rbdi_sincos(angle[i], &sine[i], &cosine[i]);
#endif
}

/* Judges the first n angles, whatever stands in the padding. */
static void judge_array(int n, number padding) {
    prepare(n, padding);
    compute(n);
    for (int i = 0; i < n; i++)
        for (int lane = 0; lane < LANES; lane++)
            judge_both(get(angle[i], lane), get(sine[i], lane), get(cosine[i], lane));
    expect_untouched(padded(n), ROOM);
}

#ifdef RBDI_POLYNOMIAL_SINCOS
START_TEST(parts_of_an_array_are_computed_in_whole_batches) {
    static rbd_real none[ROOM];
    for (int end = 0; end <= LONGEST; end++)
        for (int first = 0; first <= end; first++) {
            for (int i = 0; i < ROOM; i++)
                for (int lane = 0; lane < LANES; lane++)
                    put(&angle[i], lane, (number)(0.3 * i + 0.01 * lane));
            prepare(ROOM, 0);
            rbdi_sincos_array(angle, none, first, end, sine, cosine);
            for (int i = first; i < end; i++)
                for (int lane = 0; lane < LANES; lane++)
                    judge_both(get(angle[i], lane), get(sine[i], lane), get(cosine[i], lane));
            expect_untouched(0, first / RBDI_BATCH * RBDI_BATCH);
            expect_untouched(padded(end), ROOM);
        }
}
END_TEST
#endif

/* ---- a stream of angles, judged as soon as an array is full ---- */

static int waiting; /* numbers in the array, all lanes counted */

static void flush(void) {
    const int n = (waiting + LANES - 1) / LANES;
    for (int i = waiting; i < n * LANES; i++) put(&angle[i / LANES], i % LANES, 0);
    waiting = 0; /* first: a test that fails does not come back */
    if (n > 0) judge_array(n, 0);
}

static void feed(number x) {
    put(&angle[waiting / LANES], waiting % LANES, x);
    if (++waiting == LONGEST * LANES) flush();
}

/* x and its neighbours, and their negatives. */
static void feed_around(number x, int neighbours) {
    number above = x, below = x;
    feed(x);
    feed(-x);
    for (int i = 0; i < neighbours; i++) {
        above = STEP(above, LARGEST);
        below = STEP(below, -LARGEST);
        feed(above);
        feed(-above);
        feed(below);
        feed(-below);
    }
}

static uint64_t seed = 1;

/* Uniform in [0, 1): Marsaglia's xorshift of 64 bits. */
static double uniform(void) {
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) * 0x1p-53;
}

/* ---- tests ---- */

static const int count = 50000;

START_TEST(random_angles_of_every_size_are_within_the_bound) {
    for (int i = 0; i < count; i++) {
        feed((number)(4 * (2 * uniform() - 1)));
        feed((number)(0.999999 * LIMIT * (2 * uniform() - 1)));
        feed((number)(0.999999 * LIMIT * exp(-50 * uniform())));
    }
    flush();
}
END_TEST

/* Multiples of pi/4: of pi/2, where a result vanishes, and between, where the quadrant changes. The first
   with neighbours, then every seventh up to the limit: all places in a turn in turn. */
START_TEST(multiples_of_an_eighth_of_a_turn_are_within_the_bound) {
    const double step = 0.78539816339744830962;
    for (int k = 0; k < 2000; k++) feed_around((number)(k * step), 5);
    for (int k = 2000; k * step < LIMIT; k += 7) feed_around((number)(k * step), 0);
    flush();
}
END_TEST

/* Beyond: the angles come in order of size. */
START_TEST(the_limit_and_what_lies_beyond_are_within_the_bound) {
    feed_around((number)LIMIT, 100);
    flush();
    for (int i = 0; i < count; i++) feed((number)(LIMIT * exp(20.0 * i / count)));
    for (int i = 0; i < count; i++) feed((number)(LIMIT * exp(log(LARGEST / LIMIT) * i / count)));
    feed_around((number)1e22, 10);
    feed_around((number)LARGEST, 0);
    flush();
}
END_TEST

/* The polynomial of an angle this small is the angle. */
START_TEST(a_tiny_angle_is_its_own_sine) {
    const number tiny[] = {(number)0,          (number)-0.0,        (number)1e-10,
                           (number)-1e-30,     (number)SMALLEST,    (number)-SMALLEST,
                           STEP((number)0, 1), STEP((number)0, -1), (number)SMALLEST / 2};
    for (size_t i = 0; i < sizeof tiny / sizeof *tiny; i++) {
        rbd_real x = angle[0], s, c;
        for (int lane = 0; lane < LANES; lane++) put(&x, lane, tiny[i]);
        rbdi_sincos(x, &s, &c);
        for (int lane = 0; lane < LANES; lane++) {
            ck_assert_msg(get(s, lane) == tiny[i], "sine of %g is %g", (double)tiny[i], (double)get(s, lane));
            ck_assert_msg(get(c, lane) == 1, "cosine of %g is %.17g", (double)tiny[i], (double)get(c, lane));
        }
    }
}
END_TEST

START_TEST(what_is_no_number_gives_none_and_spoils_no_other_angle) {
    const number bad[] = {(number)HUGE_VAL, (number)-HUGE_VAL, (number)NAN};
    for (size_t b = 0; b < sizeof bad / sizeof *bad; b++)
        for (int n = 1; n <= LONGEST; n++) {
            const int at = n / 2, in_lane = n % LANES;
            for (int i = 0; i < n; i++)
                for (int lane = 0; lane < LANES; lane++)
                    put(&angle[i], lane, i == at && lane == in_lane ? bad[b] : (number)(10 * uniform()));
            prepare(n, 0);
            compute(n);
            ck_assert(isnan(get(sine[at], in_lane)) && isnan(get(cosine[at], in_lane)));
            for (int i = 0; i < n; i++)
                for (int lane = 0; lane < LANES; lane++)
                    if (i != at || lane != in_lane)
                        judge_both(get(angle[i], lane), get(sine[i], lane), get(cosine[i], lane));
        }
}
END_TEST

/* With one angle beyond the limit, or none (at = -1), and anything in the padding. */
static void judge_length(int n, int at) {
    const number padding[] = {(number)0, (number)1, (number)LARGEST, (number)HUGE_VAL, (number)NAN};
    for (size_t p = 0; p < sizeof padding / sizeof *padding; p++) {
        for (int i = 0; i < n; i++)
            for (int lane = 0; lane < LANES; lane++) put(&angle[i], lane, (number)(200 * uniform() - 100));
        if (at >= 0) put(&angle[at], at % LANES, (number)(1e6 * LIMIT));
        judge_array(n, padding[p]);
    }
}

START_TEST(arrays_of_every_length_are_within_the_bound) {
    for (int n = 1; n <= LONGEST; n++) {
        const int places[] = {-1, 0, n / 2, n - 1};
        for (size_t i = 0; i < sizeof places / sizeof *places; i++) judge_length(n, places[i]);
    }
}
END_TEST

START_TEST(a_single_angle_gives_the_bits_of_an_array) {
    for (int i = 0; i < LONGEST; i++)
        for (int lane = 0; lane < LANES; lane++) put(&angle[i], lane, (number)(200 * uniform() - 100));
    judge_array(LONGEST, 0);
    for (int i = 0; i < LONGEST; i++) {
        rbd_real s, c;
        rbdi_sincos(angle[i], &s, &c);
        for (int lane = 0; lane < LANES; lane++)
            ck_assert(get(s, lane) == get(sine[i], lane) && get(c, lane) == get(cosine[i], lane));
    }
}
END_TEST

/* Whole turns and right angles are exact: x and n right angles. */
START_TEST(right_angles_are_added_exactly) {
#ifdef RBDI_POLYNOMIAL_SINCOS
    for (int i = 0; i < 4000; i++) {
        const number x = (number)(LIMIT * exp(20 * (uniform() - 0.5)));
        rbd_real a = angle[0], k = a, s[4], c[4];
        for (int n = 0; n < 4; n++) {
            for (int lane = 0; lane < LANES; lane++) put(&a, lane, x), put(&k, lane, (number)n);
            rbdi_sincos_one(a, k, &s[n], &c[n]);
        }
        for (int n = 0; n < 3; n++)
            ck_assert(get(s[n + 1], 0) == get(c[n], 0) && get(c[n + 1], 0) == -get(s[n], 0));
    }
#endif
}
END_TEST

START_TEST(an_angle_beyond_the_limit_changes_no_other) {
    rbd_real s[LONGEST], c[LONGEST];
    for (int at = 0; at < LONGEST; at++) {
        for (int i = 0; i < LONGEST; i++)
            for (int lane = 0; lane < LANES; lane++) put(&angle[i], lane, (number)(200 * uniform() - 100));
        compute(LONGEST);
        for (int i = 0; i < LONGEST; i++) s[i] = sine[i], c[i] = cosine[i];
        put(&angle[at], at % LANES, (number)(1e6 * LIMIT));
        compute(LONGEST);
        for (int i = 0; i < LONGEST; i++)
            for (int lane = 0; lane < LANES; lane++)
                if (i != at || lane != at % LANES)
                    ck_assert(get(s[i], lane) == get(sine[i], lane) &&
                              get(c[i], lane) == get(cosine[i], lane));
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("sincos");
    TCase *c = tcase_create("sincos");
    tcase_set_timeout(c, 100);
    tcase_add_test(c, random_angles_of_every_size_are_within_the_bound);
    tcase_add_test(c, multiples_of_an_eighth_of_a_turn_are_within_the_bound);
    tcase_add_test(c, the_limit_and_what_lies_beyond_are_within_the_bound);
    tcase_add_test(c, a_tiny_angle_is_its_own_sine);
    tcase_add_test(c, what_is_no_number_gives_none_and_spoils_no_other_angle);
    tcase_add_test(c, arrays_of_every_length_are_within_the_bound);
#ifdef RBDI_POLYNOMIAL_SINCOS
    tcase_add_test(c, parts_of_an_array_are_computed_in_whole_batches);
#endif
    tcase_add_test(c, right_angles_are_added_exactly);
    tcase_add_test(c, an_angle_beyond_the_limit_changes_no_other);
    tcase_add_test(c, a_single_angle_gives_the_bits_of_an_array);
    suite_add_tcase(suite, c);
    SRunner *runner = srunner_create(suite);
    srunner_set_fork_status(runner, CK_NOFORK); /* the errors are kept in this process */
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    print_worst(&sine_within);
    print_worst(&cosine_within);
    print_worst(&sine_beyond);
    print_worst(&cosine_beyond);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
