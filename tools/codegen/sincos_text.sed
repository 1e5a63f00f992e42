# Rooms of src/base/ as one string of C++, with names that generated code shares with nobody.
1i\
R"(
/^#include/d
s/rbdi_/own_/g
s/rbd_/own_/g
s/RBDI_/OWN_/g
s/RBD_/OWN_/g
$a\
)"
