/* atlas_model.h - the built model of atlas, for flash: include rbd.h before, pass &atlas_model.
   Written by rbd-model from atlas.urdf: change that instead.
       rbd-model --floating --c-model atlas atlas.urdf
   The table lies in the file that defines RBD_IMPLEMENTATION, or ATLAS_MODEL_IMPLEMENTATION, before it
   includes this; in all others this declares it. */
#ifndef ATLAS_FEATURES /* what a program with this robot alone needs of rbd.h: for RBD_FEATURES */
#define ATLAS_FEATURES 0x27fffafu
#endif

#ifdef RBD_H
#ifndef ATLAS_MODEL_H
#define ATLAS_MODEL_H

#if RBD_MODEL_VERSION != 6
#error "atlas_model.h was written for another version of rbd.h: write it again"
#elif defined RBD_FEATURES && (ATLAS_FEATURES) & ~(RBD_FEATURES + 0u)
#error "RBD_FEATURES lacks some of ATLAS_FEATURES"
#endif

/* clang-format off */

#define ATLAS_NB 31 /* bodies */
#define ATLAS_NQ 37 /* length of q */
#define ATLAS_NV 36 /* degrees of freedom: length of v, a and tau */

#ifndef ATLAS_INDICES /* the description and the built model have the same */
#define ATLAS_INDICES
enum { /* bodies; Q: in q; DOF: in v, a and tau */
    ATLAS_BODY_PELVIS = 0,
    ATLAS_BODY_LTORSO = 1,
    ATLAS_BODY_L_UGLUT = 2,
    ATLAS_BODY_R_UGLUT = 3,
    ATLAS_BODY_MTORSO = 4,
    ATLAS_BODY_L_LGLUT = 5,
    ATLAS_BODY_R_LGLUT = 6,
    ATLAS_BODY_UTORSO = 7,
    ATLAS_BODY_L_ULEG = 8,
    ATLAS_BODY_R_ULEG = 9,
    ATLAS_BODY_L_CLAV = 10,
    ATLAS_BODY_HEAD = 11,
    ATLAS_BODY_R_CLAV = 12,
    ATLAS_BODY_L_LLEG = 13,
    ATLAS_BODY_R_LLEG = 14,
    ATLAS_BODY_L_SCAP = 15,
    ATLAS_BODY_R_SCAP = 16,
    ATLAS_BODY_L_TALUS = 17,
    ATLAS_BODY_R_TALUS = 18,
    ATLAS_BODY_L_UARM = 19,
    ATLAS_BODY_R_UARM = 20,
    ATLAS_BODY_L_FOOT = 21,
    ATLAS_BODY_R_FOOT = 22,
    ATLAS_BODY_L_LARM = 23,
    ATLAS_BODY_R_LARM = 24,
    ATLAS_BODY_L_UFARM = 25,
    ATLAS_BODY_R_UFARM = 26,
    ATLAS_BODY_L_LFARM = 27,
    ATLAS_BODY_R_LFARM = 28,
    ATLAS_BODY_L_HAND = 29,
    ATLAS_BODY_R_HAND = 30,
    ATLAS_Q_ROOT_X = 0,
    ATLAS_Q_ROOT_Y = 1,
    ATLAS_Q_ROOT_Z = 2,
    ATLAS_Q_ROOT_QX = 3,
    ATLAS_Q_ROOT_QY = 4,
    ATLAS_Q_ROOT_QZ = 5,
    ATLAS_Q_ROOT_QW = 6,
    ATLAS_Q_BACK_BKZ = 7,
    ATLAS_Q_L_LEG_HPZ = 8,
    ATLAS_Q_R_LEG_HPZ = 9,
    ATLAS_Q_BACK_BKY = 10,
    ATLAS_Q_L_LEG_HPX = 11,
    ATLAS_Q_R_LEG_HPX = 12,
    ATLAS_Q_BACK_BKX = 13,
    ATLAS_Q_L_LEG_HPY = 14,
    ATLAS_Q_R_LEG_HPY = 15,
    ATLAS_Q_L_ARM_SHZ = 16,
    ATLAS_Q_NECK_AY = 17,
    ATLAS_Q_R_ARM_SHZ = 18,
    ATLAS_Q_L_LEG_KNY = 19,
    ATLAS_Q_R_LEG_KNY = 20,
    ATLAS_Q_L_ARM_SHX = 21,
    ATLAS_Q_R_ARM_SHX = 22,
    ATLAS_Q_L_LEG_AKY = 23,
    ATLAS_Q_R_LEG_AKY = 24,
    ATLAS_Q_L_ARM_ELY = 25,
    ATLAS_Q_R_ARM_ELY = 26,
    ATLAS_Q_L_LEG_AKX = 27,
    ATLAS_Q_R_LEG_AKX = 28,
    ATLAS_Q_L_ARM_ELX = 29,
    ATLAS_Q_R_ARM_ELX = 30,
    ATLAS_Q_L_ARM_UWY = 31,
    ATLAS_Q_R_ARM_UWY = 32,
    ATLAS_Q_L_ARM_MWX = 33,
    ATLAS_Q_R_ARM_MWX = 34,
    ATLAS_Q_L_ARM_LWY = 35,
    ATLAS_Q_R_ARM_LWY = 36,
    ATLAS_DOF_ROOT_WX = 0,
    ATLAS_DOF_ROOT_WY = 1,
    ATLAS_DOF_ROOT_WZ = 2,
    ATLAS_DOF_ROOT_VX = 3,
    ATLAS_DOF_ROOT_VY = 4,
    ATLAS_DOF_ROOT_VZ = 5,
    ATLAS_DOF_BACK_BKZ = 6,
    ATLAS_DOF_L_LEG_HPZ = 7,
    ATLAS_DOF_R_LEG_HPZ = 8,
    ATLAS_DOF_BACK_BKY = 9,
    ATLAS_DOF_L_LEG_HPX = 10,
    ATLAS_DOF_R_LEG_HPX = 11,
    ATLAS_DOF_BACK_BKX = 12,
    ATLAS_DOF_L_LEG_HPY = 13,
    ATLAS_DOF_R_LEG_HPY = 14,
    ATLAS_DOF_L_ARM_SHZ = 15,
    ATLAS_DOF_NECK_AY = 16,
    ATLAS_DOF_R_ARM_SHZ = 17,
    ATLAS_DOF_L_LEG_KNY = 18,
    ATLAS_DOF_R_LEG_KNY = 19,
    ATLAS_DOF_L_ARM_SHX = 20,
    ATLAS_DOF_R_ARM_SHX = 21,
    ATLAS_DOF_L_LEG_AKY = 22,
    ATLAS_DOF_R_LEG_AKY = 23,
    ATLAS_DOF_L_ARM_ELY = 24,
    ATLAS_DOF_R_ARM_ELY = 25,
    ATLAS_DOF_L_LEG_AKX = 26,
    ATLAS_DOF_R_LEG_AKX = 27,
    ATLAS_DOF_L_ARM_ELX = 28,
    ATLAS_DOF_R_ARM_ELX = 29,
    ATLAS_DOF_L_ARM_UWY = 30,
    ATLAS_DOF_R_ARM_UWY = 31,
    ATLAS_DOF_L_ARM_MWX = 32,
    ATLAS_DOF_R_ARM_MWX = 33,
    ATLAS_DOF_L_ARM_LWY = 34,
    ATLAS_DOF_R_ARM_LWY = 35,
};
#endif

