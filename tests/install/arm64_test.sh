#!/usr/bin/env bash
# The Debian packages for 64-bit ARM: wobble-server is unpacked in a fresh Debian for ARM, with what it depends on and no
# more, and run there by qemu. Its server hosts native bots, and its bots play on a native server. Nothing is installed:
# the packages' scripts do not run.
#
#   bash arm64_test.sh ARM_BUILD NATIVE_BUILD   with target `programs` built in the first, `wobbled` and `wobble` in the
#                                               second; PLAY_SECONDS (10) each way
readonly case_name=arm64
. "${0%/*}/place.sh"
arm="$(cd "${1:?usage: arm64_test.sh ARM_BUILD NATIVE_BUILD}" && pwd)"
native="$(cd "${2:?usage: arm64_test.sh ARM_BUILD NATIVE_BUILD}" && pwd)"
seconds="${PLAY_SECONDS:-10}"
export WOBBLE_ADMIT_WHEN_BUSY=1 WOBBLE_UNTRAINED=1

stop_server() {
  kill -TERM "$server"
  wait "$server" || { cat "$folder/server"; fail "a server that ends well"; }
}
# play COMMAND...: `wobble` in this way, as four bots that play all the time.
play() {
  timeout $((seconds + 60)) "$@" bots "127.0.0.1:$port" --script wander.lua --count 4 --for "$seconds" \
    >"$folder/played" 2>&1 ||
    { cat "$folder/played" "$folder/server"; fail "bots that play"; }
  tail -3 "$folder/played"
}

(cd "$arm" && cpack -G DEB -B "$folder/packages" >"$folder/log" 2>&1) || { cat "$folder/log"; fail "cpack"; }
for package in wobble-server libwobble-dev; do
  file="$(ls "$folder/packages/${package}"_*_arm64.deb)" || fail "$package for arm64"
  [ "$(dpkg-deb --field "$file" Architecture)" = arm64 ] || fail "the architecture of $package"
  dpkg-deb -x "$file" "$folder/unpacked"
  echo "$(basename "$file") $(stat -c %s "$file") bytes"
done
for file in "$folder"/unpacked/usr/bin/wobble* "$folder"/unpacked/usr/lib/*.so.0.*; do
  file "$file" | grep -q 'ARM aarch64.*stripped' || { file "$file"; fail "a stripped program for ARM"; }
done

cd "$folder/packages"
dpkg-scanpackages . >Packages 2>"$folder/log" || { cat "$folder/log"; fail "an index of the packages"; }
mmdebstrap --quiet --variant=extract --architectures=arm64 --include=wobble-server \
  --setup-hook="echo 'deb [trusted=yes] copy:$folder/packages ./' >\"\$1/etc/apt/sources.list.d/wobble.list\"" \
  bookworm "$folder/root" >"$folder/log" 2>&1 || { tail -20 "$folder/log"; fail "a Debian for ARM with wobble-server"; }
emulate=(qemu-aarch64 -L "$folder/root") # no function: a signal would go to the shell that runs it
"${emulate[@]}" "$folder/root/usr/bin/wobbled" --list-scenes | grep -q '^arena ' || fail "shipped scenes"

start_server "${emulate[@]}" "$folder/root/usr/bin/wobbled" --scene arena --for 300
play "$native/bin/wobble"
stop_server
start_server "$native/bin/wobbled" --scene arena --for 300
play "${emulate[@]}" "$folder/root/usr/bin/wobble"
stop_server
echo "ok arm64"
