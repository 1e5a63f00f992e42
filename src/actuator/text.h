#ifndef RBDI_ACTUATOR_TEXT_H
#define RBDI_ACTUATOR_TEXT_H
#include "model/text.h"
#include "api/actuator.h"

/* ---- text [text code] ---- */

RBDI_API char *rbd_actuators_finding_text(const rbd_finding *finding, int n, char *text, size_t size) {
    rbd_finding behind;
    if (!finding || finding->body < n) return rbdi_write_finding(finding, "motor", text, size);
    behind = *finding;
    behind.body = finding->body - n;
    return rbdi_write_finding(&behind, "transmission", text, size);
}

#endif