/* Bytes for rbd_work_init, exactly. */
#define ATLAS_WORK_SIZE RBDI_WORK_BYTES(31, 1, 2, 36, 0, 36, 351)

#define atlas_model RBDI_TABLE_SYMBOL(atlas_model)
RBDI_TABLE_DECLARATION(atlas_model)

#endif

#if (defined RBD_IMPLEMENTATION || defined ATLAS_MODEL_IMPLEMENTATION) && !defined ATLAS_MODEL_TABLE
#define ATLAS_MODEL_TABLE

/* Constants are the solver's, in its own frames; rbd.h, rbdi_link and on, explains them. */

/* parent iq iv block branch first end kind flags | cos sin, right angles and gamma | cos sin alpha | cos sin beta |
   r | d | rho kappa | Sigma xx xy xz yy yz zz | h | m | m of the subtree */
static RBDI_THERE const rbdi_link atlas_links[31] = {
    {-1, 0, 0, 0, 1, 0, 36, RBDI_BLOCK, /* 0: pelvis */
     RBDI_MASS_KEPT | RBDI_ROOT | RBDI_OFF_CHAIN,
     0, 0, 0, 0, 0, 0, 0, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.065438317015), RBD_C(-0.0008), RBD_C(-0.25597059412250006), RBD_C(0.359564462), RBD_C(0.0005), RBD_C(3.41129984158431)},
     {RBD_C(-1.5117871500000002), 0, RBD_C(21.03243875528)}, RBD_C(175.117964), RBD_C(175.117964)},
    {0, 7, 6, -1, -1, 6, 24, RBDI_REVOLUTE, /* 1: ltorso */
     RBDI_SHIFT_XYZ | RBDI_TWIST_0 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     -1, 0, 2, 0, 1, 0, 1, 0,
     {RBD_C(-0.0125), 0, RBD_C(0.162)}, 0, 1, 0,
     {RBD_C(0.0009161042226112005), RBD_C(1.3133217856688001e-07), RBD_C(-0.002581595407972), RBD_C(0.0014637767702761974), RBD_C(-1.3796307619530006e-07), 0},
     {RBD_C(0.025647368), RBD_C(0.010493634308200002), 0}, 0, 0},
    {1, 10, 9, -1, -1, 7, 24, RBDI_REVOLUTE, /* 2: mtorso */
     RBDI_TWIST_90,
     0, -1, 3, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.31678955850852125), RBD_C(0.043912185637719994), RBD_C(0.00037360518546370006), RBD_C(1.5452382291028501), RBD_C(-0.00014667393410483), 0},
     {RBD_C(-6.3403455226), RBD_C(-0.8765008690602826), 0}, 0, 0},
    {2, 13, 12, -1, 0, 8, 24, RBDI_REVOLUTE, /* 3: utorso */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, -1, 3, 0, 0, 1, 1, 0,
     {RBD_C(-0.05), 0, 0}, RBD_C(0.1406), 1, 0,
     {RBD_C(2.2959966635950746), RBD_C(0.014334314725190422), RBD_C(0.00736364560296167), RBD_C(13.70948617952751), RBD_C(5.356031642674764), 0},
     {RBD_C(-0.19421165049893307), RBD_C(-38.75633196599426), 0}, 0, 0},
    {3, 16, 15, -1, -1, 9, 16, RBDI_REVOLUTE, /* 4: l_clav */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.2256), 0, 0}, RBD_C(0.23260000000000003), 1, 0,
     {RBD_C(0.18867087), 0, RBD_C(0.004), RBD_C(0.005234999999999999), 0, 0},
     {RBD_C(1.687917), 0, 0}, 0, 0},
    {4, 21, 20, -1, -1, 10, 16, RBDI_REVOLUTE, /* 5: l_scap */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     0, 1, 1, 0, 0, 1, 1, 0,
     {RBD_C(0.11), 0, 0}, 0, 1, 0,
     {RBD_C(0.0045250992), RBD_C(0.04312576320000001), 0, RBD_C(0.7326882932000002), 0, 0},
     {RBD_C(-0.18313120000000002), RBD_C(-2.6953602000000005), 0}, 0, 0},
    {5, 25, 24, -1, -1, 11, 16, RBDI_REVOLUTE, /* 6: l_uarm */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.016), 0, 0}, RBD_C(0.306), 1, 0,
     {RBD_C(0.002387533008), 0, 0, RBD_C(0.0049250000000000006), 0, 0},
     {RBD_C(-0.06494924), 0, 0}, 0, 0},
    {6, 29, 28, -1, -1, 12, 16, RBDI_REVOLUTE, /* 7: l_larm */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.0092), 0, 0}, 0, 1, 0,
     {RBD_C(0.0016483240219699997), RBD_C(0.00862120955367), 0, RBD_C(0.24807812015212993), 0, 0},
     {RBD_C(-0.035105757), RBD_C(-0.9360705269999999), 0}, 0, 0},
    {7, 31, 30, -1, -1, 13, 16, RBDI_REVOLUTE, /* 8: l_ufarm */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.00921), 0, 0}, RBD_C(0.29955), 1, 0,
     {RBD_C(0.0018203394846199987), RBD_C(-1.3762889999999998e-07), RBD_C(-7.611795696e-05), RBD_C(0.0012820745226999996), RBD_C(3.08586312e-05), 0},
     {RBD_C(0.000917526), RBD_C(-0.00048213), 0}, 0, 0},
    {8, 33, 32, -1, -1, 14, 16, RBDI_REVOLUTE, /* 9: l_lfarm */
     RBDI_TWIST_90,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.00018572167119999992), RBD_C(2.6564436e-05), RBD_C(-1.7956080000000002e-07), RBD_C(0.006576879897587668), RBD_C(-2.7705240000000002e-06), 0},
     {RBD_C(-0.00105624), RBD_C(-0.07638760099998704), 0}, 0, 0},
    {9, 35, 34, -1, -1, 15, 16, RBDI_REVOLUTE, /* 10: l_hand */
     RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.00024800023355980833), RBD_C(-1.8684799999988545e-09), RBD_C(9.528080199969705e-07), RBD_C(0.00023901494783973165), RBD_C(-7.622464160011817e-06), 0},
     {RBD_C(1.1677999999968469e-05), RBD_C(-9.342400000015808e-05), 0}, 0, 0},
    {3, 17, 16, -1, -1, 16, 17, RBDI_REVOLUTE, /* 11: head */
     RBDI_BRANCH_TURN | RBDI_SHIFT_XYZ | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     1, 0, 0, 0, 0, 1, 0, -1,
     {0, RBD_C(-0.6215), RBD_C(0.11399999999999999)}, 0, 1, 0,
     {RBD_C(0.007451717244328127), RBD_C(-0.0024130603412924985), RBD_C(3.982733669467637e-06), RBD_C(0.013086161697514084), RBD_C(-2.8062844640467733e-06), 0},
     {RBD_C(0.05442042065601582), RBD_C(-0.10982967690802517), 0}, 0, 0},
    {3, 18, 17, -1, -1, 17, 24, RBDI_REVOLUTE, /* 12: r_clav */
     RBDI_SHIFT_XYZ | RBDI_TWIST_90 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(0.2256), RBD_C(-0.23260000000000003), 0}, 0, 1, 0,
     {RBD_C(0.18867087), 0, RBD_C(-0.004), RBD_C(0.005234999999999999), 0, 0},
     {RBD_C(-1.687917), 0, 0}, 0, 0},
    {12, 22, 21, -1, -1, 18, 24, RBDI_REVOLUTE, /* 13: r_scap */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     0, 1, 1, 0, 0, 1, 1, 0,
     {RBD_C(-0.11), 0, 0}, 0, 1, 0,
     {RBD_C(0.0045250992), RBD_C(-0.04312576320000001), 0, RBD_C(0.7326882932000002), 0, 0},
     {RBD_C(-0.18313120000000002), RBD_C(2.6953602000000005), 0}, 0, 0},
    {13, 26, 25, -1, -1, 19, 24, RBDI_REVOLUTE, /* 14: r_uarm */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.016), 0, 0}, RBD_C(-0.306), 1, 0,
     {RBD_C(0.002387533008), 0, 0, RBD_C(0.0049250000000000006), 0, 0},
     {RBD_C(-0.06494924), 0, 0}, 0, 0},
    {14, 30, 29, -1, -1, 20, 24, RBDI_REVOLUTE, /* 15: r_larm */
     RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.0092), 0, 0}, 0, 1, 0,
     {RBD_C(0.0016483240219699997), RBD_C(-0.00862120955367), 0, RBD_C(0.24807812015212993), 0, 0},
     {RBD_C(-0.035105757), RBD_C(0.9360705269999999), 0}, 0, 0},
    {15, 32, 31, -1, -1, 21, 24, RBDI_REVOLUTE, /* 16: r_ufarm */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {RBD_C(-0.00921), 0, 0}, RBD_C(-0.29955), 1, 0,
     {RBD_C(0.0018203394846199987), RBD_C(1.3762889999999998e-07), RBD_C(-7.611795696e-05), RBD_C(0.0012820745226999996), RBD_C(-3.08586312e-05), 0},
     {RBD_C(-0.000917526), RBD_C(-0.00048213), 0}, 0, 0},
    {16, 34, 33, -1, -1, 22, 24, RBDI_REVOLUTE, /* 17: r_lfarm */
     RBDI_TWIST_90,
     -1, 0, 2, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.00018572167119999992), RBD_C(2.6564436e-05), RBD_C(1.7956080000000002e-07), RBD_C(0.006576879897587668), RBD_C(2.7705240000000002e-06), 0},
     {RBD_C(0.00105624), RBD_C(0.07638760099998704), 0}, 0, 0},
    {17, 36, 35, -1, -1, 23, 24, RBDI_REVOLUTE, /* 18: r_hand */
     RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.00024800023355980833), RBD_C(1.8684799999988545e-09), RBD_C(-9.528080199969705e-07), RBD_C(0.00023901494783973165), RBD_C(-7.622464160011817e-06), 0},
     {RBD_C(1.1677999999968469e-05), RBD_C(9.342400000015808e-05), 0}, 0, 0},
    {0, 8, 7, -1, -1, 24, 30, RBDI_REVOLUTE, /* 19: l_uglut */
     RBDI_SHIFT_XYZ | RBDI_TWIST_0 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, 1, 1, 0, 1, 0, 1, 0,
     {0, RBD_C(0.089), 0}, 0, 1, 0,
     {RBD_C(0.00025678128574232155), RBD_C(3.5704689310885595e-05), RBD_C(-2.11082001423448e-05), RBD_C(0.039349509472127155), RBD_C(-6.0412268666986794e-05), 0},
     {RBD_C(-0.00675329988), RBD_C(-0.7850422643800001), 0}, 0, 0},
    {19, 11, 10, -1, -1, 25, 30, RBDI_REVOLUTE, /* 20: l_lglut */
     RBDI_SHIFT_Z | RBDI_TWIST_90,
     0, 1, 1, 0, 0, 1, 1, 0,
     {0, 0, 0}, RBD_C(0.05), 1, 0,
     {RBD_C(0.06776837252732194), RBD_C(0.02326778686104864), RBD_C(0.00102495665492664), RBD_C(0.023734532227418878), RBD_C(0.00053890084674488), 0},
     {RBD_C(-1.0347862696000003), RBD_C(-0.3585244632), 0}, 0, 0},
    {20, 14, 13, -1, -1, 26, 30, RBDI_REVOLUTE, /* 21: l_uleg */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R,
     RBD_C(-0.9911815478605518), RBD_C(-0.13251090212039465), 2, RBD_C(0.13290179497937293), 0, 1, 1, 0,
     {RBD_C(-0.066), 0, 0}, RBD_C(0.0225), 1, 0,
     {RBD_C(1.4379652269146486), RBD_C(-0.05671315867842895), 0, RBD_C(0.01758197308535146), 0, 0},
     {RBD_C(4.367805698157429), RBD_C(-0.2282950826091007), 0}, 0, 0},
    {21, 19, 18, -1, -1, 27, 30, RBDI_REVOLUTE, /* 22: l_lleg */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     RBD_C(0.9911815478605518), RBD_C(-0.13251090212039465), 0, RBD_C(-0.13290179497937293), 1, 0, 1, 0,
     {RBD_C(0.3773274440058661), 0, 0}, 0, 1, 0,
     {RBD_C(0.680827975), RBD_C(0.002155695), 0, RBD_C(0.004504515000000004), 0, 0},
     {RBD_C(1.914075), RBD_C(-0.004515), 0}, 0, 0},
    {22, 23, 22, -1, -1, 28, 30, RBDI_REVOLUTE, /* 23: l_talus */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.422), 0, 0}, 0, 1, 0,
     {RBD_C(2.792524999999999e-06), 0, 0, RBD_C(0.008262525225000001), 0, 0},
     {0, RBD_C(-0.06507), 0}, 0, 0},
    {23, 27, 26, -1, -1, 29, 30, RBDI_REVOLUTE, /* 24: l_foot */
     RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.011318490000000004), 0, RBD_C(0.00435969), RBD_C(0.0015000000000000005), 0, 0},
     {RBD_C(0.16147000000000003), 0, 0}, 0, 0},
    {0, 9, 8, -1, -1, 30, 36, RBDI_REVOLUTE, /* 25: r_uglut */
     RBDI_SHIFT_XYZ | RBDI_TWIST_0 | RBDI_SHIFT_R | RBDI_OFF_CHAIN,
     0, 1, 1, 0, 1, 0, 1, 0,
     {0, RBD_C(-0.089), 0}, 0, 1, 0,
     {RBD_C(0.00025678128574232155), RBD_C(-3.5704689310885595e-05), RBD_C(2.11082001423448e-05), RBD_C(0.039349509472127155), RBD_C(-6.0412268666986794e-05), 0},
     {RBD_C(0.00675329988), RBD_C(-0.7850422643800001), 0}, 0, 0},
    {25, 12, 11, -1, -1, 31, 36, RBDI_REVOLUTE, /* 26: r_lglut */
     RBDI_SHIFT_Z | RBDI_TWIST_90,
     0, 1, 1, 0, 0, 1, 1, 0,
     {0, 0, 0}, RBD_C(0.05), 1, 0,
     {RBD_C(0.06776837252732194), RBD_C(-0.02326778686104864), RBD_C(0.00102495665492664), RBD_C(0.023734532227418878), RBD_C(-0.00053890084674488), 0},
     {RBD_C(-1.0347862696000003), RBD_C(0.3585244632), 0}, 0, 0},
    {26, 15, 14, -1, -1, 32, 36, RBDI_REVOLUTE, /* 27: r_uleg */
     RBDI_SHIFT_Z | RBDI_TWIST_90 | RBDI_SHIFT_R,
     RBD_C(-0.9911815478605518), RBD_C(-0.13251090212039465), 2, RBD_C(0.13290179497937293), 0, 1, 1, 0,
     {RBD_C(-0.066), 0, 0}, RBD_C(-0.0225), 1, 0,
     {RBD_C(1.4379652269146486), RBD_C(-0.05671315867842895), 0, RBD_C(0.01758197308535146), 0, 0},
     {RBD_C(4.367805698157429), RBD_C(-0.2282950826091007), 0}, 0, 0},
    {27, 20, 19, -1, -1, 33, 36, RBDI_REVOLUTE, /* 28: r_lleg */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     RBD_C(0.9911815478605518), RBD_C(-0.13251090212039465), 0, RBD_C(-0.13290179497937293), 1, 0, 1, 0,
     {RBD_C(0.3773274440058661), 0, 0}, 0, 1, 0,
     {RBD_C(0.680827975), RBD_C(0.002155695), 0, RBD_C(0.004504515000000004), 0, 0},
     {RBD_C(1.914075), RBD_C(-0.004515), 0}, 0, 0},
    {28, 24, 23, -1, -1, 34, 36, RBDI_REVOLUTE, /* 29: r_talus */
     RBDI_TWIST_0 | RBDI_SHIFT_R,
     1, 0, 0, 0, 1, 0, 1, 0,
     {RBD_C(0.422), 0, 0}, 0, 1, 0,
     {RBD_C(2.792524999999999e-06), 0, 0, RBD_C(0.008262525225000001), 0, 0},
     {0, RBD_C(-0.06507), 0}, 0, 0},
    {29, 28, 27, -1, -1, 35, 36, RBDI_REVOLUTE, /* 30: r_foot */
     RBDI_TWIST_90,
     1, 0, 0, 0, 0, 1, 1, 0,
     {0, 0, 0}, 0, 1, 0,
     {RBD_C(0.011318490000000004), 0, RBD_C(0.00435969), RBD_C(0.0015000000000000005), 0, 0},
     {RBD_C(0.16147000000000003), 0, 0}, 0, 0},
};

