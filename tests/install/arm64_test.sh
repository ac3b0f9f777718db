#!/usr/bin/env bash
# The Debian packages for 64-bit ARM, unpacked beside Debian's ARM libraries and run by qemu: their server hosts native bots,
# and their bots play on a native server.
#
#   bash arm64_test.sh ARM_BUILD NATIVE_BUILD   with target `programs` built in the first, `wobbled` and `wobble` in the
#                                               second; PLAY_SECONDS (10) each way
readonly case_name=arm64
. "${0%/*}/place.sh"
arm="$(cd "${1:?usage: arm64_test.sh ARM_BUILD NATIVE_BUILD}" && pwd)"
native="$(cd "${2:?usage: arm64_test.sh ARM_BUILD NATIVE_BUILD}" && pwd)"
seconds="${PLAY_SECONDS:-10}"
export WOBBLE_ADMIT_WHEN_BUSY=1 WOBBLE_UNTRAINED=1

emulate=(qemu-aarch64 -L "$source/build/arm64-sysroot") # no function: a signal would go to the shell that runs it
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
  dpkg-deb --field "$file" Depends | grep -q libenet7 || fail "what $package depends on"
  dpkg-deb -x "$file" "$folder/root"
  echo "$(basename "$file") $(stat -c %s "$file") bytes"
done
for file in "$folder"/root/usr/bin/wobble* "$folder"/root/usr/lib/*.so.0.*; do
  file "$file" | grep -q 'ARM aarch64.*stripped' || { file "$file"; fail "a stripped program for ARM"; }
done
"${emulate[@]}" "$folder/root/usr/bin/wobbled" --list-scenes | grep -q '^arena ' || fail "shipped scenes"

start_server "${emulate[@]}" "$folder/root/usr/bin/wobbled" --scene arena --for 300
play "$native/bin/wobble"
stop_server
start_server "$native/bin/wobbled" --scene arena --for 300
play "${emulate[@]}" "$folder/root/usr/bin/wobble"
stop_server
echo "ok arm64"
