// mjcf.hpp - MuJoCo's text of a description, and its model of the text. SPDX-License-Identifier: MIT
#ifndef PEERS_MJCF_HPP
#define PEERS_MJCF_HPP

#include <cstring>
#include <string>
#include <mujoco/mujoco.h>
#include "tree.hpp"

#define MJCF_COMPILER "<compiler angle=\"radian\" inertiafromgeom=\"false\" balanceinertia=\"false\"/>"

inline std::string mjcf_numbers(const double *x, int n) {
    std::string s;
    char text[40];
    for (int i = 0; i < n; i++) {
        std::snprintf(text, sizeof text, "%s%.17g", i ? " " : "", x[i]);
        s += text;
    }
    return s;
}

inline std::string mjcf_attribute(const char *name, const double *x, int n) {
    return std::string(" ") + name + "=\"" + mjcf_numbers(x, n) + "\"";
}

// With principal moments: from a full matrix MuJoCo computes them to some nine digits only.
inline std::string mjcf_inertial(const rbd_body &b) {
    double moments[3];
    mat3 axes;
    if (b.mass == 0) return "";
    principal(b.inertia, moments, &axes);
    return "<inertial" + mjcf_attribute("mass", &b.mass, 1) + mjcf_attribute("pos", b.com, 3) +
           mjcf_attribute("diaginertia", moments, 3) + mjcf_attribute("xyaxes", transpose(axes).m, 6) + "/>";
}

inline std::string mjcf_joint(const rbd_body &b, int index) {
    const std::string name = " name=\"j" + std::to_string(index) + "\"";
    if (b.type == RBD_FLOATING) return "<freejoint" + name + "/>";
    if (b.type == RBD_FIXED) return "";
    return "<joint" + name + " type=\"" + (turns(b) ? "hinge" : "slide") + "\"" +
           mjcf_attribute("axis", b.axis, 3) + mjcf_attribute("armature", b.armature, 1) + "/>";
}

// All below a body, -1 = the world; geoms: from a body's index to the text of what touches.
template <typename Geoms>
std::string mjcf_children(const std::vector<rbd_body> &bodies, int parent, Geoms geoms) {
    std::string s;
    for (int i = 0; i < (int)bodies.size(); i++) {
        const rbd_body &b = bodies[(size_t)i];
        if (b.parent != parent) continue;
        const mat3 C = transpose(rotation_given(b.rotation)); // its rows: the axes
        s += "<body name=\"b" + std::to_string(i) + "\"" + mjcf_attribute("pos", b.position, 3) +
             mjcf_attribute("xyaxes", C.m, 6) + ">" + mjcf_inertial(b) + mjcf_joint(b, i) + geoms(i) +
             mjcf_children(bodies, i, geoms) + "</body>\n";
    }
    return s;
}

// How a file is made in memory; a version's number is 222 for 2.2.2 and 3010000 for 3.10.0.
#if mjVERSION_HEADER < 313
inline bool mjcf_add_file(mjVFS *files, const char *name, const std::string &text) {
    if (mj_makeEmptyFileVFS(files, name, (int)text.size()) != 0) return false;
    std::memcpy(files->filedata[0], text.data(), text.size());
    return true;
}
#else
inline bool mjcf_add_file(mjVFS *files, const char *name, const std::string &text) {
    return mj_addBufferVFS(files, name, text.data(), (int)text.size()) == 0;
}
#endif

// NULL, with the reason in text (160 bytes), if there is none.
inline mjModel *mjcf_compile(const std::string &xml, char *text) {
    mjVFS *files = new mjVFS;
    mj_defaultVFS(files);
    mjModel *m = nullptr;
    if (mjcf_add_file(files, "robot.xml", xml)) m = mj_loadXML("robot.xml", files, text, 160);
    mj_deleteVFS(files);
    delete files;
    return m;
}

#endif
