#!/usr/bin/env bash
# Worlds in a local network, found from another machine: two network namespaces with a cable between them.
#
#   bash lan_test.sh CASE BIN_DIR
#
# Exit code 77: it cannot be tried here, for the reason that is printed.

# Namespaces of its own, for a user without rights as well: nothing of this reaches the machine's network, nor the Avahi
# that may run there.
if [ "${WOBBLE_LAN:-}" = "" ]; then
  for program in unshare ip; do
    command -v "$program" >/dev/null || { echo "skipped: $program is missing"; exit 77; }
  done
  as_root=--map-root-user
  [ "$(id -u)" != 0 ] || as_root=""
  unshare $as_root -nm true 2>/dev/null || { echo "skipped: this user may not make namespaces"; exit 77; }
  WOBBLE_LAN="${as_root:-root}" exec unshare $as_root -nm --pid --fork --kill-child --mount-proc \
    bash "$0" "$@"
fi

. "${0%/*}/case.sh"
trap 'rm -rf "$folder"' EXIT
root="$(cd "$(dirname "$0")/../.." && pwd)"
readonly root

# Machine `home` is 10.9.0.1, machine `guest` 10.9.0.2.
lay_cable() {
  mount -t tmpfs tmpfs /run || exit 1
  ip netns add home && ip netns add guest || exit 1
  ip link add home0 netns home type veth peer name guest0 netns guest || exit 1
  ip -n home addr add 10.9.0.1/24 brd + dev home0
  ip -n guest addr add 10.9.0.2/24 brd + dev guest0
  local each
  for each in home guest; do
    ip -n "$each" link set lo up
    ip -n "$each" link set "${each}0" up
  done
}

# start_world LOG OPTION...: on `home`.
start_world() {
  local log="$folder/$1"
  shift
  ip netns exec home "$bin/wobbled" --untrained --log-level info "$@" >"$log" 2>&1 &
  world=$!
  wait_for 'listening on UDP port' "$log"
}

# wait_for PATTERN FILE
wait_for() {
  local i
  for i in $(seq 400); do
    grep -qs "$1" "$2" && return
    sleep 0.05
  done
  fail "a line '$1'" "$2"
}

# expect PATTERN FILE
expect() { grep -q "$1" "$2" || fail "a line '$1'" "$2"; }

# list OUTPUT OPTION...: `wobble list` on `machine`; leaves its exit code in `code`.
machine=guest
list() {
  local output="$folder/$1"
  shift
  ip netns exec "$machine" "$bin/wobble" list "$@" >"$output" 2>&1
  code=$?
}

case_finds_a_world() {
  list nothing --for 0.5
  [ "$code" = 1 ] || fail "exit code 1, not $code, where nothing is announced" "$folder/nothing"
  expect 'no world is announced' "$folder/nothing"

  start_world quiet --port 7790
  start_world world --port 7791 --announce --name 'Zoë’s world' --scene sumo --max-clients 12
  wait_for 'announced in the local network' "$folder/world"
  expect 'by the server itself' "$folder/world"
  list table
  [ "$code" = 0 ] || fail "exit code 0, not $code" "$folder/table"
  expect '^NAME *ADDRESS *SCENE *PLAYERS *PING$' "$folder/table"
  expect '^Zoë’s world *10\.9\.0\.1:7791 *sumo *0/12 *[0-9.]* ms$' "$folder/table"
  [ "$(wc -l <"$folder/table")" = 2 ] || fail "the announced world alone" "$folder/table"
  list json --json
  for line in '"name": "Zoë’s world"' '"address": "10.9.0.1:7791"' '"scene": "sumo"' '"max_players": 12' \
    '"closed": false' '"ping_ms": [0-9]' '"key": "[0-9a-f]\{64\}"' '"version": "[0-9.]*"'; do
    expect "$line" "$folder/json"
  done

  # Who ends it takes the announcement back.
  kill -TERM "$world"
  wait "$world" || fail "a server that ends well" "$folder/world"
  list gone --for 1
  [ "$code" = 1 ] || fail "exit code 1, not $code, after the world has ended" "$folder/gone"
}

