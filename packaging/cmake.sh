#!/bin/sh
# A user's CMake project finds rbd: installed, as a subdirectory, fetched; and as ESP-IDF and Zephyr would.
# usage: cmake.sh DIRECTORY_OF_RBD_H   with RBD_ALL_TESTS=yes fetched, and the component urdf as a subdirectory, too
set -eu
command -v cmake >/dev/null || { echo "needs cmake"; exit 77; }
export CMAKE_GENERATOR=Ninja # which rbd's tests need anyway

root=${1:?usage: cmake.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
version=$(sed -n 's/^#define RBD_VERSION "\(.*\)"/\1/p' "$root/rbd.h")

quietly() { "$@" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }; }

# In a third of the time without forced inlining.
CFLAGS="${CFLAGS-} -Dalways_inline=unused"
CXXFLAGS="${CXXFLAGS-} -Dalways_inline=unused"
export CFLAGS CXXFLAGS

# configure WAY [VERSION]
configure() {
    cmake -S "$root/packaging/consumer" -B "$scratch/$1$2" -DWAY="$1" -DROOT="$root" -DVERSION="$2" \
        -DCMAKE_PREFIX_PATH="$scratch/prefix" --no-warn-unused-cli -Werror=dev
}

quietly cmake -S "$root" -B "$scratch/rbd" -Werror=dev
quietly cmake --install "$scratch/rbd" --prefix "$scratch/prefix"

ways="package subdirectory esp-idf zephyr" urdf_ways=package
if [ -n "${RBD_ALL_TESTS-}" ]; then
    ways="$ways fetch" urdf_ways="package subdirectory"
else
    echo "SKIPPED but by ./run test --all: fetched, and the component urdf as a subdirectory"
fi
for way in $ways; do
    echo "$way:"
    quietly configure "$way" "${version%.*}"
    quietly cmake --build "$scratch/$way${version%.*}"
    "$scratch/$way${version%.*}/consumer"
done

if pkg-config --exists urdfdom; then
    for way in $urdf_ways; do
        echo "component urdf, $way:"
        quietly cmake -S "$root/packaging/consumer/urdf" -B "$scratch/urdf-$way" -DWAY="$way" -DROOT="$root" \
            -DCMAKE_PREFIX_PATH="$scratch/prefix" --no-warn-unused-cli -Werror=dev
        quietly cmake --build "$scratch/urdf-$way"
        "$scratch/urdf-$way/consumer" "$root/models/iiwa.urdf"
    done
fi

echo "other versions are refused:"
for wrong in 99.0 "${version%.*}.99"; do
    ! configure package "$wrong" >"$scratch/log" 2>&1 || { echo "$version was taken for $wrong"; exit 1; }
    grep "requested version \"$wrong\"" "$scratch/log" || { cat "$scratch/log"; exit 1; }
done

echo "ESP-IDF reads CMakeLists.txt in a script first, as far as the registration:"
cat >"$scratch/early.cmake" <<'END'
set(CMAKE_BUILD_EARLY_EXPANSION 1)
macro(idf_component_register)
  message("registered ${ARGN}")
  return()
endmacro()
include("${ROOT}/CMakeLists.txt")
END
cmake -DESP_PLATFORM=1 -DROOT="$root" -P "$scratch/early.cmake" >"$scratch/log" 2>&1
[ "$(cat "$scratch/log")" = "registered INCLUDE_DIRS;." ] || { cat "$scratch/log"; exit 1; }
cat "$scratch/log"
