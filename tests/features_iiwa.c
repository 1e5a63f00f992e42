/* features_iiwa.c - the library with the features of iiwa alone, for features.c. */
#define ROBOT iiwa
#define ROBOT_FEATURES IIWA_FEATURES
#include "features.c"