/* joint type, first axis, axes, identity | E */
static RBDI_THERE const rbdi_block atlas_blocks[1] = {
    {15, 0, 6, 1, {1, 0, 0, 0, 1, 0, 0, 0, 1}},
};

/* body | dof before it, row, depth in the matrix | dof before it, level in the mechanism |
   armature, damping, friction | inertia of what it moves */
static RBDI_THERE const rbdi_dof atlas_dofs[36] = {
    {0, -1, 0, 0, -1, 0, 0, 0, 0, RBD_C(107.96858606494195)},
    {0, 0, 1, 1, 0, 1, 0, 0, 0, RBD_C(107.96858606494195)},
    {0, 1, 3, 2, 1, 2, 0, 0, 0, RBD_C(107.96858606494195)},
    {0, 2, 6, 3, 2, 3, 0, 0, 0, RBD_C(175.11796400000003)},
    {0, 3, 10, 4, 3, 4, 0, 0, 0, RBD_C(175.11796400000003)},
    {0, 4, 15, 5, 4, 5, 0, 0, 0, RBD_C(175.11796400000003)},
    {1, 5, 21, 6, 5, 6, 0, 0, 0, RBD_C(63.14224134793228)},
    {2, 5, 28, 6, 5, 6, 0, 0, 0, RBD_C(5.681930149081161)},
    {3, 5, 35, 6, 5, 6, 0, 0, 0, RBD_C(5.681930149081161)},
    {4, 6, 42, 7, 6, 7, 0, 0, 0, RBD_C(63.1398596250983)},
    {5, 7, 50, 7, 7, 7, 0, 0, 0, RBD_C(4.878716309961175)},
    {6, 8, 58, 7, 8, 7, 0, 0, 0, RBD_C(4.878716309961175)},
    {7, 9, 66, 8, 9, 8, 0, 0, 0, RBD_C(36.23172026525763)},
    {8, 10, 75, 8, 10, 8, 0, 0, 0, RBD_C(3.8902529647475657)},
    {9, 11, 84, 8, 11, 8, 0, 0, 0, RBD_C(3.8902529647475657)},
    {10, 12, 93, 9, 12, 9, 0, 0, 0, RBD_C(4.75724340293063)},
    {11, 12, 103, 9, 12, 9, 0, 0, 0, RBD_C(0.02053787988702045)},
    {12, 12, 113, 9, 12, 9, 0, 0, 0, RBD_C(4.75724340293063)},
    {13, 13, 123, 9, 13, 9, 0, 0, 0, RBD_C(0.8533540576914362)},
    {14, 14, 133, 9, 14, 9, 0, 0, 0, RBD_C(0.8533540576914362)},
    {15, 15, 143, 10, 15, 10, 0, 0, 0, RBD_C(3.2865397103786607)},
    {16, 17, 154, 10, 17, 10, 0, 0, 0, RBD_C(3.2865397103786607)},
    {17, 18, 165, 10, 18, 10, 0, 0, 0, RBD_C(0.021083808499309336)},
    {18, 19, 176, 10, 19, 10, 0, 0, 0, RBD_C(0.021083808499309336)},
    {19, 20, 187, 11, 20, 11, 0, 0, 0, RBD_C(0.5859661650396122)},
    {20, 21, 199, 11, 21, 11, 0, 0, 0, RBD_C(0.5859661650396122)},
    {21, 22, 211, 11, 22, 11, 0, 0, 0, RBD_C(0.012818490748747913)},
    {22, 23, 223, 11, 23, 11, 0, 0, 0, RBD_C(0.012818490748747913)},
    {23, 24, 235, 12, 24, 12, 0, 0, 0, RBD_C(0.5524431087308108)},
    {24, 25, 248, 12, 25, 12, 0, 0, 0, RBD_C(0.5524431087308108)},
    {25, 28, 261, 13, 28, 13, 0, 0, 0, RBD_C(0.010352032119259199)},
    {26, 29, 275, 13, 29, 13, 0, 0, 0, RBD_C(0.010352032119259199)},
    {27, 30, 289, 14, 30, 14, 0, 0, 0, RBD_C(0.0072496170164501475)},
    {28, 31, 304, 14, 31, 14, 0, 0, 0, RBD_C(0.0072496170164501475)},
    {29, 32, 319, 15, 32, 15, 0, 0, 0, RBD_C(0.00048701539719209707)},
    {30, 33, 335, 15, 33, 15, 0, 0, 0, RBD_C(0.00048701539719209707)},
};

