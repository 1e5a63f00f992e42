/* write_model NAME: writes the built model of models/NAME.h to standard output, as C tables that a
   program includes and that need no build at run time.
   SPDX-License-Identifier: MIT. */
#define RBD_IMPLEMENTATION
#include "../rbd.h"

#include "atlas.h"
#include "cart_pole.h"
#include "double_pendulum.h"
#include "hyq.h"
#include "iiwa.h"
#include "pendulum.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct robot {
    const char *name;
    const rbd_body *bodies;
    int nb;
} robot;

static const robot robots[] = {
    {"iiwa", iiwa_bodies, IIWA_NB},
    {"hyq", hyq_bodies, HYQ_NB},
    {"atlas", atlas_bodies, ATLAS_NB},
    {"pendulum", pendulum_bodies, PENDULUM_NB},
    {"double_pendulum", double_pendulum_bodies, DOUBLE_PENDULUM_NB},
    {"cart_pole", cart_pole_bodies, CART_POLE_NB},
};

/* The shortest text that reads back as the same double; whole numbers stand bare, others in RBD_C(),
   which makes them the model's scalar. */
static void number(double x)
{
    char text[32];
    if (x > -1e6 && x < 1e6 && x == (int)x) {
        printf("%d", (int)x);
        return;
    }
    for (int digits = 1; digits <= 17; ++digits) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (strtod(text, NULL) == x) break;
    }
    printf("RBD_C(%s)", text);
}

static void numbers(const double *x, int n)
{
    printf("{");
    for (int k = 0; k < n; ++k) {
        if (k) printf(", ");
        number(x[k]);
    }
    printf("}");
}

static void vector(rbdi_c3 v)
{
    const double x[3] = {v.x, v.y, v.z};
    numbers(x, 3);
}

static void symmetric(rbdi_csym s)
{
    const double x[6] = {s.xx, s.xy, s.xz, s.yy, s.yz, s.zz};
    numbers(x, 6);
}

static void list(const double *x, int n)
{
    for (int k = 0; k < n; ++k) {
        if (k) putchar(' ');
        number(x[k]);
        putchar(',');
    }
}

static void text(const char *s)
{
    if (!s) {
        printf("NULL");
        return;
    }
    putchar('"');
    for (; *s; ++s) {
        if (*s == '"' || *s == '\\') putchar('\\');
        putchar(*s);
    }
    putchar('"');
}

static const char *kind_name(int kind)
{
    static const char *const names[] = {"RBDI_REVOLUTE", "RBDI_REVOLUTE_CS", "RBDI_SCREW", "RBDI_BLOCK"};
    return names[kind];
}

static const char *body_of_link(const rbd_model *m, int link)
{
    for (int b = 0; b < m->nb; ++b) /* the body whose own joint moves the link comes first */
        if (m->frame[b].link == link && m->frame[b].name) return m->frame[b].name;
    return "part of a joint";
}

