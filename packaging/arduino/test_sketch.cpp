// The example sketch, compiled on a PC: a turn of its loop prints the double pendulum's gravity torque.
#include "Arduino.h"

#include "examples/arduino_gravity/arduino_gravity.ino"
#include "models/double_pendulum.h"

#include <cmath>
#include <cstdio>

int main() {
    setup();
    loop();
    double found[2];
    if (std::sscanf(serial_text.c_str(), "%lf %lf", &found[0], &found[1]) != 2)
        return std::printf("it printed: %s\n", serial_text.c_str()), 1;

    const double step = 3.14159265358979 / 512, q0 = (600 - 512) * step, q1 = (400 - 512) * step;
    const rbd_body &upper_rod = double_pendulum_bodies[0], &lower_rod = double_pendulum_bodies[1];
    const double lower = -lower_rod.mass * lower_rod.com[2] * 9.81 * std::sin(q0 + q1);
    const double upper =
        -(upper_rod.mass * upper_rod.com[2] + lower_rod.mass * lower_rod.position[2]) * 9.81 * std::sin(q0);
    std::printf("sketch: %.4f %.4f N m, textbook: %.4f %.4f N m\n", found[0], found[1], upper + lower, lower);
    return !(std::fabs(found[0] - upper - lower) < 1e-4 && std::fabs(found[1] - lower) < 1e-4);
}