/* the dofs as the solver meets them: dof, its row */
static RBDI_THERE const rbdi_order atlas_order[36] = {
    {0, 0}, {1, 1}, {2, 3}, {3, 6}, {4, 10}, {5, 15}, {6, 21}, {9, 42},
    {12, 66}, {15, 93}, {20, 143}, {24, 187}, {28, 235}, {30, 261}, {32, 289}, {34, 319},
    {16, 103}, {17, 113}, {21, 154}, {25, 199}, {29, 248}, {31, 275}, {33, 304}, {35, 335},
    {7, 28}, {10, 50}, {13, 75}, {18, 123}, {22, 165}, {26, 211}, {8, 35}, {11, 58},
    {14, 84}, {19, 133}, {23, 176}, {27, 223},
};

/* the dofs of the matrix depth first: dof, descendants, row */
static RBDI_THERE const rbdi_node atlas_nodes[36] = {
    {0, 35, 0}, {1, 34, 1}, {2, 33, 3}, {3, 32, 6}, {4, 31, 10}, {5, 30, 15},
    {6, 17, 21}, {9, 16, 42}, {12, 15, 66}, {15, 6, 93}, {20, 5, 143}, {24, 4, 187},
    {28, 3, 235}, {30, 2, 261}, {32, 1, 289}, {34, 0, 319}, {16, 0, 103}, {17, 6, 113},
    {21, 5, 154}, {25, 4, 199}, {29, 3, 248}, {31, 2, 275}, {33, 1, 304}, {35, 0, 335},
    {7, 5, 28}, {10, 4, 50}, {13, 3, 75}, {18, 2, 123}, {22, 1, 165}, {26, 0, 211},
    {8, 5, 35}, {11, 4, 58}, {14, 3, 84}, {19, 2, 133}, {23, 1, 176}, {27, 0, 223},
   
};

