#!/usr/bin/env bash
# The Debian packages for 64-bit ARM, unpacked beside Debian's ARM libraries and run by qemu: their server hosts native bots,
# and their bots play on a native server.
#
#   bash arm64_test.sh ARM_BUILD NATIVE_BUILD   with target `programs` built in both; PLAY_SECONDS (10) each way
set -euo pipefail
arm="$(cd "${1:?usage: arm64_test.sh ARM_BUILD NATIVE_BUILD}" && pwd)"
native="$(cd "${2:?usage: arm64_test.sh ARM_BUILD NATIVE_BUILD}" && pwd)"
source="$(cd "$(dirname "$0")/../.." && pwd)"
seconds="${PLAY_SECONDS:-10}"
folder="$(mktemp -d)"
clean_up() {
  for running in $(jobs -pr); do kill "$running" 2>/dev/null || true; done
  wait
  rm -rf "$folder"
}
trap clean_up EXIT
trap 'exit 1' HUP INT TERM
export XDG_STATE_HOME="$folder/state" WOBBLE_ADMIT_WHEN_BUSY=1 WOBBLE_UNTRAINED=1
unset STATE_DIRECTORY

fail() {
  echo "FAILED: $1"
  exit 1
}
emulate() { qemu-aarch64 -L "$source/build/arm64-sysroot" "$@"; }
# start_server COMMAND...: starts `wobbled` in this way and sets `port`.
start_server() {
  "$@" --scene arena --port 0 --for 300 >"$folder/server" 2>&1 &
  server=$!
  port=""
  for _ in $(seq 600); do
    port="$(sed -n 's/^listening on UDP port \([0-9]*\).*/\1/p' "$folder/server")"
    [ -n "$port" ] && return
    sleep 0.1
  done
  cat "$folder/server"
  fail "a server that listens"
}
stop_server() {
  kill -TERM "$server"
  wait "$server" || { cat "$folder/server"; fail "a server that ends well"; }
}
# play COMMAND...: `wobble` in this way, as four bots that play all the time.
play() {
  timeout $((seconds + 60)) "$@" bots "127.0.0.1:$port" --count 4 --for "$seconds" >"$folder/played" 2>&1 ||
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
emulate "$folder/root/usr/bin/wobbled" --list-scenes | grep -q '^arena ' || fail "shipped scenes"

start_server emulate "$folder/root/usr/bin/wobbled"
play "$native/bin/wobble"
stop_server
start_server "$native/bin/wobbled"
play emulate "$folder/root/usr/bin/wobble"
stop_server
echo "ok arm64"
