#!/bin/sh
# The one list of Debian packages that wobble is built, run and tested with, in groups.
#
#   sh docker/packages.sh [GROUP...]          install what is missing of these groups (default: server)
#   sh docker/packages.sh --list [GROUP...]   print the names only
#
# Packages that are there are left alone, so a second run asks for no network and no root.
set -eu

packages_of() {
  case "$1" in
    server) # what builds and runs wobbled and wobble
      echo "g++ make cmake ninja-build ccache git ca-certificates
            libeigen3-dev libtbb-dev libenet-dev libflatbuffers-dev flatbuffers-compiler
            libspdlog-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev liblua5.4-dev" ;;
    test) # the test runner, and a second compiler whose results must be the same bits
      echo "libgtest-dev libgmock-dev clang-19 libclang-rt-19-dev clang-format" ;;
    web) # nothing yet: the page comes with its own issue
      echo "" ;;
    lab) # what wobble_lab is measured against, and what draws its plots
      echo "libsundials-dev libboost-dev libbullet-dev libdraco-dev libmeshoptimizer-dev
            libzstd-dev valgrind gnuplot-nox" ;;
    *)
      echo "packages.sh: unknown group '$1'; one of: server, web, test, lab" >&2
      exit 2 ;;
  esac
}

is_installed() {
  [ "$(dpkg-query -W -f='${Status}' "$1" 2>/dev/null)" = "install ok installed" ]
}

list_only=no
if [ "${1:-}" = "--list" ]; then
  list_only=yes
  shift
fi
[ $# -gt 0 ] || set -- server

wanted=""
for group in "$@"; do
  wanted="$wanted $(packages_of "$group")"
done

if [ "$list_only" = yes ]; then
  for package in $wanted; do echo "$package"; done
  exit 0
fi

missing=""
for package in $wanted; do
  is_installed "$package" || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null 2>&1 || {
    echo "packages.sh: missing:$missing; run as root or install sudo" >&2
    exit 1
  }
  as_root="sudo"
fi

echo "Installing:$missing"
$as_root apt-get update -qq
# shellcheck disable=SC2086  # the list is meant to be split
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
