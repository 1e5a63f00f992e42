/* features_hyq.c - the library with the features of hyq alone, for features.c. */
#define ROBOT hyq
#define ROBOT_FEATURES HYQ_FEATURES
#include "features.c"
