#ifndef RBDI_API_DERIVATIVES_PARTS_H
#define RBDI_API_DERIVATIVES_PARTS_H
#include "api/symbols.h"
#include "api/parts.h"

#define rbd_derivatives_size RBDI_SYMBOL(rbd_derivatives_size)
#define rbd_derivatives_init RBDI_SYMBOL(rbd_derivatives_init)
#define rbd_momentum_matrix RBDI_SYMBOL(rbd_momentum_matrix)
#define rbd_com_jacobian RBDI_SYMBOL(rbd_com_jacobian)
#define rbd_coriolis RBDI_SYMBOL(rbd_coriolis)
#define rbd_id_free_base RBDI_SYMBOL(rbd_id_free_base)
#define rbd_id_derivatives RBDI_SYMBOL(rbd_id_derivatives)
#define rbd_gravity_torque_derivatives RBDI_SYMBOL(rbd_gravity_torque_derivatives)
#define rbd_keep_zeros RBDI_SYMBOL(rbd_keep_zeros)
#define rbd_fd_derivatives RBDI_SYMBOL(rbd_fd_derivatives)
#define rbd_regressor RBDI_SYMBOL(rbd_regressor)
#define rbd_integrate_derivatives RBDI_SYMBOL(rbd_integrate_derivatives)
#define rbd_difference_derivatives RBDI_SYMBOL(rbd_difference_derivatives)
#define rbd_energy_regressors RBDI_SYMBOL(rbd_energy_regressors)
#define rbd_body_parameters RBDI_SYMBOL(rbd_body_parameters)
#define rbd_set_parameters RBDI_SYMBOL(rbd_set_parameters)
#define rbd_check_parameters RBDI_SYMBOL(rbd_check_parameters)
#define rbd_batch_derivatives_size RBDI_OF_SCALAR(rbd_batch_derivatives_size)
#define rbd_batch_derivatives_init RBDI_OF_SCALAR(rbd_batch_derivatives_init)
#define rbd_batch_momentum_matrix RBDI_OF_SCALAR(rbd_batch_momentum_matrix)
#define rbd_batch_coriolis RBDI_OF_SCALAR(rbd_batch_coriolis)
#define rbd_batch_id_derivatives RBDI_OF_SCALAR(rbd_batch_id_derivatives)
#define rbd_batch_fd_derivatives RBDI_OF_SCALAR(rbd_batch_fd_derivatives)
#define rbd_batch_regressor RBDI_OF_SCALAR(rbd_batch_regressor)

#endif
