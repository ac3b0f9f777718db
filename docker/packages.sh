#!/bin/sh
# The one list of Debian packages for building, running and testing wobble, in groups, and the installation of the
# page's npm packages. Group `runtime` is all that a container needs to run the programs; a test compares it with the
# libraries that they are linked to.
#
#   sh docker/packages.sh [GROUP...]          install what is missing of these groups (default: server)
#   sh docker/packages.sh --list [GROUP...]   print the names of Debian packages only
#
# Installed packages are left alone, so a second run needs neither network nor root.
set -eu

packages_of() {
  case "$1" in
    server) # builds and runs wobbled and wobble
      echo "g++ make cmake ninja-build ccache git ca-certificates flatbuffers-compiler"
      packages_of libraries ;;
    libraries) # what wobbled and wobble are built from
      echo "libeigen3-dev libtbb-dev libenet-dev libsodium-dev libflatbuffers-dev
            libspdlog-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev liblua5.4-dev
            libboost-dev zlib1g-dev libzstd-dev libcpp-httplib-dev prometheus-cpp-dev libicu-dev libssl-dev
            libqrencode-dev libavahi-client-dev libavahi-core-dev" ;;
    runtime) # the libraries of wobbled and wobble only
      echo "libc6 libgcc-s1 libstdc++6 zlib1g libzstd1 libcpp-httplib0.11 libenet7 libsodium23 libfmt9 libicu72 liblua5.4-0
            libavahi-client3 libavahi-common3 libavahi-core7 libprometheus-cpp-core1.0 libqrencode4 libspdlog1.10 libssl3
            libtbb12 libtomlplusplus3" ;;
    test) # the test runner, a second compiler whose results must have the same bits, a browser, promtool, what the
         # example in C draws with, what compares binary interfaces, what plays the engines' examples, an
         # older processor and 64-bit ARM, and what clang compiles and links for that with
      echo "libgtest-dev libgmock-dev clang-19 libclang-rt-19-dev llvm clang-format chromium prometheus avahi-daemon curl
            iproute2 openssl pkg-config mmdebstrap dpkg-dev file python3 python3-numpy python3-yaml
            libsdl2-dev abigail-tools godot3-server mono-mcs mono-runtime qemu-user
            libstdc++-12-dev-arm64-cross binutils-aarch64-linux-gnu" ;;
    web) # builds the page; a server, and a gateway without a page, do not need it
      echo "emscripten nodejs npm" ;;
    python) # builds the Python module, and runs its examples and tests
      echo "python3 python3-dev pybind11-dev python3-numpy python3-matplotlib python3-pip" ;;
    lab) # what wobble_lab is measured against, and its plots
      echo "libsundials-dev libboost-dev libbullet-dev libdraco-dev libmeshoptimizer-dev
            libzstd-dev valgrind gnuplot-nox" ;;
    arm) # builds for 64-bit ARM on another machine, and runs what it has built
      echo "g++-aarch64-linux-gnu qemu-user mmdebstrap" ;;
    arm_libraries) # beside group libraries, in the sysroot that docker/arm64_sysroot.sh makes
      echo "libc6-dev libstdc++-12-dev libgcc-12-dev libgtest-dev libgmock-dev" ;;
    *)
      echo "packages.sh: unknown group '$1'; one of: server, libraries, runtime, web, test, python, lab, arm" >&2
      exit 2 ;;
  esac
}

# Node and npm often come from elsewhere than Debian; Debian's packages then conflict with them.
is_installed() {
  case "$1" in
    nodejs) command -v node >/dev/null 2>&1 && return ;;
    npm) command -v npm >/dev/null 2>&1 && return ;;
  esac
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

install_missing() {
  missing=""
  for package in $wanted; do
    is_installed "$package" || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0

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
}

# Installs the npm packages of the page and its tests as the lock file lists them; repeats it when the lock file has
# changed.
install_modules() {
  page="$(dirname "$0")/../client/page"
  done_by_npm="$page/node_modules/.package-lock.json"
  if [ -f "$done_by_npm" ] && [ -z "$(find "$page/package-lock.json" -newer "$done_by_npm")" ]; then return 0; fi
  echo "Installing: what client/page/package-lock.json lists"
  (cd "$page" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error)
}

install_missing
case " $* " in
  *" web "*) install_modules ;;
esac
