/* spatial_frames.c - rbd_spatial.h with RBD_CHECK_FRAMES, as C and as C++: every call that takes two
   quantities tells of one in another frame, with its name, file, line and the two frames, and of nothing
   else; and the result is of the frame that follows. Prints what failed. */
#include <stdio.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif
void frame_error(const char *file, int line, const char *call, int found, int expected);
#ifdef __cplusplus
}
#endif
#define RBD_CHECK_FRAMES frame_error
#include "rbd_spatial.h"

enum { BASE = -1, HAND, TOOL };

static int failures, reports, reported_line, reported_found, reported_expected;
static const char *reported_file, *reported_call;

void frame_error(const char *file, int line, const char *call, int found, int expected) {
    reports++;
    reported_file = file;
    reported_line = line;
    reported_call = call;
    reported_found = found;
    reported_expected = expected;
}

static void expect_report(const char *call, int line, int found, int expected) {
    if (reports != 1 || strcmp(reported_file, __FILE__) != 0 || reported_line != line ||
        strcmp(reported_call, call) != 0 || reported_found != found || reported_expected != expected) {
        printf("FAILED: %s, line %d: %d reports, the last of %s\n", call, line, reports,
               reports ? reported_call : "none");
        failures++;
    }
    reports = 0;
}
static void expect_frame(const char *what, int frame, int expected) {
    if (frame == expected) return;
    printf("FAILED: %s is of frame %d, not %d\n", what, frame, expected);
    failures++;
}

#define WRONG(call, arguments, found, expected) \
    do { \
        (void)call arguments; \
        expect_report(#call, __LINE__, found, expected); \
    } while (0)

int main(void) {
    const rbd_real numbers[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 2, 3};
    const rbd_const com[3] = {1, 2, 3}, inertia[6] = {1, 0, 0, 1, 0, 1};
    const rbd_placement hand = rbd_placement_from_arrays(numbers, numbers + 9, HAND, BASE),
                        tool = rbd_placement_from_arrays(numbers, numbers + 9, TOOL, HAND);
    const rbd_motion v = rbd_motion_from_array(numbers, HAND), w = rbd_motion_from_array(numbers, BASE);
    const rbd_force f = rbd_force_from_array(numbers, HAND), g = rbd_force_from_array(numbers, BASE);
    const rbd_inertia i = rbd_inertia_of(2, com, inertia, HAND), k = rbd_inertia_of(2, com, inertia, BASE);

    WRONG(rbd_placement_compose, (tool, hand), BASE, TOOL);
    WRONG(rbd_motion_add, (v, w), BASE, HAND);
    WRONG(rbd_motion_up, (hand, w), BASE, HAND);
    WRONG(rbd_motion_down, (hand, v), HAND, BASE);
    WRONG(rbd_motion_cross, (v, w), BASE, HAND);
    WRONG(rbd_force_add, (f, g), BASE, HAND);
    WRONG(rbd_force_up, (hand, g), BASE, HAND);
    WRONG(rbd_force_down, (hand, f), HAND, BASE);
    WRONG(rbd_force_cross, (v, g), BASE, HAND);
    WRONG(rbd_power, (w, f), HAND, BASE);
    WRONG(rbd_inertia_add, (i, k), BASE, HAND);
    WRONG(rbd_inertia_up, (hand, k), BASE, HAND);
    WRONG(rbd_inertia_down, (hand, i), HAND, BASE);
    WRONG(rbd_inertia_times, (i, w), BASE, HAND);

    /* one in another, and all of them in order */
    expect_frame("compose",
                 rbd_placement_compose(hand, rbd_placement_compose(tool, rbd_placement_identity(7, TOOL))).of,
                 7);
    expect_frame("compose", rbd_placement_compose(hand, tool).in, BASE);
    expect_frame("inverse", rbd_placement_inverse(hand).of, BASE);
    expect_frame("inverse", rbd_placement_inverse(hand).in, HAND);
    expect_frame("motion up", rbd_motion_add(rbd_motion_up(hand, v), w).frame, BASE);
    expect_frame("motion down", rbd_motion_cross(rbd_motion_down(hand, w), rbd_motion_scale(2, v)).frame,
                 HAND);
    expect_frame("force up", rbd_force_add(rbd_force_up(hand, f), g).frame, BASE);
    expect_frame("force down", rbd_force_cross(v, rbd_force_scale(2, rbd_force_down(hand, g))).frame, HAND);
    expect_frame("inertia up", rbd_inertia_times(rbd_inertia_up(hand, i), w).frame, BASE);
    expect_frame("inertia down", rbd_inertia_add(i, rbd_inertia_down(hand, k)).frame, HAND);
    expect_frame("exp", rbd_placement_exp(v, TOOL).of, TOOL);
    expect_frame("exp", rbd_placement_exp(v, TOOL).in, HAND);
    expect_frame("log", rbd_placement_log(tool).frame, HAND);
    if (rbd_power(v, f) < 0 || reports) {
        printf("FAILED: %d reports of what is right\n", reports);
        failures++;
    }
    return failures != 0;
}
