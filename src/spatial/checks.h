#ifndef RBDI_SPATIAL_CHECKS_H
#define RBDI_SPATIAL_CHECKS_H

/* ---- checks [checks] ----
   Calls that compare frames are told where they stand. A macro does not expand within its own expansion. */

#ifdef RBD_CHECK_FRAMES
#define rbd_placement_compose(...) rbd_placement_compose(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_add(...) rbd_motion_add(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_up(...) rbd_motion_up(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_down(...) rbd_motion_down(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_motion_cross(...) rbd_motion_cross(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_add(...) rbd_force_add(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_up(...) rbd_force_up(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_down(...) rbd_force_down(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_force_cross(...) rbd_force_cross(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_power(...) rbd_power(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_add(...) rbd_inertia_add(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_up(...) rbd_inertia_up(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_down(...) rbd_inertia_down(__FILE__, __LINE__, __VA_ARGS__)
#define rbd_inertia_times(...) rbd_inertia_times(__FILE__, __LINE__, __VA_ARGS__)
#endif

#endif
