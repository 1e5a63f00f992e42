/* plain_calls.h - made by tests/interface.py --write from the declarations: do not edit.

   CALL(header, name, may_fail, arguments, n) for each plain call (tests/calls.py), with n results in all. A
   test defines what stands for the arguments: MODEL, WORK, DERIVATIVES, BODY, OTHER_BODY, AXES, NUMBER and

   Q(k)        the k-th configuration
   IN(k, n)    n numbers to read, the k-th such array of the call
   WEIGHTS(n)  n numbers to read, not negative
   OUT(at, n)  where n results go, of which `at` results stand before

   and the sizes NQ, NV, NB and NH, that of a packed matrix. BODY_CALLS are those of a body. */
#ifndef TESTS_PLAIN_CALLS_H
#define TESTS_PLAIN_CALLS_H
/* clang-format off */

#define PLAIN_CALLS(CALL) \
    CALL("rbd.h", rbd_rnea, 0, (MODEL, WORK, Q(0), IN(0, NV), IN(1, NV), IN(2, NB * 6), OUT(0, NV)), NV) \
    CALL("rbd.h", rbd_bias, 0, (MODEL, WORK, Q(0), IN(0, NV), IN(1, NB * 6), OUT(0, NV)), NV) \
    CALL("rbd.h", rbd_gravity_torque, 0, (MODEL, WORK, Q(0), OUT(0, NV)), NV) \
    CALL("rbd.h", rbd_generalized_momentum, 0, (MODEL, WORK, Q(0), IN(0, NV), OUT(0, NV), OUT(NV, NV)), \
        NV + NV) \
    CALL("rbd.h", rbd_crba, 0, (MODEL, WORK, Q(0), OUT(0, NV * NV)), NV * NV) \
    CALL("rbd.h", rbd_crba_packed, 0, (MODEL, WORK, Q(0), OUT(0, NH)), NH) \
    CALL("rbd.h", rbd_aba, 1, (MODEL, WORK, Q(0), IN(0, NV), IN(1, NV), IN(2, NB * 6), OUT(0, NV)), NV) \
    CALL("rbd.h", rbd_fd_cholesky, 1, (MODEL, WORK, Q(0), IN(0, NV), IN(1, NV), IN(2, NB * 6), OUT(0, \
        NV)), NV) \
    CALL("rbd.h", rbd_minverse, 1, (MODEL, WORK, Q(0), OUT(0, NV * NV)), NV * NV) \
    CALL("rbd.h", rbd_passive, 0, (MODEL, WORK, IN(0, NV), OUT(0, NV)), NV) \
    CALL("rbd.h", rbd_energy, 0, (MODEL, WORK, OUT(0, 1), OUT(1, 1)), 1 + 1) \
    CALL("rbd.h", rbd_com, 0, (MODEL, WORK, OUT(0, 3), OUT(3, 3), OUT(3 + 3, 3)), 3 + 3 + 3) \
    CALL("rbd.h", rbd_joint_wrench, 0, (MODEL, WORK, Q(0), IN(0, NV), IN(1, NV), IN(2, NB * 6), OUT(0, \
        NB * 6)), NB * 6) \
    CALL("rbd.h", rbd_momentum, 0, (MODEL, WORK, OUT(0, 6), OUT(6, 6)), 6 + 6) \
    CALL("rbd.h", rbd_neutral, 0, (MODEL, OUT(0, NQ)), NQ) \
    CALL("rbd.h", rbd_integrate, 0, (MODEL, Q(0), IN(0, NV), NUMBER, OUT(0, NQ)), NQ) \
    CALL("rbd.h", rbd_step, 0, (MODEL, Q(0), IN(0, NV), IN(1, NV), NUMBER, OUT(0, NQ), OUT(NQ, NV)), NQ \
        + NV) \
    CALL("rbd.h", rbd_free_step, 1, (MODEL, WORK, Q(0), IN(0, NV), IN(1, NV), IN(2, NB * 6), IN(3, NV), \
        NUMBER, OUT(0, NQ), OUT(NQ, NV)), NQ + NV) \
    CALL("rbd.h", rbd_difference, 0, (MODEL, Q(0), Q(1), OUT(0, NV)), NV) \
    CALL("rbd.h", rbd_interpolate, 0, (MODEL, Q(0), Q(1), NUMBER, OUT(0, NQ)), NQ) \
    CALL("rbd.h", rbd_distance, 0, (MODEL, Q(0), Q(1), WEIGHTS(NV), OUT(0, 1)), 1) \
    CALL("rbd.h", rbd_rates_from_velocity, 0, (MODEL, Q(0), IN(0, NV), OUT(0, NQ)), NQ) \
    CALL("rbd_derivatives.h", rbd_momentum_matrix, 0, (MODEL, DERIVATIVES, Q(0), IN(0, NV), OUT(0, 6 * \
        NV), OUT(6 * NV, 6)), 6 * NV + 6) \
    CALL("rbd_derivatives.h", rbd_com_jacobian, 0, (MODEL, DERIVATIVES, Q(0), OUT(0, 3 * NV)), 3 * NV) \
    CALL("rbd_derivatives.h", rbd_coriolis, 0, (MODEL, DERIVATIVES, Q(0), IN(0, NV), OUT(0, NV * NV)), \
        NV * NV) \
    CALL("rbd_derivatives.h", rbd_id_derivatives, 0, (MODEL, DERIVATIVES, Q(0), IN(0, NV), IN(1, NV), \
        IN(2, NB * 6), OUT(0, NV * NV), OUT(NV * NV, NV * NV), OUT(NV * NV + NV * NV, NV * NV)), NV * NV \
        + NV * NV + NV * NV) \
    CALL("rbd_derivatives.h", rbd_gravity_torque_derivatives, 0, (MODEL, DERIVATIVES, Q(0), OUT(0, NV * \
        NV)), NV * NV) \
    CALL("rbd_derivatives.h", rbd_fd_derivatives, 1, (MODEL, DERIVATIVES, Q(0), IN(0, NV), IN(1, NV), \
        IN(2, NB * 6), OUT(0, NV), OUT(NV, NV * NV), OUT(NV + NV * NV, NV * NV), OUT(NV + NV * NV + NV * \
        NV, NV * NV)), NV + NV * NV + NV * NV + NV * NV) \
    CALL("rbd_derivatives.h", rbd_regressor, 0, (MODEL, DERIVATIVES, Q(0), IN(0, NV), IN(1, NV), OUT(0, \
        NV * 10 * NB)), NV * 10 * NB) \
    CALL("rbd_derivatives.h", rbd_energy_regressors, 0, (MODEL, DERIVATIVES, Q(0), IN(0, NV), OUT(0, 10 \
        * NB), OUT(10 * NB, 10 * NB)), 10 * NB + 10 * NB) \
    CALL("rbd_derivatives.h", rbd_integrate_derivatives, 0, (MODEL, IN(0, NV), NUMBER, OUT(0, NV * NV), \
        OUT(NV * NV, NV * NV)), NV * NV + NV * NV) \
    CALL("rbd_derivatives.h", rbd_difference_derivatives, 0, (MODEL, Q(0), Q(1), OUT(0, NV * NV), OUT(NV \
        * NV, NV * NV)), NV * NV + NV * NV)

