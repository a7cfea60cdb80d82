#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Programs in C alone that find, link and use the library, each way there is, in a scratch folder.
#   run.sh CASE SOURCE_DIR BUILD_DIR SCRATCH_DIR
set -euo pipefail
case=$1 source=$2 build=$3 scratch=$4/$1
rm -rf "$scratch"
mkdir -p "$scratch"
prefix=$scratch/prefix

install_all() { cmake --install "$build" --prefix "$prefix" >/dev/null; }
install_sort_alone() {
  cmake -S "$source" -B "$scratch/sort" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCELLIST_MODULES=sort >/dev/null
  cmake --build "$scratch/sort" >/dev/null
  cmake --install "$scratch/sort" --prefix "$prefix" >/dev/null
}
find_package() {
  cmake -S "$source/tests/consumer/find_package" -B "$scratch/consumer" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" \
    -DCOMPONENT="$1" >/dev/null
  cmake --build "$scratch/consumer" >/dev/null
  "$scratch/consumer/consumer"
}
pkg_config() {
  export PKG_CONFIG_PATH
  PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name "cellist-$1.pc")")
  # shellcheck disable=SC2046
  cc -std=c17 -DUSE_"${1^^}" "$source/tests/consumer/consumer.c" -o "$scratch/consumer" \
    $(pkg-config --static --cflags --libs "cellist-$1")
  "$scratch/consumer"
}

case $case in
  find_package) install_all && find_package cellist ;;
  find_package_sort_alone) install_sort_alone && find_package sort ;;
  pkg_config) install_all && pkg_config cellist ;;
  pkg_config_sort_alone) install_sort_alone && pkg_config sort ;;
  readme_example)
    install_all
    sed -n '/^```c$/,/^```$/p' "$source/README.md" | grep -v '^```' >"$scratch/example.c"
    PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name cellist-cellist.pc)")
    export PKG_CONFIG_PATH
    # shellcheck disable=SC2046
    cc -std=c17 -Wall -Wextra -Werror "$scratch/example.c" -o "$scratch/example" \
      $(pkg-config --static --cflags --libs cellist-cellist)
    (cd "$scratch" && ./example && [ -s gears.png ])
    ;;
  add_subdirectory)
    cmake -S "$source/tests/consumer/add_subdirectory" -B "$scratch/consumer" -G Ninja >/dev/null
    cmake --build "$scratch/consumer" >/dev/null
    "$scratch/consumer/consumer"
    ;;
  uninstall)
    cmake -S "$source" -B "$scratch/sort" -G Ninja -DCELLIST_MODULES=sort -DCMAKE_INSTALL_PREFIX="$prefix" >/dev/null
    cmake --build "$scratch/sort" --target install >/dev/null
    [ -n "$(find "$prefix" -type f)" ]
    cmake --build "$scratch/sort" --target uninstall >/dev/null
    [ -z "$(find "$prefix" -type f)" ]
    ;;
  *) echo "no case $case" >&2 && exit 1 ;;
esac
