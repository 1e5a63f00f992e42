/* The built model of a robot as C tables, which need no build at run time. SPDX-License-Identifier: MIT */
#include "print.h"
#include <stdio.h>

/* Whole numbers stand bare, others in RBD_C(), which makes them the model's scalar. */
static void number(double x) {
    char text[NUMBER_SIZE];
    printf(x > -1e6 && x < 1e6 && x == (int)x ? "%s" : "RBD_C(%s)", number_text(x, text));
}

static void numbers(const double *x, int n) {
    printf("{");
    for (int k = 0; k < n; ++k) {
        if (k) printf(", ");
        number(x[k]);
    }
    printf("}");
}

static void vector(rbdi_c3 v) {
    const double x[3] = {v.x, v.y, v.z};
    numbers(x, 3);
}

static void symmetric(rbdi_csym s) {
    const double x[6] = {s.xx, s.xy, s.xz, s.yy, s.yz, s.zz};
    numbers(x, 6);
}

static void list(const double *x, int n) {
    for (int k = 0; k < n; ++k) {
        if (k) putchar(' ');
        number(x[k]);
        putchar(',');
    }
}

static const char *kind_name(int kind) {
    static const char *const names[] = {"RBDI_REVOLUTE", "RBDI_REVOLUTE_CS", "RBDI_SCREW", "RBDI_BLOCK"};
    return names[kind];
}

static const char *body_of_link(const rbd_model *m, int link) {
    for (int b = 0; b < m->nb; ++b) /* the body whose own joint moves the link comes first */
        if (m->frame[b].link == link && m->frame[b].name) return m->frame[b].name;
    return "part of a joint";
}

/* A link's flags, by name. */
static void write_flags(int flags) {
    static const struct {
        int flag;
        const char *name;
    } names[] = {{RBDI_BRANCH_TURN, "RBDI_BRANCH_TURN"}, {RBDI_SHIFT_XYZ, "RBDI_SHIFT_XYZ"},
                 {RBDI_SHIFT_Z, "RBDI_SHIFT_Z"},         {RBDI_MASS_KEPT, "RBDI_MASS_KEPT"},
                 {RBDI_ARMATURE, "RBDI_ARMATURE"},       {RBDI_ROOT, "RBDI_ROOT"},
                 {RBDI_SLIDES, "RBDI_SLIDES"},           {RBDI_TWIST_90, "RBDI_TWIST_90"},
                 {RBDI_TWIST_0, "RBDI_TWIST_0"},         {RBDI_SHIFT_R, "RBDI_SHIFT_R"},
                 {RBDI_OFF_CHAIN, "RBDI_OFF_CHAIN"}};
    const char *between = "";
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i)
        if (flags & names[i].flag) {
            printf("%s%s", between, names[i].name);
            between = " | ";
        }
    if (!*between) putchar('0');
}

