/* constrained.h - the sets of contacts of a robot, for run_time.h and lanes.h.
   SPDX-License-Identifier: MIT */
#include "../robots/contacts.h"
#include "rbd_constraints.h"

enum { SETS = ALGORITHMS - CONSTRAINED, MAX_CONTACTS = 4 };

static int floats(const rbd_model *m) {
    rbd_joint_info joint;
    return rbd_joint(m, 0, &joint) == RBD_OK && joint.type == RBD_FLOATING;
}

/* Fills the list; returns its length, 0 if the robot has no such set. */
static int contacts_of(const rbd_model *m, int algorithm, rbd_constraint list[MAX_CONTACTS]) {
    for (size_t k = 0; k < sizeof contact_sets / sizeof *contact_sets; k++) {
        const struct contact_set *s = &contact_sets[k];
        int found = s->algorithm == algorithm && floats(m);
        for (int i = 0; i < s->count && found; i++) {
            const struct contact *c = &s->contacts[i];
            const int body = rbd_body_index(m, c->body);
            found = body >= 0;
            list[i] = (c->flat ? rbd_flat_contact : rbd_point_contact)(body, c->point, NULL);
        }
        if (found) return s->count;
    }
    return 0;
}

/* Whether the robot has the contacts, if the algorithm asks for some. */
static int can(const void *model, int algorithm) {
    rbd_constraint list[MAX_CONTACTS];
    return algorithm < CONSTRAINED || contacts_of(model, algorithm, list) > 0;
}
