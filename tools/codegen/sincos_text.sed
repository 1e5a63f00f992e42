# Rooms of src/base/ as one string of C++, with the macros of generated code, and names that it shares with nobody.
1i\
R"(
/^#include/d
/^\/\* Sines and cosines of the angles/,/^}/d
s/#if RBDI_CLANG/#ifdef __clang__/
s/RBDI_PART/COLD/g
s/RBDI_INLINE/INLINE/g
s/RBDI_COLD/COLD/g
s/RBDI_UNUSED/UNUSED/g
s/RBD_C(/(scalar)(/g
s/rbdi_zero()/splat(0)/g
s/RBD_REAL/scalar/g
s/rbd_const/scalar/g
s/rbd_real/real/g
s/rbdi_/own_/g
s/RBDI_/OWN_/g
s/RBD_/OWN_/g
$a\
)"