case_names_differ() {
  start_world one --port 7791 --announce
  wait_for 'announced in the local network as "arena" by' "$folder/one"
  start_world two --port 7792 --announce
  wait_for 'announced in the local network as "arena #2" by' "$folder/two"
  list table --for 3
  expect '10\.9\.0\.1:7791' "$folder/table"
  expect '10\.9\.0\.1:7792' "$folder/table"
}

# A guest may play where it was found, and ask by a program that is not ours.
case_gamedig_asks() {
  local gamedig="$root/client/page/node_modules/gamedig/bin/gamedig.js"
  { command -v node >/dev/null && [ -e "$gamedig" ]; } || { echo "skipped: gamedig is missing"; exit 77; }
  start_world world --port 7791 --name 'Ada'
  ip netns exec guest node "$gamedig" --type protocol-valve 10.9.0.1:7791 --pretty >"$folder/said" 2>&1
  expect '"name": "Ada"' "$folder/said"
  expect '"map": "arena"' "$folder/said"
}

# Avahi's daemon, with a message bus of its own; when it dies, the server announces for itself.
case_by_daemon() {
  for program in dbus-daemon avahi-daemon; do
    command -v "$program" >/dev/null || [ -x "/usr/sbin/$program" ] || { echo "skipped: $program is missing"; exit 77; }
  done
  [ "$WOBBLE_LAN" = root ] || { echo "skipped: the daemon has a user of its own, which only root may be"; exit 77; }
  export PATH="$PATH:/usr/sbin"
  mkdir -p /run/dbus
  cat >"$folder/bus.conf" <<END
<busconfig><type>system</type><listen>unix:path=/run/dbus/system_bus_socket</listen><auth>ANONYMOUS</auth>
<allow_anonymous/><policy context="default"><allow own="*"/><allow send_destination="*"/><allow receive_sender="*"/>
<allow user="*"/></policy></busconfig>
END
  printf '[server]\nhost-name=home\nallow-interfaces=home0\n[rlimits]\n' >"$folder/avahi.conf"
  ip netns exec home dbus-daemon --config-file="$folder/bus.conf" --fork
  ip netns exec home avahi-daemon --no-drop-root --no-chroot --no-rlimits -f "$folder/avahi.conf" >"$folder/avahi" 2>&1 &
  local daemon=$!
  wait_for 'Server startup complete' "$folder/avahi"
  start_world brief --port 7792 --announce --name Bo
  wait_for "announced in the local network as \"Bo\" by Avahi's daemon" "$folder/brief"
  kill -TERM "$world"
  wait "$world" || fail "a server that ends well" "$folder/brief"
  start_world world --port 7791 --announce --name Ada
  wait_for "announced in the local network as \"Ada\" by Avahi's daemon" "$folder/world"
  machine=home
  list by_daemon # which tells it that it is there
  # A daemon keeps what said goodbye for another second (RFC 6762, 10.1), and is late where others compute.
  for _ in 1 2 3 4 5; do
    grep -q '^Bo' "$folder/by_daemon" || break
    sleep 1
    list by_daemon
  done
  expect '^Ada *10\.9\.0\.1:7791 *arena' "$folder/by_daemon"
  if grep -q '^Bo' "$folder/by_daemon"; then fail "a world that has ended not to be listed" "$folder/by_daemon"; fi

  kill -9 "$daemon"
  wait_for 'announced in the local network as "Ada" by the server itself' "$folder/world"
  machine=guest
  rm -r /run/dbus # the guest has none
  list by_itself
  expect '^Ada *10\.9\.0\.1:7791 *arena' "$folder/by_itself"
  kill -TERM "$world"
  wait "$world" || fail "a server that ends well" "$folder/world"
}

lay_cable
"case_$case_name"
