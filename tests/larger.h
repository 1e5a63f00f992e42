/* larger.h - the largest of what a test measures: as the examples keep it. */
#include "../examples/larger.h"
