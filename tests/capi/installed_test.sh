#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# installed_test.sh BUILD SOURCE HEAD: installs, moves the tree, builds the example against it with
# CMake and with pkg-config, and runs both and the installed program.
set -eu
build=$1 source=$2 head=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/staged" > /dev/null
mv "$work/staged" "$work/installed"
prefix=$work/installed
library=$(dirname "$(find "$prefix" -name 'libpalpate.so')")
test -f "$prefix/include/palpate.h"
test -f "$prefix/share/palpate/skull_template.ply"

cmake -S "$source/examples" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$prefix" > /dev/null
cmake --build "$work/cmake" > /dev/null
"$work/cmake/touch_loop" "$head" 1 > "$work/by_cmake.txt"

PKG_CONFIG_PATH=$library/pkgconfig
export PKG_CONFIG_PATH
# shellcheck disable=SC2046
cc -std=c11 -Wall -Wextra -Werror "$source/examples/touch_loop.c" \
  $(pkg-config --cflags --libs palpate) -lm -o "$work/touch_loop"
LD_LIBRARY_PATH=$library "$work/touch_loop" "$head" 1 > "$work/by_pkg_config.txt"
cmp "$work/by_cmake.txt" "$work/by_pkg_config.txt"
grep -q 'force  *[1-9]' "$work/by_cmake.txt"

# Nothing of ours but the header's functions is seen from outside.
if nm -D --defined-only "$library/libpalpate.so" | grep -v ' palpate_\| PALPATE_1'; then
  echo "libpalpate.so shows more than palpate.h" >&2
  exit 1
fi
"$prefix/bin/palpate" --version > /dev/null
"$prefix/bin/palpate" inspect "$head" > /dev/null
echo "installed: built with CMake and with pkg-config"
