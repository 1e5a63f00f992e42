# rbd::urdf is what rbd_urdf.h needs: rbd::rbd and urdfdom. One C++ file of the program implements it.
find_package(PkgConfig QUIET)
if(PKG_CONFIG_FOUND AND NOT TARGET rbd::urdf)
  pkg_check_modules(rbd_urdfdom QUIET IMPORTED_TARGET GLOBAL urdfdom)
  if(TARGET PkgConfig::rbd_urdfdom)
    add_library(rbd::urdf INTERFACE IMPORTED GLOBAL)
    set_target_properties(rbd::urdf PROPERTIES INTERFACE_LINK_LIBRARIES "rbd::rbd;PkgConfig::rbd_urdfdom")
  endif()
endif()
