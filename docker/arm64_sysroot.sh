#!/bin/sh
# Makes build/arm64-sysroot: the libraries of the programs and tests for 64-bit ARM as Debian has them, unpacked and not
# installed, for the toolchain docker/arm64.cmake. The machine itself stays as it is: Debian's packages for two
# architectures beside each other exclude each other in part (libraries for Prometheus), and need another version of this
# machine's own libraries. Takes some 10 s and 0.5 GB; does nothing where the list of packages has not changed.
set -eu
here="$(cd "$(dirname "$0")" && pwd)"
root="$here/../build/arm64-sysroot"
packages="$(sh "$here/packages.sh" --list libraries arm_libraries | tr '\n' ',' | sed 's/,$//')"
[ "$(cat "$root/packages.txt" 2>/dev/null)" = "$packages" ] && exit 0

rm -rf "$root"
mkdir -p "$here/../build"
mmdebstrap --quiet --variant=extract --architectures=arm64 --include="$packages" bookworm "$root"
# Absolute links would lead out of it.
find "$root" -type l -lname '/*' | while read -r link; do
  ln -snf "$root$(readlink "$link")" "$link"
done
echo "$packages" >"$root/packages.txt"