/* names | link, parent, joint type, iq, nq, iv, nv | E, r from the link to the body | mass | com |
   inertia about the com | lower, upper, velocity, effort */
static RBDI_THERE const rbdi_frame atlas_frames[31] = {
    {"pelvis", "root", 0, -1, 15, 0, 7, 0, 6, /* 0 */
     {1, 0, 0, 0, 1, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(9.509), {RBD_C(0.0111), 0, RBD_C(0.0271)},
     {RBD_C(0.1244), RBD_C(0.0008), RBD_C(-0.0007), RBD_C(0.0958), RBD_C(-0.0005), RBD_C(0.1167)},
     0, 0, 0, 0},
    {"ltorso", "back_bkz", 1, 0, 1, 7, 1, 6, 1, /* 1 */
     {-1, 0, 0, 0, -1, 0, 0, 0, 1},
     {0, 0, RBD_C(-0.162)}, RBD_C(2.27), {RBD_C(-0.0112984), RBD_C(-3.15366e-06), RBD_C(0.0746835)},
     {RBD_C(0.0039092), RBD_C(-5.04491e-08), RBD_C(-0.000342157), RBD_C(0.00341694), RBD_C(4.87119e-07), RBD_C(0.00174492)},
     RBD_C(-0.663225), RBD_C(0.663225), 12, 106},
    {"l_uglut", "l_leg_hpz", 19, 0, 1, 8, 1, 7, 1, /* 2 */
     {0, -1, 0, 1, 0, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(1.959), {RBD_C(0.00529262), RBD_C(-0.00344732), RBD_C(0.00313046)},
     {RBD_C(0.00074276), RBD_C(-3.79607e-08), RBD_C(-2.79549e-05), RBD_C(0.000688179), RBD_C(-3.2735e-08), RBD_C(0.00041242)},
     RBD_C(-0.174358), RBD_C(0.786794), 12, 275},
    {"r_uglut", "r_leg_hpz", 25, 0, 1, 9, 1, 8, 1, /* 3 */
     {0, -1, 0, 1, 0, 0, 0, 0, 1},
     {0, 0, 0}, RBD_C(1.959), {RBD_C(0.00529262), RBD_C(0.00344732), RBD_C(0.00313046)},
     {RBD_C(0.00074276), RBD_C(3.79607e-08), RBD_C(-2.79549e-05), RBD_C(0.000688179), RBD_C(3.2735e-08), RBD_C(0.00041242)},
     RBD_C(-0.786794), RBD_C(0.174358), 12, 275},
    {"mtorso", "back_bky", 2, 1, 1, 10, 1, 9, 1, /* 4 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, RBD_C(0.799), {RBD_C(-0.00816266), RBD_C(-0.0131245), RBD_C(0.0305974)},
     {RBD_C(0.000454181), RBD_C(-6.10764e-05), RBD_C(3.94009e-05), RBD_C(0.000483282), RBD_C(5.27463e-05), RBD_C(0.000444215)},
     RBD_C(-0.219388), RBD_C(0.538783), 9, 445},
    {"l_lglut", "l_leg_hpx", 20, 2, 1, 11, 1, 10, 1, /* 5 */
     {0, 0, 1, 0, -1, 0, 1, 0, 0},
     {0, 0, RBD_C(-0.05)}, RBD_C(0.898), {RBD_C(0.0133341), RBD_C(0.0170484), RBD_C(-0.0312052)},
     {RBD_C(0.000691326), RBD_C(-2.24344e-05), RBD_C(2.50508e-06), RBD_C(0.00126856), RBD_C(0.000137862), RBD_C(0.00106487)},
     RBD_C(-0.523599), RBD_C(0.523599), 12, 530},
    {"r_lglut", "r_leg_hpx", 26, 3, 1, 12, 1, 11, 1, /* 6 */
     {0, 0, 1, 0, -1, 0, 1, 0, 0},
     {0, 0, RBD_C(-0.05)}, RBD_C(0.898), {RBD_C(0.0133341), RBD_C(-0.0170484), RBD_C(-0.0312052)},
     {RBD_C(0.000691326), RBD_C(2.24344e-05), RBD_C(2.50508e-06), RBD_C(0.00126856), RBD_C(-0.000137862), RBD_C(0.00106487)},
     RBD_C(-0.523599), RBD_C(0.523599), 12, 530},
    {"utorso", "back_bkx", 3, 4, 1, 13, 1, 12, 1, /* 7 */
     {0, 0, 1, -1, 0, 0, 0, -1, 0},
     {0, 0, RBD_C(-0.1406)}, RBD_C(84.609), {RBD_C(-0.0616865794419), RBD_C(0.00229456322613), RBD_C(0.31680933825)},
     {RBD_C(1.62389363101), RBD_C(-0.0319003241735), RBD_C(0.0816617976536), RBD_C(1.65537724052), RBD_C(0.0472153677044), RBD_C(0.57736212051)},
     RBD_C(-0.523599), RBD_C(0.523599), 12, 300},
    {"l_uleg", "l_leg_hpy", 21, 5, 1, 14, 1, 13, 1, /* 8 */
     {RBD_C(-0.13251090212039462), RBD_C(-0.9911815478605517), 0, 0, 0, 1, RBD_C(-0.9911815478605517), RBD_C(0.13251090212039462), 0},
     {0, 0, 0}, RBD_C(8.204), {0, 0, RBD_C(-0.21)},
     {RBD_C(0.09), 0, 0, RBD_C(0.09), 0, RBD_C(0.02)},
     RBD_C(-1.61234), RBD_C(0.65764), 12, 840},
    {"r_uleg", "r_leg_hpy", 27, 6, 1, 15, 1, 14, 1, /* 9 */
     {RBD_C(-0.13251090212039462), RBD_C(-0.9911815478605517), 0, 0, 0, 1, RBD_C(-0.9911815478605517), RBD_C(0.13251090212039462), 0},
     {0, 0, 0}, RBD_C(8.204), {0, 0, RBD_C(-0.21)},
     {RBD_C(0.09), 0, 0, RBD_C(0.09), 0, RBD_C(0.02)},
     RBD_C(-1.61234), RBD_C(0.65764), 12, 840},
    {"l_clav", "l_arm_shz", 4, 7, 1, 16, 1, 15, 1, /* 10 */
     {0, 1, 0, -1, 0, 0, 0, 0, 1},
     {0, 0, RBD_C(0.245)}, RBD_C(4.466), {0, 0, RBD_C(-0.084)},
     {RBD_C(0.011), 0, 0, RBD_C(0.009), RBD_C(0.004), RBD_C(0.004)},
     RBD_C(-1.5708), RBD_C(0.785398), 12, 87},
    {"head", "neck_ay", 11, 7, 1, 17, 1, 16, 1, /* 11 */
     {0, 1, 0, 0, 0, 1, 1, 0, 0},
     {0, 0, 0}, RBD_C(2.087564), {RBD_C(-0.0526114058817), RBD_C(3.39872211343e-05), RBD_C(0.0260688633527)},
     {RBD_C(0.0120995596034), RBD_C(-9.26521052135e-07), RBD_C(-0.000450074498094), RBD_C(0.0133409067225), RBD_C(-2.13313479841e-06), RBD_C(0.0133743888566)},
     RBD_C(-0.602139), RBD_C(1.14319), RBD_C(6.28), 25},
    {"r_clav", "r_arm_shz", 12, 7, 1, 18, 1, 17, 1, /* 12 */
     {0, -1, 0, 1, 0, 0, 0, 0, 1},
     {0, 0, RBD_C(0.245)}, RBD_C(4.466), {0, 0, RBD_C(-0.084)},
     {RBD_C(0.011), 0, 0, RBD_C(0.009), RBD_C(0.004), RBD_C(0.004)},
     RBD_C(-0.785398), RBD_C(1.5708), 12, 87},
    {"l_lleg", "l_leg_kny", 22, 8, 1, 19, 1, 18, 1, /* 13 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, RBD_C(4.515), {RBD_C(0.001), 0, RBD_C(-0.187)},
     {RBD_C(0.077), 0, RBD_C(-0.003), RBD_C(0.076), 0, RBD_C(0.01)},
     0, RBD_C(2.35637), 12, 890},
    {"r_lleg", "r_leg_kny", 28, 9, 1, 20, 1, 19, 1, /* 14 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, RBD_C(4.515), {RBD_C(0.001), 0, RBD_C(-0.187)},
     {RBD_C(0.077), 0, RBD_C(-0.003), RBD_C(0.076), 0, RBD_C(0.01)},
     0, RBD_C(2.35637), 12, 890},
    {"l_scap", "l_arm_shx", 5, 10, 1, 21, 1, 20, 1, /* 15 */
     {0, 0, -1, 0, 1, 0, 1, 0, 0},
     {0, 0, 0}, RBD_C(3.899), {0, 0, 0},
     {RBD_C(0.00319), 0, 0, RBD_C(0.00583), 0, RBD_C(0.00583)},
     RBD_C(-1.5708), RBD_C(1.5708), 12, 99},
    {"r_scap", "r_arm_shx", 13, 12, 1, 22, 1, 21, 1, /* 16 */
     {0, 0, 1, 0, -1, 0, 1, 0, 0},
     {0, 0, 0}, RBD_C(3.899), {0, 0, 0},
     {RBD_C(0.00319), 0, 0, RBD_C(0.00583), 0, RBD_C(0.00583)},
     RBD_C(-1.5708), RBD_C(1.5708), 12, 99},
    {"l_talus", "l_leg_aky", 23, 13, 1, 23, 1, 22, 1, /* 17 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, RBD_C(0.125), {0, 0, 0},
     {RBD_C(1.01674e-05), 0, 0, RBD_C(8.42775e-06), 0, RBD_C(1.30101e-05)},
     -1, RBD_C(0.7), 12, 740},
    {"r_talus", "r_leg_aky", 29, 14, 1, 24, 1, 23, 1, /* 18 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, RBD_C(0.125), {0, 0, 0},
     {RBD_C(1.01674e-05), 0, 0, RBD_C(8.42775e-06), 0, RBD_C(1.30101e-05)},
     -1, RBD_C(0.7), 12, 740},
    {"l_uarm", "l_arm_ely", 6, 15, 1, 25, 1, 24, 1, /* 19 */
     {0, 1, 0, 0, 0, -1, -1, 0, 0},
     {0, 0, RBD_C(-0.119)}, RBD_C(4.386), {0, RBD_C(0.065), 0},
     {RBD_C(0.00656), 0, 0, RBD_C(0.00358), 0, RBD_C(0.00656)},
     0, RBD_C(3.14159), 12, 63},
    {"r_uarm", "r_arm_ely", 14, 16, 1, 26, 1, 25, 1, /* 20 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, RBD_C(0.119)}, RBD_C(4.386), {0, RBD_C(0.065), 0},
     {RBD_C(0.00656), 0, 0, RBD_C(0.00358), 0, RBD_C(0.00656)},
     0, RBD_C(3.14159), 12, 63},
    {"l_foot", "l_leg_akx", 24, 17, 1, 27, 1, 26, 1, /* 21 */
     {0, 0, 1, 0, 1, 0, -1, 0, 0},
     {0, 0, 0}, RBD_C(2.41), {RBD_C(0.027), 0, RBD_C(-0.067)},
     {RBD_C(0.002), 0, 0, RBD_C(0.007), 0, RBD_C(0.008)},
     RBD_C(-0.8), RBD_C(0.8), 12, 360},
    {"r_foot", "r_leg_akx", 30, 18, 1, 28, 1, 27, 1, /* 22 */
     {0, 0, 1, 0, 1, 0, -1, 0, 0},
     {0, 0, 0}, RBD_C(2.41), {RBD_C(0.027), 0, RBD_C(-0.067)},
     {RBD_C(0.002), 0, 0, RBD_C(0.007), 0, RBD_C(0.008)},
     RBD_C(-0.8), RBD_C(0.8), 12, 360},
    {"l_larm", "l_arm_elx", 7, 19, 1, 29, 1, 28, 1, /* 23 */
     {0, 0, -1, 0, 1, 0, 1, 0, 0},
     {0, 0, 0}, RBD_C(3.248), {0, 0, 0},
     {RBD_C(0.00265), 0, 0, RBD_C(0.00446), 0, RBD_C(0.00446)},
     0, RBD_C(2.35619), 12, 112},
    {"r_larm", "r_arm_elx", 15, 20, 1, 30, 1, 29, 1, /* 24 */
     {0, 0, 1, 0, -1, 0, 1, 0, 0},
     {0, 0, 0}, RBD_C(3.248), {0, 0, 0},
     {RBD_C(0.00265), 0, 0, RBD_C(0.00446), 0, RBD_C(0.00446)},
     RBD_C(-2.35619), 0, 12, 112},
    {"l_ufarm", "l_arm_uwy", 8, 23, 1, 31, 1, 30, 1, /* 25 */
     {0, -1, 0, 0, 0, -1, 1, 0, 0},
     {0, 0, 0}, RBD_C(2.4798), {RBD_C(0.00015), RBD_C(0.08296), RBD_C(0.00037)},
     {RBD_C(0.012731), 0, 0, RBD_C(0.002857), 0, RBD_C(0.011948)},
     RBD_C(-3.011), RBD_C(3.011), 10, 25},
    {"r_ufarm", "r_arm_uwy", 16, 24, 1, 32, 1, 31, 1, /* 26 */
     {0, -1, 0, 0, 0, 1, -1, 0, 0},
     {0, 0, 0}, RBD_C(2.4798), {RBD_C(0.00015), RBD_C(0.08296), RBD_C(0.00037)},
     {RBD_C(0.012731), 0, 0, RBD_C(0.002857), 0, RBD_C(0.011948)},
     RBD_C(-3.011), RBD_C(3.011), 10, 25},
    {"l_lfarm", "l_arm_mwx", 9, 25, 1, 33, 1, 32, 1, /* 27 */
     {0, 0, 1, 0, 1, 0, -1, 0, 0},
     {0, 0, 0}, RBD_C(0.648), {RBD_C(0.00017), RBD_C(-0.02515), RBD_C(0.00163)},
     {RBD_C(0.000764), 0, 0, RBD_C(0.000429), 0, RBD_C(0.000825)},
     RBD_C(-1.7628), RBD_C(1.7628), 10, 25},
    {"r_lfarm", "r_arm_mwx", 17, 26, 1, 34, 1, 33, 1, /* 28 */
     {0, 0, 1, 0, -1, 0, 1, 0, 0},
     {0, 0, 0}, RBD_C(0.648), {RBD_C(0.00017), RBD_C(-0.02515), RBD_C(0.00163)},
     {RBD_C(0.000764), 0, 0, RBD_C(0.000429), 0, RBD_C(0.000825)},
     RBD_C(-1.7628), RBD_C(1.7628), 10, 25},
    {"l_hand", "l_arm_lwy", 10, 27, 1, 35, 1, 34, 1, /* 29 */
     {0, -1, 0, 0, 0, -1, 1, 0, 0},
     {0, 0, 0}, RBD_C(0.6839), {RBD_C(0.000136604766779), RBD_C(-0.0878643091095), RBD_C(1.70755958473e-05)},
     {RBD_C(0.000555203783762), RBD_C(-5.86171054248e-07), RBD_C(-2.73209533558e-10), RBD_C(0.000487002219827), RBD_C(-7.3271381781e-08), RBD_C(0.000546205935287)},
     RBD_C(-2.9671), RBD_C(2.9671), 10, 25},
    {"r_hand", "r_arm_lwy", 18, 28, 1, 36, 1, 35, 1, /* 30 */
     {0, 1, 0, 0, 0, 1, 1, 0, 0},
     {0, 0, 0}, RBD_C(0.6839), {RBD_C(0.000136604766779), RBD_C(-0.0878643091095), RBD_C(1.70755958473e-05)},
     {RBD_C(0.000555203783762), RBD_C(-5.86171054248e-07), RBD_C(-2.73209533558e-10), RBD_C(0.000487002219827), RBD_C(-7.3271381781e-08), RBD_C(0.000546205935287)},
     RBD_C(-2.9671), RBD_C(2.9671), 10, 25},
};

RBDI_TABLE const rbd_model atlas_model = {
    RBD_MODEL_VERSION, (int16_t)sizeof(rbd_const), 31, 37, 36, /* nb, nq, nv */
    31, 1, 2, 0, 351, 0, /* links, blocks, branch points, mimics, packed entries, those behind */
    {0, 0, RBD_C(-9.81)},
    atlas_links, atlas_blocks, atlas_dofs, atlas_order, atlas_nodes, NULL, atlas_frames,
    ATLAS_FEATURES,
    {UINT64_C(0x1f00250024001f), UINT64_C(0x100020000), UINT64_C(0x15f00000000)}, /* lengths of a work's arrays */
};

#endif
#elif !defined RBD_FEATURES
#error "include rbd.h before atlas_model.h"
#endif
