/* rbd_spatial.h - spatial algebra, for programs that use rbd.h. SPDX-License-Identifier: MIT, see rbd.h.

   Rotations, placements of frames, and the spatial vectors of Featherstone's book (Rigid Body Dynamics
   Algorithms, 2008, chapter 2; "the book" below): small structs by value and static inline functions, in C99
   and C++, for every scalar of rbd.h, which must stand beside it. It has no symbol of its own: any number of
   files may include it.

       rbd_placement hand = rbd_placement_from_arrays(R, p, HAND, WORLD);         // of rbd_body_pose
       rbd_force f = rbd_force_of(moment, force, WORLD);
       rbd_force_to_array(rbd_force_down(hand, f), &f_ext[6 * HAND]);             // a row of f_ext

   CONTENTS (search for the tag)
     [conventions] [frames]
     [types] [rotations] [placements] [motions] [forces] [inertias] [checks]

   [conventions]
     vectors      angular first, as everywhere in rbd: a motion is (omega; v of the point at the origin), a
                  force is (moment about the origin; force)
     kinds        motion and force are different types, so that a compiler refuses to mix them up:
                  rbd_motion_up takes a motion only, and an inertia times a motion is a force
     placement    says where frame `of` stands in frame `in`: rotation turns vectors from of's axes into in's
                  axes, position is of's origin, in in's axes; Pinocchio's SE3 in_M_of
     up, down     up: from `of` to `in`, as from a child to its parent; down: back
     quaternions  (x, y, z, w), of any length; they turn as the rotation does
     angles       rad; roll, pitch, yaw are those of URDF: Rz(yaw) Ry(pitch) Rx(roll)

   [frames] Every quantity is given a frame, a number of your choice, such as a body's index or -1 for the
   world. By default it is not kept and costs nothing. With

       void frame_error(const char *file, int line, const char *call, int found, int expected);
       #define RBD_CHECK_FRAMES frame_error
       #include "rbd_spatial.h"

   it is kept with each quantity. If a call gets a quantity of a wrong frame, your function (in one file; it
   may print, stop, or return) gets the place in your source, the name of the call, and the two frames. The
   structs are larger then: all files that exchange them need the same setting. rbd_vec3 and rbd_rotation have
   no frame.
*/
#define RBDI_WITH_ALGEBRA
#include "rbd.h"

#ifndef RBD_SPATIAL_H
#define RBD_SPATIAL_H

#if RBD_VERSION_NUMBER < 400
#error "rbd_spatial.h: needs a newer rbd.h"
#endif

#include "spatial/types.h"
#include "spatial/placements.h"
#include "spatial/vectors.h"
#include "spatial/inertias.h"

#endif /* RBD_SPATIAL_H */