static void write_links(const char *name, const rbd_model *m) {
    printf("/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin "
           "alpha | cos sin beta |\n"
           "   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */\n");
    printf("static RBDI_THERE const rbdi_link %s_links[%d] = {\n", name, m->nl);
    for (int i = 0; i < m->nl; ++i) {
        const rbdi_link *l = &m->link[i];
        const double angles[] = {l->cg, l->sg, l->quarters, l->gamma, l->ca, l->sa, l->cb, l->sb};
        const double slide[] = {l->d, l->rho, l->kappa};
        printf("    {%d, %d, %d, %d, %d, %d, %d, %s, /* %d: ", l->parent, l->iq, l->iv, l->block, l->branch,
               l->first, l->end, kind_name(l->kind), i);
        print_in_comment(body_of_link(m, i));
        printf(" */\n     ");
        write_flags(l->flags);
        printf(",\n     ");
        list(angles, 8);
        printf("\n     ");
        vector(l->r);
        printf(", ");
        list(slide, 3);
        printf("\n     ");
        symmetric(l->Sigma);
        printf(",\n     ");
        vector(l->h);
        printf(", ");
        number(l->mass);
        printf(", ");
        number(l->subtree_mass);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_blocks(const char *name, const rbd_model *m) {
    if (m->nblock == 0) return;
    printf("/* joint type, first axis, axes, identity | E */\n");
    printf("static RBDI_THERE const rbdi_block %s_blocks[%d] = {\n", name, m->nblock);
    for (int i = 0; i < m->nblock; ++i) {
        const rbdi_block *b = &m->block[i];
        printf("    {%d, %d, %d, %d, ", b->type, b->first, b->n, b->identity);
        numbers(b->E, 9);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_dofs(const char *name, const rbd_model *m) {
    printf("/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |\n"
           "   armature, damping, friction | inertia of what it moves */\n");
    printf("static RBDI_THERE const rbdi_dof %s_dofs[%d] = {\n", name, m->nv + m->nmimic);
    for (int i = 0; i < m->nv + m->nmimic; ++i) {
        const rbdi_dof *d = &m->dof[i];
        const double passive[] = {d->armature, d->damping, d->friction};
        printf("    {%d, %d, %d, %d, %d, %d, ", d->body, d->lambda, (int)d->row, d->depth, d->before,
               d->level);
        list(passive, 3);
        putchar(' ');
        number(d->scale);
        printf("},\n");
    }
    printf("};\n\n");
}

static void write_order(const char *name, const rbd_model *m) {
    printf("/* the dofs as the solver meets them: dof, its row */\n");
    printf("static RBDI_THERE const rbdi_order %s_order[%d] = {\n   ", name, m->nv + m->nmimic);
    for (int i = 0; i < m->nv + m->nmimic; ++i)
        printf(" {%d, %d},%s", m->order[i].dof, (int)m->order[i].row, i % 8 == 7 ? "\n   " : "");
    printf("\n};\n\n");
}

static void write_nodes(const char *name, const rbd_model *m) {
    printf("/* the dofs of the matrix depth first: dof, descendants, row */\n");
    printf("static RBDI_THERE const rbdi_node %s_nodes[%d] = {\n   ", name, m->nv);
    for (int i = 0; i < m->nv; ++i)
        printf(" {%d, %d, %d},%s", m->node[i].dof, m->node[i].descendants, (int)m->node[i].row,
               i % 6 == 5 ? "\n   " : "");
    printf("\n};\n\n");
}

static void write_mimics(const char *name, const rbd_model *m) {
    if (m->nmimic == 0) return;
    printf("/* q and v of what is followed | ratio, offset */\n");
    printf("static RBDI_THERE const rbdi_mimic %s_mimics[%d] = {\n", name, m->nmimic);
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

static void write_frames(const char *name, const rbd_model *m) {
    printf("/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | "
           "com |\n"
           "   inertia about the com | lower, upper, velocity, effort */\n");
    printf("static RBDI_THERE const rbdi_frame %s_frames[%d] = {\n", name, m->nb);
    for (int i = 0; i < m->nb; ++i) {
        const rbdi_frame *f = &m->frame[i];
        const double limits[] = {f->lower, f->upper, f->velocity, f->effort};
        printf("    {");
        print_c_string(f->name);
        printf(", ");
        print_c_string(f->joint);
        printf(", %d, %d, %d, %d, %d, %d, %d, /* %d */\n     ", f->link, f->parent, f->type, f->iq, f->nq,
               f->iv, f->nv, i);
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

static void write_work_size(const char *name, const rbd_model *m) {
    printf("/* Bytes for rbd_work_init, exactly. */\n#define ");
    print_upper(name);
    printf("_WORK_SIZE RBDI_WORK_BYTES(%d, %d, %d, %d, %d, %d, %d)\n\n", m->nl, m->nblock, m->nbranch,
           m->nv + m->nmimic, m->nmimic ? m->nq + m->nmimic : 0, m->nv, (int)(m->nh + m->nhx));
}

/* Before rbd.h the file gives the features alone, for RBD_FEATURES. */
static void write_features(const char *name, const rbd_model *m) {
    printf("#ifndef ");
    print_upper(name);
    printf("_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */\n#define ");
    print_upper(name);
    printf("_FEATURES 0x%lxu\n#endif\n\n", (unsigned long)m->features);
}

static void write_head(const robot *r, const char *name) {
    printf("/* %s_model.h - the built model of ", name);
    print_in_comment(r->urdf.name);
    printf(", for flash: include rbd.h before, pass &%s_model.\n", name);
    print_origin(r, "rbd-model");
    printf("   The table lies in the file that defines RBD_IMPLEMENTATION, or ");
    print_upper(name);
    printf("_MODEL_IMPLEMENTATION, before it\n"
           "   includes this; in all others this declares it. */\n");
    write_features(name, r->model);
    printf("#ifdef RBD_H\n#ifndef ");
    print_upper(name);
    printf("_MODEL_H\n#define ");
    print_upper(name);
    printf("_MODEL_H\n\n#if RBD_MODEL_VERSION != %d\n"
           "#error \"%s_model.h was written for another version of rbd.h: write it again\"\n"
           "#elif defined RBD_FEATURES && (",
           RBD_MODEL_VERSION, name);
    print_upper(name);
    printf("_FEATURES) & ~(RBD_FEATURES + 0u)\n#error \"RBD_FEATURES lacks some of ");
    print_upper(name);
    printf("_FEATURES\"\n#endif\n\n/* clang-format off */\n\n");
}

/* Ends what every file gets, and begins what one file gets, even if it had the former already. */
static void write_declaration(const char *name) {
    printf("#define %s_model RBDI_TABLE_SYMBOL(%s_model)\nRBDI_TABLE_DECLARATION(%s_model)\n\n#endif\n\n",
           name, name, name);
    printf("#if (defined RBD_IMPLEMENTATION || defined ");
    print_upper(name);
    printf("_MODEL_IMPLEMENTATION) && !defined ");
    print_upper(name);
    printf("_MODEL_TABLE\n#define ");
    print_upper(name);
    printf(
        "_MODEL_TABLE\n\n"
        "/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */\n\n");
}

void print_c_model(const robot *r, const char *name) {
    const rbd_model *m = r->model;
    write_head(r, name);
    print_c_indices(r, name);
    printf("\n");
    write_work_size(name, m);
    write_declaration(name);
    write_links(name, m);
    write_blocks(name, m);
    write_dofs(name, m);
    write_order(name, m);
    write_nodes(name, m);
    write_mimics(name, m);
    write_frames(name, m);
    printf("RBDI_TABLE const rbd_model %s_model = {\n"
           "    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), %d, %d, %d, /* nb, nq, nv */\n"
           "    %d, %d, %d, %d, %d, %d, "
           "/* links, blocks, branch points, mimics, packed entries, those behind */\n    ",
           name, m->nb, m->nq, m->nv, m->nl, m->nblock, m->nbranch, m->nmimic, (int)m->nh, (int)m->nhx);
    vector(m->gravity);
    printf(",\n    %s_links, ", name);
    if (m->nblock)
        printf("%s_blocks, ", name);
    else
        printf("NULL, ");
    printf("%s_dofs, %s_order, %s_nodes, ", name, name, name);
    if (m->nmimic)
        printf("%s_mimics, ", name);
    else
        printf("NULL, ");
    printf("%s_frames,\n    ", name);
    print_upper(name);
    printf("_FEATURES,\n    {");
    for (int k = 0; k < RBDI_SHAPE; ++k)
        printf("%sUINT64_C(0x%llx)", k ? ", " : "", (unsigned long long)m->shape[k]);
    printf("}, /* lengths of a work's arrays */\n};\n\n#endif\n#elif !defined RBD_FEATURES\n"
           "#error \"include rbd.h before %s_model.h\"\n#endif\n",
           name);
}