static void write_links(const char *name, const rbd_model *m)
{
    printf("/* parent iq iv block slot first end kind flags | gamma cos sin | cos sin alpha | cos sin beta |\n"
           "   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */\n");
    printf("static const rbdi_link %s_links[%d] = {\n", name, m->nl);
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        const double angles[] = {l->gamma, l->cg, l->sg, l->ca, l->sa, l->cb, l->sb};
        const double slide[] = {l->d, l->rho, l->kappa};
        printf("    {%d, %d, %d, %d, %d, %d, %d, %s, %d, /* %d: %s */\n     ", l->parent, l->iq, l->iv, l->block,
               l->slot, l->first, l->end, kind_name(l->kind), l->flags, i, body_of_link(m, i));
        list(angles, 7);
        printf("\n     ");
        vector(l->r);
        printf(", ");
        list(slide, 3);
        printf("\n     ");
        symmetric(l->S);
        printf(",\n     ");
        vector(l->h);
        printf(", ");
        number(l->m);
        printf(", ");
        number(l->mc);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_blocks(const char *name, const rbd_model *m)
{
    if (m->nblock == 0) return;
    printf("/* joint type, first axis, axes, identity | E */\n");
    printf("static const rbdi_block %s_blocks[%d] = {\n", name, m->nblock);
    for (int i = 0; i < m->nblock; ++i) {
        const rbdi_block *b = &m->block[i];
        printf("    {%d, %d, %d, %d, ", b->type, b->first, b->n, b->identity);
        numbers(b->E, 9);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_dofs(const char *name, const rbd_model *m)
{
    printf("/* body, dof before it, row, depth | dof at this solver position, its row | armature, damping, friction | inertia of what it moves */\n");
    printf("static const rbdi_dof %s_dofs[%d] = {\n", name, m->nv + m->nmimic);
    for (int i = 0; i < m->nv + m->nmimic; ++i) {
        const rbdi_dof *d = &m->dof[i];
        const double passive[] = {d->armature, d->damping, d->friction};
        printf("    {%d, %d, %d, %d, %d, %d, ", d->body, d->lambda, d->row, d->depth, d->here, d->row_here);
        list(passive, 3);
        putchar(' ');
        number(d->scale);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_mimics(const char *name, const rbd_model *m)
{
    if (m->nmimic == 0) return;
    printf("/* q and v of what is followed | ratio, offset */\n");
    printf("static const rbdi_mimic %s_mimics[%d] = {\n", name, m->nmimic);
    for (int i = 0; i < m->nmimic; ++i) {
        const rbdi_mimic *k = &m->mimic[i];
        printf("    {%d, %d, ", k->source_q, k->source_v);
        number(k->ratio);
        printf(", ");
        number(k->offset);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_frames(const char *name, const rbd_model *m)
{
    printf("/* names | link, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |\n"
           "   inertia about the com | lower, upper, velocity, effort */\n");
    printf("static const rbdi_frame %s_frames[%d] = {\n", name, m->nb);
    for (int i = 0; i < m->nb; ++i) {
        const rbdi_frame *f = &m->frame[i];
        const double limits[] = {f->lower, f->upper, f->velocity, f->effort};
        printf("    {");
        text(f->name);
        printf(", ");
        text(f->joint);
        printf(", %d, %d, %d, %d, %d, %d, /* %d */\n     ", f->link, f->type, f->iq, f->nq, f->iv, f->nv, i);
        numbers(f->E, 9);
        printf(",\n     ");
        vector(f->r);
        printf(", ");
        number(f->mass);
        printf(", ");
        vector(f->com);
        printf(",\n     ");
        symmetric(f->I);
        printf(",\n     ");
        list(limits, 3);
        putchar(' ');
        number(limits[3]);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_model(const char *name, const rbd_model *m)
{
    char upper[64];
    size_t k;
    int mimic = m->nmimic > 0, dense = m->nv * (m->nv + 1) / 2;
    for (k = 0; name[k] && k + 1 < sizeof upper; ++k) upper[k] = (char)toupper((unsigned char)name[k]);
    upper[k] = 0;
    printf("/* %s_model.h - the built model of %s.h, for flash: include rbd.h before, pass &%s_model.\n"
           "   SPDX-License-Identifier: MIT. Written by write_model.c: change %s.h instead.\n"
           "   Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */\n"
           "#ifndef %s_MODEL_H\n#define %s_MODEL_H\n\n"
           "#if RBD_MODEL_VERSION != %d\n"
           "#error \"%s_model.h was written for another version of rbd.h: write it again\"\n#endif\n\n"
           "/* clang-format off */\n\n",
           name, name, name, name, upper, upper, RBD_MODEL_VERSION, name);
    printf("/* Bytes for rbd_work_init, exactly. */\n#define %s_WORK_SIZE RBDI_WORK_BYTES(", upper);
    printf("%d, %d, %d, %d, %d, %d, %d, %d)\n\n", m->nl, m->nblock, m->nslot, m->nv + m->nmimic,
           mimic ? m->nq + m->nmimic : 0, m->nv, mimic ? dense : (int)m->nh, mimic ? (int)m->nh : 0);
    write_links(name, m);
    write_blocks(name, m);
    write_dofs(name, m);
    write_mimics(name, m);
    write_frames(name, m);
    printf("static const rbd_model %s_model = {\n"
           "    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), %d, %d, %d, /* nb, nq, nv */\n"
           "    %d, %d, %d, %d, %d, /* links, blocks, slots, mimics, packed entries */\n    ",
           name, m->nb, m->nq, m->nv, m->nl, m->nblock, m->nslot, m->nmimic, (int)m->nh);
    vector(m->gravity);
    printf(",\n    %s_links, ", name);
    if (m->nblock) printf("%s_blocks, ", name);
    else printf("NULL, ");
    printf("%s_dofs, ", name);
    if (m->nmimic) printf("%s_mimics, ", name);
    else printf("NULL, ");
    printf("%s_frames,\n};\n\n#endif\n", name);
}

int main(int argc, char **argv)
{
    const size_t n = sizeof robots / sizeof robots[0];
    for (size_t k = 0; argc == 2 && k < n; ++k) {
        const robot *r = &robots[k];
        const rbd_model *m;
        rbd_report report;
        void *memory;
        if (strcmp(argv[1], r->name) != 0) continue;
        memory = malloc(rbd_model_size(r->bodies, r->nb));
        if (rbd_model_build(r->bodies, r->nb, memory, rbd_model_size(r->bodies, r->nb), &m, &report)) {
            char sentence[200];
            fprintf(stderr, "write_model: %s\n", rbd_finding_text(&report.error, sentence, sizeof sentence));
            free(memory);
            return 1;
        }
        write_model(r->name, m);
        free(memory);
        return fflush(stdout) == 0 ? 0 : 1;
    }
    fprintf(stderr, "usage: write_model NAME > NAME_model.h   with NAME one of");
    for (size_t k = 0; k < n; ++k) fprintf(stderr, " %s", robots[k].name);
    fprintf(stderr, "\n");
    return 2;
}
