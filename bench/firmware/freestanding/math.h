/* math.h - all that rbd.h asks of one. SPDX-License-Identifier: MIT */
double sin(double x);
double cos(double x);
double sqrt(double x);
float sinf(float x);
float cosf(float x);
float sqrtf(float x);