#define BODY_CALLS(CALL) \
    CALL("rbd.h", rbd_body_pose, 0, (MODEL, WORK, BODY, OUT(0, 3 * 3), OUT(3 * 3, 3)), 3 * 3 + 3) \
    CALL("rbd.h", rbd_body_velocity, 0, (MODEL, WORK, BODY, OUT(0, 6)), 6) \
    CALL("rbd.h", rbd_body_acceleration, 0, (MODEL, WORK, BODY, OUT(0, 6)), 6) \
    CALL("rbd.h", rbd_body_acceleration_classical, 0, (MODEL, WORK, BODY, OUT(0, 6)), 6) \
    CALL("rbd.h", rbd_jacobian, 0, (MODEL, WORK, BODY, IN(0, 3), AXES, OUT(0, 6 * NV)), 6 * NV) \
    CALL("rbd.h", rbd_relative_jacobian, 0, (MODEL, WORK, BODY, IN(0, 3), OTHER_BODY, AXES, OUT(0, 6 * \
        NV)), 6 * NV) \
    CALL("rbd.h", rbd_jacobian_transpose, 0, (MODEL, WORK, BODY, IN(0, 3), AXES, IN(1, 6), OUT(0, NV)), \
        NV) \
    CALL("rbd.h", rbd_point_position, 0, (MODEL, WORK, BODY, IN(0, 3), OUT(0, 3)), 3) \
    CALL("rbd.h", rbd_point_velocity, 0, (MODEL, WORK, BODY, IN(0, 3), AXES, OUT(0, 6)), 6) \
    CALL("rbd.h", rbd_point_acceleration, 0, (MODEL, WORK, BODY, IN(0, 3), AXES, OUT(0, 6)), 6) \
    CALL("rbd.h", rbd_point_wrench, 0, (MODEL, WORK, BODY, IN(0, 3), AXES, IN(1, 6), OUT(0, 6)), 6) \
    CALL("rbd_derivatives.h", rbd_jacobian_derivative, 0, (MODEL, WORK, BODY, IN(0, 3), AXES, OUT(0, 6 * \
        NV)), 6 * NV) \
    CALL("rbd_derivatives.h", rbd_relative_jacobian_derivative, 0, (MODEL, WORK, BODY, IN(0, 3), \
        OTHER_BODY, AXES, OUT(0, 6 * NV)), 6 * NV)

#endif
