/* text.c - for Frama-C: the texts and the lookup by name, for any status, index and length of text, and names
   of up to three characters that are any. See README.md. */
#include "__fc_builtin.h"

#include <stdint.h>
#include <stdlib.h>

static void *own_array(size_t bytes) { return malloc(bytes); }
#include "arrays.h"

enum { LONGEST = 160 };

static void claim(int condition) {
    //@ assert holds: condition != 0;
}

/* NULL, or a string of up to three characters. */
static const char *any_name(char letters[4]) {
    Frama_C_make_unknown(letters, 3);
    letters[3] = 0;
    return Frama_C_interval(0, 1) ? letters : NULL;
}

static void texts(void) {
    static char name[4], field[4], cause[4];
    for (size_t size = 0; size <= LONGEST; size++) {
        rbd_finding finding;
        char *text = own_array(size);
        finding.status = (rbd_status)Frama_C_interval(INT32_MIN, INT32_MAX);
        finding.name = any_name(name), finding.field = any_name(field), finding.text = any_name(cause);
        finding.body = Frama_C_interval(INT32_MIN, INT32_MAX);
        claim(rbd_finding_text(&finding, text, size) == text);
        Frama_C_show_each_proved(size);
    }
}

static void by_index(const rbd_model *m, int index) {
    const int any = Frama_C_interval(INT32_MIN, INT32_MAX), of = rbd_dof_body(m, index);
    const int at = rbd_packed_index(m, index, any), across = rbd_packed_index(m, any, index);
    rbd_joint_info info;
    claim(of >= -1 && of < 2 && at >= -1 && at < rbd_packed_size(m) && across >= -1 &&
          across < rbd_packed_size(m));
    rbd_body_name(m, index), rbd_joint_name(m, index);
    claim(rbd_joint(m, index, &info) == (index >= 0 && index < 2 ? RBD_OK : RBD_ERR_INDEX));
}

static void prove_one(void) {
    static const rbd_body rod = {
        .parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, 1}};
    static unsigned char memory[1];
    rbd_body bodies[2] = {rod, rod};
    const rbd_model *m;
    static char letters[5][4];
    bodies[1].parent = 0;
    for (int i = 0; i < 2; i++) {
        bodies[i].name = any_name(letters[2 * i]);
        bodies[i].joint = any_name(letters[2 * i + 1]);
    }
    if (rbd_model_build(bodies, 2, memory, rbd_model_size(bodies, 2), &m, NULL) != RBD_OK) return;
    const char *sought = any_name(letters[4]);
    const int body = rbd_body_index(m, sought), joint = rbd_joint_index(m, sought);
    claim(body >= -1 && body < 2 && joint >= -1 && joint < 2);
    by_index(m, Frama_C_interval(INT32_MIN, -1));
    by_index(m, 0);
    by_index(m, 1);
    by_index(m, Frama_C_interval(2, INT32_MAX));
    Frama_C_show_each_proved(2);
}

int main(void) {
    texts();
    prove_one();
    return 0;
}
