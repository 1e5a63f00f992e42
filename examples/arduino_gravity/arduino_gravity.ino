// arduino_gravity - the torque that holds an arm of two rods still, from two potentiometers on A0 and A1.
// For a robot of your own, put a header that rbd-model writes in place of double_pendulum_model.h.
#define RBD_REAL float // as most boards compute
#define RBD_NO_BUILD   // the model is a constant table: it needs no code that builds it
#define RBD_IMPLEMENTATION
#include <rbd.h>
#include "double_pendulum_model.h"

static unsigned char memory[DOUBLE_PENDULUM_WORK_SIZE];
static rbd_work *work;

static float angle(int pin) { // -pi .. pi
    return (analogRead(pin) - 512) * (3.14159265f / 512);
}

void setup() {
    Serial.begin(115200);
    const rbd_status status = rbd_work_init(&double_pendulum_model, memory, sizeof memory, &work);
    if (status != RBD_OK) Serial.println(rbd_status_string(status));
}

void loop() {
    float q[DOUBLE_PENDULUM_NQ], tau[DOUBLE_PENDULUM_NV];
    q[DOUBLE_PENDULUM_Q_SHOULDER] = angle(A0);
    q[DOUBLE_PENDULUM_Q_ELBOW] = angle(A1);
    if (rbd_gravity_torque(&double_pendulum_model, work, q, tau) == RBD_OK) {
        Serial.print(tau[DOUBLE_PENDULUM_DOF_SHOULDER], 4);
        Serial.print(' ');
        Serial.println(tau[DOUBLE_PENDULUM_DOF_ELBOW], 4);
    }
    delay(100);
}
