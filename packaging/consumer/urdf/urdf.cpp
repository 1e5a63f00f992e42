#define RBD_URDF_IMPLEMENTATION
#include <rbd_urdf.h>
