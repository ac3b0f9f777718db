#!/usr/bin/env bash
# The programs as users run them: real processes, real sockets, exit codes and printed lines.
#
#   bash programs_test.sh CASE BIN_DIR
#
# The system picks the ports, so that cases run side by side. Cases wait for events and not for a number of seconds,
# because sanitizer builds take several times as long.
. "${0%/*}/case.sh"
readonly out="$folder/out" err="$folder/err" # output of the latest expect_exit
patience=60 # seconds after which a program counts as hung
readonly nobody=127.0.0.1:9 # no program listens on the port of "discard"
export TMPDIR="$folder" # `wobble play` puts it into the command lines it starts, where list_processes looks for it
# What programs keep for their user besides: blueprints, the keys of known servers.
export XDG_CACHE_HOME="$folder/cache" XDG_DATA_HOME="$folder/data"

clean_up() {
  local running
  exec 2>/dev/null # the shell would report each killed process
  for running in $(jobs -pr); do kill -KILL "$running" 2>/dev/null; done
  wait 2>/dev/null
  rm -rf "$folder"
}
trap clean_up EXIT
trap 'exit 1' HUP INT TERM

# start NAME PROGRAM ARGUMENT...: runs it in the background, with output in NAME.out and NAME.err. Its process is $pid.
start() {
  local name="$1"
  shift
  : >"$folder/$name.out" # must exist at once for functions that wait for a line in it
  "$bin/$1" "${@:2}" >"$folder/$name.out" 2>"$folder/$name.err" &
  pid=$!
}

# wait_for_line NAME PATTERN: waits until the program started under NAME has written the line.
wait_for_line() {
  local tries
  for ((tries = 0; tries < patience * 20; ++tries)); do
    grep -q -e "$2" "$folder/$1.out" && return
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.05
  done
  fail "a line '$2' from $1" "$folder/$1.out" "$folder/$1.err"
}

# wait_for_log NAME PATTERN: the same of its standard error.
wait_for_log() {
  local tries
  for ((tries = 0; tries < patience * 20; ++tries)); do
    grep -q -e "$2" "$folder/$1.err" && return
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.05
  done
  fail "a line '$2' from $1" "$folder/$1.out" "$folder/$1.err"
}

# read_port NAME TEXT: the number after this text in the output of the program started under NAME.
read_port() { sed -n "s/^$2\([1-9][0-9]*\).*/\1/p" "$folder/$1.out"; }

# wait_for_more NAME: waits until the program started under NAME has written another line.
wait_for_more() {
  local tries lines
  lines="$(wc -l <"$folder/$1.out")"
  for ((tries = 0; tries < patience * 20; ++tries)); do
    [ "$(wc -l <"$folder/$1.out")" -gt "$lines" ] && return
    sleep 0.05
  done
  fail "more lines from $1" "$folder/$1.out" "$folder/$1.err"
}

# start_server ARGUMENT...: returns when the server listens, on $port.
start_server() {
  start server wobbled --log-level warn --port 0 "$@"
  server=$pid
  wait_for_line server '^listening on UDP port [1-9]'
  port="$(read_port server 'listening on UDP port ')"
}

# expect_end NAME PID EXIT_CODE [SECONDS]: waits for the end of a program in the background.
expect_end() {
  local tries limit="${4:-$patience}" code
  for ((tries = 0; tries < limit * 20; ++tries)); do
    kill -0 "$2" 2>/dev/null || break
    sleep 0.05
  done
  kill -0 "$2" 2>/dev/null && fail "$1 to end within $limit s" "$folder/$1.out" "$folder/$1.err"
  wait "$2"
  code=$?
  [ "$code" -eq "$3" ] || fail "exit code $3 of $1, not $code" "$folder/$1.out" "$folder/$1.err"
}

# expect_exit EXIT_CODE PROGRAM ARGUMENT...
expect_exit() {
  local code
  timeout -k 5 "$patience" "$bin/$2" "${@:3}" >"$out" 2>"$err"
  code=$?
  [ "$code" -eq "$1" ] || fail "exit code $1 of '${*:2}', not $code" "$out" "$err"
}

# expect_line FILE PATTERN
expect_line() { grep -q -e "$2" "$1" || fail "a line '$2' in ${1##*/}" "$1"; }

# expect_lines FILE COUNT
expect_lines() { [ "$(wc -l <"$1")" -eq "$2" ] || fail "$2 lines in ${1##*/}" "$1"; }

# expect_refusal PATTERN PROGRAM ARGUMENT...: one clear line on standard error, nothing else, exit code 2.
expect_refusal() {
  expect_exit 2 "${@:2}"
  expect_lines "$err" 1
  expect_line "$err" "$1"
  [ ! -s "$out" ] || fail "nothing on standard output of '${*:2}'" "$out"
}

# read_figure SUMMARY KEY: prints nothing when the key is missing or not a number.
read_figure() { sed -n "s/^  \"$2\": \(-\{0,1\}[0-9][0-9.e+-]*\),\{0,1\}$/\1/p" "$1"; }

# expect_figure SUMMARY KEY CONDITION: a condition such as '== 32', '> 0'.
expect_figure() {
  local value
  value="$(read_figure "$1" "$2")"
  if [ -z "$value" ] || ! awk "BEGIN { exit !($value $3) }"; then fail "$2 $3 in ${1##*/}" "$1"; fi
}

# expect_keys SUMMARY KEY...
expect_keys() {
  local key
  for key in "${@:2}"; do grep -q "^  \"$key\": " "$1" || fail "the key $key in ${1##*/}" "$1"; done
}

# list_processes: our own programs that this case started.
list_processes() {
  local file line
  for file in /proc/[0-9]*/cmdline; do
    line="$({ tr '\0' ' ' <"$file"; } 2>/dev/null)" || continue
    [[ $line == "$bin/wobble"* && $line == *"$folder"* ]] && echo "$line"
  done
}

expect_no_processes() {
  list_processes >"$folder/processes"
  [ ! -s "$folder/processes" ] || fail "no process left over" "$folder/processes"
}

case_hosts_32_bots() {
  start_server --scene arena --for 14 --summary "$folder/a.json"
  expect_exit 0 wobble bots "127.0.0.1:$port" --script "$bin/scripts/wander.lua" --count 32 --ramp 2 --for 8 \
    --threshold 'disconnects==0' --summary "$folder/b.json"
  expect_line "$out" '^threshold disconnects==0: holds, it is 0$'
  expect_end server "$server" 0

  local version
  version="$("$bin/wobbled" --version)"
  for summary in a b; do expect_line "$folder/$summary.json" "^  \"version\": \"${version#wobbled }\",\$"; done
  expect_keys "$folder/a.json" ticks tick_ms_p50 tick_ms_p99 tick_ms_max overruns bodies awake_mean clients_peak joins \
    disconnects bytes_out bits_per_vertex snapshot_error_rms non_finite inverted quarantined state_hash
  # 14 s at 60 Hz; a sanitizer build cannot reach that, but must report by how much it is behind.
  local behind
  behind="$(read_figure "$folder/a.json" dropped_ticks) + $(read_figure "$folder/a.json" slowed_ticks)"
  expect_figure "$folder/a.json" ticks "+ $behind > 800"
  expect_figure "$folder/a.json" ticks "+ $behind < 850"
  expect_figure "$folder/a.json" ticks '> 100'
  expect_figure "$folder/a.json" tick_ms_p50 '> 0'
  expect_figure "$folder/a.json" bodies '>= 12'
  expect_figure "$folder/a.json" awake_mean '> 12'
  expect_figure "$folder/a.json" clients_peak '== 32'
  expect_figure "$folder/a.json" joins '== 32'
  expect_figure "$folder/a.json" disconnects '== 0'
  expect_figure "$folder/a.json" bytes_out '> 100000'
  expect_figure "$folder/a.json" bits_per_vertex '> 0'
  expect_figure "$folder/a.json" snapshot_error_rms '> 0'
  expect_figure "$folder/a.json" snapshot_error_rms '<= 4' # the coarsest target, % of a body's size
  expect_figure "$folder/a.json" non_finite '== 0'
  expect_line "$folder/a.json" '^  "state_hash": "[0-9a-f]\{16\}"$'

  expect_keys "$folder/b.json" bots connected join_ms_p99 disconnects snapshots snapshot_age_ms_p50 \
    snapshot_age_ms_p99 input_to_snapshot_ms_p50 stalls kbit_per_s_per_bot decode_us_p99 late_ms_p99 thresholds
  expect_figure "$folder/b.json" bots '== 32'
  expect_figure "$folder/b.json" connected '== 32'
  expect_figure "$folder/b.json" disconnects '== 0'
  expect_figure "$folder/b.json" script_errors '== 0'
  expect_figure "$folder/b.json" snapshots '> 1000'
  expect_figure "$folder/b.json" kbit_per_s_per_bot '> 0'
  expect_figure "$folder/b.json" input_to_snapshot_ms_p50 '> 0'
}

case_threshold_fails() {
  start_server
  expect_exit 99 wobble bots "127.0.0.1:$port" --script idle.lua --count 2 --for 2 \
    --threshold 'connected==2' --threshold 'disconnects>7' --summary "$folder/b.json"
  expect_line "$out" '^threshold connected==2: holds, it is 2$'
  expect_line "$out" '^threshold disconnects>7: FAILED, it is 0$'
  expect_line "$folder/b.json" '"rule": "disconnects>7"'
  expect_line "$folder/b.json" '"ok": false'
}

# make_page: makes a folder that the gateway accepts as the page.
make_page() { mkdir -p "$folder/page" && echo '<!doctype html><title>wobble</title>' >"$folder/page/index.html"; }

case_play_ends_by_itself() {
  make_page
  # The only case with fixed ports; other cases leave the choice to the system.
  expect_exit 0 wobble play --for 4 --port 7812 --http 8812 --page "$folder/page"
  expect_line "$out" '^scene arena on UDP port 7812'
  expect_line "$out" '^open http://localhost:8812 in a browser to play arena, sumo, curtain, sandbox$'
  expect_line "$out" ' | browsers 0/64, up 0 kbit/s, down 0 kbit/s | bots 6/6'
  expect_line "$out" '^gateway: 0 requests, 0 refused; 0 browsers'
  expect_line "$out" ' s left | .* clients 6 .* | bots 6/6'
  expect_line "$out" '^server: .* 6 joins, 0 disconnects, 0 non-finite'
  expect_line "$out" '^bots: 6 of 6 connected, 0 disconnects, 0 script errors'
  expect_line "$out" '^server of curtain: 0 ticks' # no player has joined
  expect_line "$out" '^bots in sumo: 2 of 2 connected, 0 disconnects'
  expect_line "$out" '^all went well$'
  if grep -q $'\e' "$out" "$err"; then fail "no colours away from a terminal" "$out" "$err"; fi
  expect_no_processes
}

case_play_ends_on_interrupt() {
  make_page
  start play wobble play --scene arena --port 0 --page "$folder/page" --record "$folder/recordings"
  wait_for_line play 'bots 6/6'
  expect_line "$folder/play.out" '^scene arena on UDP port [1-9][0-9]*; .* watch 127.0.0.1:[1-9]'
  expect_line "$folder/play.out" '^open http://localhost:[1-9][0-9]* in a browser to play arena$'
  [ "$(list_processes | wc -l)" -eq 4 ] || fail "play, server, gateway and bots to run" <(list_processes)
  kill -INT "$pid"
  expect_end play "$pid" 0 5
  expect_exit 0 wobbled --list-recordings "$folder/recordings"
  expect_line "$out" '^{"file":"arena-[0-9-]*.wobrec","scene":"arena","seconds":[0-9.]*,"writtenAt":[0-9]*}$'
  expect_line "$folder/play.out" '^server: .* 6 joins, 0 disconnects, 0 non-finite'
  expect_line "$folder/play.out" '^all went well$'
  expect_no_processes
}

# The page is optional for `wobble play`; without it, the program says so and goes on.
case_play_without_page() {
  expect_exit 0 wobble play --scene arena --for 2 --port 0 --bots 0 --page "$folder/none"
  expect_line "$out" "^no page for browsers: '.*none' is not there; "
  expect_line "$out" '^all went well$'
  expect_exit 0 wobble play --scene arena --for 1 --port 0 --bots 0 --http 0
  if grep -q -e page -e gateway "$out"; then fail "no word of a page" "$out"; fi
}

# find_program TEXT: the processes of this case whose command line has it.
find_program() {
  local file line
  for file in /proc/[0-9]*/cmdline; do
    line="$({ tr '\0' ' ' <"$file"; } 2>/dev/null)" || continue
    file="${file%/cmdline}"
    [[ $line == "$bin/wobble"*"$folder"* && $line == *"$1"* ]] && echo "${file##*/}"
  done
}

# kill_program TEXT: kills the one program of this case whose command line has it.
kill_program() { kill -KILL "$(find_program "$1")" || fail "one program with '$1'" <(list_processes); }

# Any part that dies is started again, the others go on, and players are back in their world.
case_play_starts_again_what_dies() {
  local tries play part
  make_page
  start play wobble play --scene arena --port 0 --page "$folder/page"
  play=$pid
  wait_for_line play 'bots 6/6'
  kill_program ' gateway '
  kill_program '/wobbled '
  for part in gateway server; do
    wait_for_log play "^$part: ended with exit code 137; starts again in 0.25 s$"
    wait_for_log play "^$part: is back after [0-9.]* s$"
  done
  for ((tries = 0; tries < 200; ++tries)); do
    tail -n 1 "$folder/play.out" | grep -q ' clients 6 .* | 1/1 worlds up | 2 restarts$' && break
    sleep 0.05
  done
  kill -INT "$play"
  expect_end play "$play" 0
  expect_line "$folder/play.out" '^gateway: 1 restart, [0-9.]* s down; the figures are those since$'
  expect_line "$folder/play.out" '^server: 1 restart, [0-9.]* s down; the figures are those since$'
  expect_line "$folder/play.out" '^bots: 6 of 6 connected, 6 disconnects'
  expect_line "$folder/play.out" '^all went well in the end: what had died came back (2 restarts)$'
  expect_no_processes
}

# Interrupted while its world still trains.
case_play_interrupted_at_once() {
  unset WOBBLE_CACHE WOBBLE_UNTRAINED
  start play wobble play --scene crowd --port 0 --http 0
  sleep 0.2
  kill -INT "$pid"
  expect_end play "$pid" 0 10
  expect_line "$folder/play.out" '^all went well$'
  expect_no_processes
}

# make_worlds: two worlds, with 4 and 2 bots, and a page.
make_worlds() {
  make_page
  cat >"$folder/worlds.toml" <<TOML
[gateway]
http = 0
page = "page"

[all]
port = 0
state = "worlds"
scene = "pair"

[[world]]
name = "one"
bots = 4

[[world]]
name = "two"
bots = 2
TOML
}

# One of two worlds is killed: its bots are back in their bodies within 3 s on the same port, those of the other notice
# nothing. And nothing outlives a fleet that is killed itself.
case_host_keeps_worlds_up() {
  local host tries down one
  make_worlds
  WOBBLE_UNTRAINED=1 start host wobble host "$folder/worlds.toml" --status 0.5
  host=$pid
  wait_for_line host '^world one, scene pair on UDP port [1-9]'
  one="$(read_port host 'world one, scene pair on UDP port ')"
  wait_for_line host '^open http://localhost:[1-9][0-9]* in a browser to play one, two$'
  wait_for_line host 'bots 4/4'
  for ((tries = 0; tries < 200; ++tries)); do
    [ "$(grep -c 'world two: .* joined$' "$folder/host.err")" -ge 2 ] && break
    sleep 0.05
  done
  sleep 1.2 # a state comes each second
  kill_program "--state=$folder/worlds/one"
  wait_for_log host '^world one: is back after [0-9.]* s$'
  down="$(sed -n 's/^world one: is back after \([0-9.]*\) s$/\1/p' "$folder/host.err")"
  awk "BEGIN { exit !($down <= 3) }" || fail "a world that is back within 3 s" "$folder/host.err"
  for ((tries = 0; tries < 200; ++tries)); do
    [ "$(grep -c '^world one: .*client [0-9]* (.*) is back$' "$folder/host.err")" -eq 4 ] && break
    sleep 0.05
  done
  [ "$tries" -lt 200 ] || fail "four bots back in their bodies" "$folder/host.err"
  kill -INT "$host"
  expect_end host "$host" 0 20
  expect_line "$folder/host.out" '^world one: 1 restart, [0-9.]* s down; the figures are those since$'
  expect_line "$folder/host.out" '^bots: 4 of 4 connected, 4 disconnects'
  expect_line "$folder/host.out" '^world two: .* 2 joins, 0 disconnects'
  expect_line "$folder/host.out" '^bots in two: 2 of 2 connected, 0 disconnects'
  expect_line "$folder/host.out" '^all went well in the end: what had died came back (1 restart)$'
  expect_no_processes
  WOBBLE_UNTRAINED=1 WOBBLE_BOTS=0 WOBBLE_WORLD_TWO_PORT="$one" start again wobble host "$folder/worlds.toml"
  host=$pid
  wait_for_line again "^world two, scene pair on UDP port $one"
  wait_for_line again '^open http://localhost:.* to play one, two$'
  # The file is read again: one world goes, another comes, and the third is the same process as before.
  local two
  two="$(find_program "--state=$folder/worlds/two")"
  echo 'port = 99999' >>"$folder/worlds.toml"
  kill -HUP "$host"
  wait_for_log again '^wobble host: .*worlds.toml has mistakes: all goes on as it was$'
  sed -i '$d; s/^name = "one"/name = "three"/' "$folder/worlds.toml"
  kill -HUP "$host"
  wait_for_line again '^world three, scene pair on UDP port '
  wait_for_line again '^open http://localhost:.* to play two, three$'
  [ "$(find_program "--state=$folder/worlds/two")" = "$two" ] || fail "the world two as it was" "$folder/again.err"
  [ -z "$(find_program "--state=$folder/worlds/one")" ] || fail "no world one" "$folder/again.err"
  # Other bots are no other world.
  sed -i 's/^bots = 2/bots = 1/' "$folder/worlds.toml"
  kill -HUP "$host"
  wait_for_log again '^bots in two: ends, as its file says now$'
  [ "$(find_program "--state=$folder/worlds/two")" = "$two" ] || fail "the world two as it was" "$folder/again.err"
  kill -KILL "$host"
  wait "$host" 2>/dev/null
  for ((tries = 0; tries < 40; ++tries)); do [ -z "$(list_processes)" ] && break; sleep 0.05; done
  expect_no_processes
}

# Every mistake of a file and of the environment, in one run, whoever finds it; and nothing is started.
case_host_names_every_mistake() {
  make_worlds
  WOBBLE_PAGE="$folder/page" expect_exit 0 wobble host --check
  expect_line "$out" 'worlds.toml: 3 worlds and a gateway, no mistake$'
  cat >"$folder/bad.toml" <<'TOML'
[[blueprint]]
name = "ball"
mass = 0

[player]
blueprint = "ball"
TOML
  cat >>"$folder/worlds.toml" <<TOML
max_clients = 5000
tick_hz = 1
after_match = "dance"
log_level = "loud"
password_file = "none"
clients = 3

[[world]]
scene = "bad.toml"
port = 70000
threads = "all"
TOML
  sed -i 's/^http = 0/http = 0\nmax_connections = 0\norigin = "here"/' "$folder/worlds.toml"
  WOBBLE_SEED=-1 WOBBLE_WORLD_ONE_CLIENT_KBIT=1 WOBBLE_WORLD_TOW_PORT=7 expect_exit 2 wobble host "$folder/worlds.toml"
  [ ! -s "$out" ] || fail "nothing started" "$out"
  local expected
  for expected in \
    'worlds.toml:24: clients is no key here' \
    'worlds.toml:28: port = 70000: must be a whole number from 0 to 65535' \
    "worlds.toml:29: threads = 'all': must be a whole number" \
    'WOBBLE_WORLD_TOW_PORT is no key of a world; did you mean WOBBLE_WORLD_TWO_PORT?' \
    'WOBBLE_SEED = -1: must be 0 to 9007199254740992' \
    'WOBBLE_WORLD_ONE_CLIENT_KBIT = 1: must be 32 to 100000' \
    'worlds.toml:19: max_clients = 5000: must be 1 to 4000' \
    'worlds.toml:20: tick_hz = 1: must be 10 to 480' \
    "worlds.toml:21: after_match = 'dance': must be end, restart or next" \
    "worlds.toml:22: log_level = 'loud': must be one of debug, info, warn, error, off" \
    'worlds.toml:23: password_file = .none.: .*none: cannot be read' \
    'worlds.toml:27: world bad: bad.toml:3: mass = 0: must be 0.001 to 1000000 kg' \
    'worlds.toml:3: max_connections = 0: .0. is not 1 to 1000' \
    "worlds.toml:4: origin = 'here': 'here' is no http"; do
    expect_line "$err" "^wobble host: $expected"
  done
  expect_lines "$err" 14
}

case_port_in_use() {
  start_server
  expect_refusal "^wobbled: port $port (UDP) is in use$" wobbled --port "$port"
  expect_refusal "^wobble play: the server: port $port (UDP) is in use$" wobble play --scene arena --port "$port" --for 5
  # At once, though a world beside it would train for long.
  local before=$SECONDS
  WOBBLE_CACHE='' WOBBLE_UNTRAINED='' expect_refusal "^wobble play: the server of pair: port $port (UDP) is in use$" \
    wobble play --scene crowd --scene pair --port "$((port - 1))" --for 5
  [ $((SECONDS - before)) -le 2 ] || fail "the taken port at once, not after $((SECONDS - before)) s"
  make_page
  start gateway wobble gateway --server "127.0.0.1:$port" --http 0 --page "$folder/page"
  local gateway=$pid http
  wait_for_line gateway '^open http://localhost:[1-9]'
  http="$(read_port gateway 'open http:\/\/localhost:')"
  expect_refusal "^wobble gateway: port $http (TCP) is in use; " \
    wobble gateway --server "127.0.0.1:$port" --http "$http" --page "$folder/page"
  expect_refusal "^wobble play: the page's port $http (TCP) is in use$" \
    wobble play --scene arena --port 0 --http "$http" --page "$folder/page" --for 5
  kill -TERM "$gateway"
  expect_end gateway "$gateway" 0 5
  kill -TERM "$server"
  expect_end server "$server" 0 10
  expect_no_processes
}

# read_key NAME: the public key that the server started under NAME has logged.
read_key() { sed -n "s/.* this server's key is \([0-9a-f]\{64\}\)$/\1/p" "$folder/$1.err"; }

# The same key at each start, and the same for servers that start at once.
case_keeps_its_key() {
  local i key file="$XDG_STATE_HOME/wobble/server.key" servers=()
  for i in 1 2 3 4; do
    start "server$i" wobbled --port 0 --untrained --for 0.001
    servers+=("$pid")
  done
  for i in 1 2 3 4; do expect_end "server$i" "${servers[i - 1]}" 0; done
  key="$(read_key server1)"
  [ "${#key}" -eq 64 ] || fail "a key" "$folder/server1.err"
  for i in 2 3 4; do [ "$(read_key "server$i")" = "$key" ] || fail "the key $key" "$folder/server$i.err"; done
  [ "$(stat -c %a "$file")" = 600 ] || fail "a file for its owner alone" <(ls -l "$file")
  [ "$(echo $(ls "$XDG_STATE_HOME/wobble"))" = "owner.key server.key" ] || fail "no other file" <(ls "$XDG_STATE_HOME/wobble")
  if grep -q "$key" "$file"; then fail "a secret that is not printed" "$file"; fi

  expect_exit 0 wobbled --port 0 --untrained --for 0.001 --key "$folder/other.key"
  cp "$err" "$folder/other.err"
  [ "$(read_key other)" != "$key" ] || fail "another key" "$folder/other.err"
  echo 1234 >"$folder/bad.key"
  expect_refusal "^wobbled: --key: key file $folder/bad.key: must hold 64 hexadecimal digits$" \
    wobbled --log-level warn --port 0 --untrained --key "$folder/bad.key"
  expect_refusal '^wobbled: --key: key file /proc/none/server.key: No such file or directory$' \
    wobbled --log-level warn --port 0 --untrained --key /proc/none/server.key
  # Without a place for it, a server plays all the same.
  XDG_STATE_HOME=/proc/none expect_exit 0 wobbled --port 0 --untrained --for 0.001
  expect_line "$err" "the server's key holds for this run only: key file /proc/none/wobble/server.key: "
}

# In with the password, and only to the server that has the key.
case_password() {
  local join=(wobble bots --script idle.lua --count 1 --for 0.5)
  echo 'open sesame' >"$folder/door.txt"
  echo 'open simsim' >"$folder/wrong.txt"
  : >"$folder/empty.txt"
  start_server --untrained --scene pair --password-file "$folder/door.txt"
  expect_refusal 'could join .*: the password, invite or token is missing or not valid, or too many .* wait 5 s$' "${join[@]}" "127.0.0.1:$port"
  expect_refusal 'could join .*: the password, invite or token is missing or not valid, or too many .* wait 5 s$' \
    "${join[@]}" "127.0.0.1:$port" --password-file "$folder/wrong.txt"
  expect_exit 0 "${join[@]}" "127.0.0.1:$port" --password-file "$folder/door.txt" --threshold 'connected==1'
  expect_exit 0 "${join[@]}" "[::1]:$port" --password-file "$folder/door.txt" --threshold 'connected==1'
  expect_refusal "could join .*: the server's key is not the one that is known for this address$" \
    "${join[@]}" "127.0.0.1:$port" --password-file "$folder/door.txt" --server-key "$(printf '%064d' 1)"
  mkdir -p "$XDG_DATA_HOME/wobble"
  echo "127.0.0.1:$port $(printf '%064d' 1)" >"$XDG_DATA_HOME/wobble/known_servers"
  expect_refusal "known for this address; if its host .*, delete the line of 127.0.0.1:$port in $XDG_DATA_HOME/wobble/known_servers$" \
    "${join[@]}" "127.0.0.1:$port" --password-file "$folder/door.txt"
  rm "$XDG_DATA_HOME/wobble/known_servers"
  expect_refusal '--server-key' "${join[@]}" "127.0.0.1:$port" --server-key 1234
  expect_refusal 'empty.txt: the first line must have 1 to 512 bytes' \
    "${join[@]}" "127.0.0.1:$port" --password-file "$folder/empty.txt"
  expect_refusal 'the first line must have 1 to 512 bytes' wobbled --port 0 --untrained --password-file /dev/zero
  # SIGHUP reads the file again; a faulty one changes nothing.
  echo 'open simsim' >"$folder/door.txt"
  kill -HUP "$server"
  expect_exit 0 "${join[@]}" "127.0.0.1:$port" --password-file "$folder/wrong.txt" --threshold 'connected==1'
  : >"$folder/door.txt"
  kill -HUP "$server"
  pid=$server wait_for_log server 'error nothing is read again: --password-file: .* must have 1 to 512 bytes'
  expect_exit 0 "${join[@]}" "127.0.0.1:$port" --password-file "$folder/wrong.txt" --threshold 'connected==1'
  kill -TERM "$server"
  expect_end server "$server" 0
}

# Orders by the socket, an invite as it is printed, and tokens with what they say.
case_administration() {
  local join=(wobble bots --script idle.lua --count 1 --for 0.5) socket="$folder/admin.sock"
  start server wobbled --port 0 --untrained --scene pair --invites "$folder/invites" \
    --token-key "$folder/token.key" --admin-socket "$socket"
  wait_for_line server '^listening on UDP port [1-9]'
  port="$(read_port server 'listening on UDP port ')"
  expect_exit 0 wobble admin --socket "$socket" invite uses 2 for 1h
  cp "$out" "$folder/invite.txt"
  sed -n 's/^.*#invite=/http:\/\/host:8080\/?world=a#invite=/p' "$out" >"$folder/link.txt"
  expect_exit 0 "${join[@]}" "127.0.0.1:$port" --invite-file "$folder/invite.txt" --threshold 'connected==1'
  expect_exit 0 "${join[@]}" "127.0.0.1:$port" --invite-file "$folder/link.txt" --threshold 'connected==1'
  expect_refusal 'could join .*: the password, invite or token is missing' \
    "${join[@]}" "127.0.0.1:$port" --invite-file "$folder/invite.txt"
  expect_line "$folder/server.err" 'not let in: wrong invite (1, last from 127.0.0.1)$'
  expect_exit 1 wobble admin --socket "$socket" mute 7 for 1h now
  expect_line "$err" '^wobble admin: mute takes PLAYER \[for TIME\]; too much: now$'
  expect_refusal '^wobble admin: the order is empty' wobble admin --socket "$socket" ''

  # What the server warns of at its start.
  chmod 644 "$folder/token.key"
  expect_exit 0 wobbled --port 0 --untrained --for 0.001 --token-key "$folder/token.key" --admin-http 0.0.0.0:0
  expect_line "$out" '^orders on TCP port [1-9][0-9]* of 0.0.0.0$'
  expect_line "$err" "warning $folder/token.key: everybody on this machine can read it"
  expect_line "$err" 'warning --admin-http 0.0.0.0:0: other machines reach it'

  expect_exit 0 wobble token --key "$folder/token.key" --rank moderator --account 18446744073709551615
  cp "$out" "$folder/token.txt"
  expect_exit 0 "${join[@]}" "127.0.0.1:$port" --token-file "$folder/token.txt" --threshold 'connected==1'
  expect_refusal "^wobble token: --rank: 'king' must be watcher, player, moderator or owner$" \
    wobble token --key "$folder/token.key" --rank king
  expect_refusal "^wobble token: --account: '-1' must be a number from 0 to 18446744073709551615$" \
    wobble token --key "$folder/token.key" --account -1
  expect_refusal '^wobble token: --key is required (see wobble token --help)$' wobble token
  expect_exit 0 wobble token --help
  ! grep -q "$(printf '\033')" "$out" || fail 'no control characters' "$out"
  expect_line "$out" '--rank RANK=player  *watcher, player, moderator or owner$'
}

case_unknown_option() {
  local program
  for program in wobbled wobble 'wobble bots' 'wobble play' 'wobble host' 'wobble watch' 'wobble link' 'wobble gateway'; do
    # shellcheck disable=SC2086  # program and command are two words
    expect_refusal "--frobnicate.*$program --help\|--frobnicate.*wobble --help" $program --frobnicate
  done
  expect_refusal 'dance' wobble dance
  expect_refusal 'command is required, one of: ' wobble
  expect_refusal '^wobble bots: HOST:PORT of the server is required' wobble bots --script idle.lua
  expect_refusal '^wobble bots: --script is required' wobble bots "$nobody"
  expect_refusal "'nowhere' is no HOST:PORT" wobble bots nowhere --script idle.lua
  expect_refusal '^wobble watch: HOST:PORT of the server is required' wobble watch
  expect_refusal "^wobble watch: server: 'nowhere:0' is no HOST:PORT" wobble watch nowhere:0
  expect_refusal "^wobble watch: --fps: '0' is not 1 to 60" wobble watch "$nobody" --fps 0
  expect_refusal '^wobble watch: --colours: 7 not in' wobble watch "$nobody" --colours 7
  expect_refusal '^wobble watch: --name: .* is 33 bytes long' wobble watch "$nobody" \
    --name 123456789012345678901234567890123
  expect_refusal '^wobble watch: standard output is no terminal$' wobble watch "$nobody"
  expect_refusal '^wobble gateway: --server HOST:PORT is required' wobble gateway
  expect_refusal "^wobble gateway: --server: 'here' is no HOST:PORT" wobble gateway --server here
  expect_refusal "^wobble gateway: --server: 'a b=c:1' needs a name of letters, digits, - and _, at most 32" \
    wobble gateway --server 'a b=c:1'
  expect_refusal "^wobble gateway: --server: 'c:1' needs a name" wobble gateway --server a=b:1 --server c:1
  expect_refusal "^wobble gateway: --server: 'a' names two servers" wobble gateway --server a=b:1 --server a=c:1
  expect_refusal "^wobble play: --port 65534: 4 worlds need as many ports up to 65535" wobble play --port 65534
  expect_refusal "^wobble gateway: --http: '70000' is not 0 to 65535" wobble gateway --server "$nobody" --http 70000
  expect_refusal "^wobble gateway: --bind: 'here' is no IP address" wobble gateway --server "$nobody" --bind here
  expect_refusal "^wobble gateway: --origin: 'http://a/b' is no " \
    wobble gateway --server "$nobody" --origin http://c:81 --origin http://a/b
  expect_refusal "^wobble gateway: no page: '$folder/index.html' is not there" \
    wobble gateway --server "$nobody" --page "$folder"
  expect_refusal '^wobbled: --port 99999: must be 0 to 65535$' wobbled --port 99999
  expect_refusal '^wobbled: --for -3: must be 0 to 1000000, such as 90, 90s, ' wobbled --for -3
  expect_refusal '^wobbled: --for nan: must be 0 to 1000000, such as 90, 90s, ' wobbled --for nan
  expect_refusal "^wobble play: --for: '1d' is no duration; write 90 or 90s, " wobble play --for 1d
  expect_exit 0 wobbled --port 0 --untrained --scene pair --for 100ms
  expect_refusal '^wobble bots: there is no option --cout; did you mean --count? (see wobble bots --help)$' \
    wobble bots "$nobody" --cout 3
  expect_refusal '^wobbled: there is no option --max-client; did you mean --max-clients? (see wobbled --help)$' \
    wobbled --max-client 3
  expect_refusal '^wobble: there is no command gatway; did you mean gateway? (see wobble --help)$' wobble gatway

  # The same by the environment, which mistakes name; the command line wins.
  WOBBLE_PORT=99999 expect_refusal '^wobbled: WOBBLE_PORT 99999: must be 0 to 65535$' wobbled
  WOBBLE_SUMMARY=/no/such/file expect_refusal '^wobbled: WOBBLE_SUMMARY /no/such/file: cannot be written$' wobbled --port 0
  WOBBLE_HTTP=70000 expect_refusal "^wobble gateway: WOBBLE_HTTP: '70000' is not 0 to 65535" \
    wobble gateway --server "$nobody"
  WOBBLE_BIND=here expect_refusal "^wobble gateway: WOBBLE_BIND: 'here' is no IP address" wobble gateway --server "$nobody"
  WOBBLE_PORT=99999 WOBBLE_SCENE=pair expect_exit 0 wobbled --port 0 --untrained --for 0.01
  expect_line "$out" ', scene pair$'
  # A child has its options from its parent alone.
  WOBBLE_SCENE=pair WOBBLE_PORT=0 WOBBLE_FOR=0.5 WOBBLE_BOTS=0 WOBBLE_HTTP=0 WOBBLE_TICK_HZ=1 expect_exit 0 wobble play
  expect_line "$out" '^scene pair on UDP port [1-9]'
  expect_refusal '^wobbled: --snapshot-hz 90: must be 1 to 60$' wobbled --port 0 --snapshot-hz 90
  local option # an empty word is an unset variable of a script, and no way to start something else
  for option in --replay --list-recordings --record --state --rotation --scene --cache --summary; do
    expect_refusal "^wobbled: $option: must not be empty" wobbled --port 0 --for 0.01 --untrained "$option" ''
  done
  expect_refusal '^wobble gateway: --recordings: must not be empty' wobble gateway --server "$nobody" --recordings ''
  expect_refusal '^wobble export: --output: must not be empty' wobble export match.wobrec --output ''
  expect_refusal '^wobbled: --log-level loud: must be one of' wobbled --log-level loud
  expect_refusal '^wobbled: --log-format xml: must be text or json$' wobbled --log-format xml
  expect_refusal '^wobbled: --summary /no/such/file: cannot be written$' wobbled --port 0 --summary /no/such/file
  expect_refusal "^wobble bots: --count: '0' is not 1 to 10000" wobble bots "$nobody" --script idle.lua --count 0
  expect_refusal "^wobble bots: --seed: '-1' is not 0 to " wobble bots "$nobody" --script idle.lua --seed -1
  expect_refusal "unknown key 'joy'" wobble bots "$nobody" --script idle.lua --threshold 'joy>1'

  expect_exit 2 wobbled --tick-hz fast --threads 0 --scene nowhere # all errors, one per line
  expect_lines "$err" 3
  expect_line "$err" '^wobbled: --tick-hz fast: must be 10 to 480$'
  expect_line "$err" '^wobbled: --threads 0: must be 1 to 256$'
}

case_bad_scene() {
  cat >"$folder/bad.toml" <<'TOML'
[[obstacle]]
kind = "plane"
friction = -1

[[blueprint]]
name = "ball"
mass = 0

[player]
blueprint = "bal"
TOML
  expect_exit 2 wobbled --port 0 --scene "$folder/bad.toml"
  expect_lines "$err" 3
  expect_line "$err" '^wobbled: bad.toml:3: friction = -1: must be 0 to 10$'
  expect_line "$err" '^wobbled: bad.toml:7: mass = 0\(\.0\)\{0,1\}: must be 0.001 to 1000000 kg$'
  expect_line "$err" "^wobbled: bad.toml:10: blueprint = 'bal': must be one of: ball$"
  [ ! -s "$out" ] || fail "nothing to listen" "$out"
  expect_refusal "scene 'aren' is not known; one of: arena, backtracking, ball_drop, breathing, " wobbled --port 0 --scene aren
  expect_refusal "scene file '$folder/none.toml' cannot be read" wobbled --port 0 --scene "$folder/none.toml"
  printf 'gravity = \n' >"$folder/bad.toml"
  expect_refusal '^wobbled: bad.toml:1: ' wobbled --port 0 --scene "$folder/bad.toml"
  { printf 'a.%.0s' $(seq 50000); echo 'a = 1'; } >"$folder/bad.toml"
  expect_refusal '^wobbled: bad.toml:1: key = a\.a\.a.*: must be of 1 to 16 parts' wobbled --port 0 --scene "$folder/bad.toml"
  printf '[[blueprint]]\nname = "b"\nkind = "mesh"\nfile = "/dev/zero"\n[player]\nblueprint = "b"\n' >"$folder/bad.toml"
  expect_refusal '^wobbled: bad.toml:4: file = /dev/zero: is a device, not a regular file of at most 4 MiB' \
    wobbled --port 0 --scene "$folder/bad.toml"
  mkfifo "$folder/fifo.toml"
  expect_refusal "^wobbled: scene file '$folder/fifo.toml' is a FIFO, not a regular file of at most 1 MiB" \
    wobbled --port 0 --scene "$folder/fifo.toml"
}

case_no_server() {
  expect_refusal '^wobble bots: no server answers at 127.0.0.1:9$' \
    wobble bots "$nobody" --script idle.lua --count 3
}

case_wrong_version() {
  start_server
  expect_refusal 'wrong protocol version: server speaks version [0-9]*, client 9$' \
    wobble bots "127.0.0.1:$port" --script idle.lua --protocol-version 9
}

case_broken_script() {
  printf 'function run(bot)\n  bot:move(1 0)\nend\n' >"$folder/syntax.lua"
  expect_refusal "^wobble bots: $folder/syntax.lua:2: " wobble bots "$nobody" --script "$folder/syntax.lua"
  printf 'print(1)\n' >"$folder/norun.lua"
  expect_exit 2 wobble bots "$nobody" --script "$folder/norun.lua"
  expect_line "$err" 'norun.lua: defines no function run(bot)$'
  expect_refusal 'absent.lua: cannot be read' wobble bots "$nobody" --script "$folder/absent.lua"
}

# An endless loop, or one call that would take years, stops its own bot with a message that names the line; the others
# go on.
case_endless_loop_stops_one() {
  cat >"$folder/loop.lua" <<'LUA'
function run(bot)
  bot:wait(0.5)
  if bot:id() == 2 then
    while true do end
  elseif bot:id() == 3 then
    local text = ('a'):rep(5000)
    print(text:find('.-.-.-.-.-b'))
  end
  for i = 1, 10 do
    bot:move(bot:random(-1, 1), 1)
    bot:wait(0.1)
  end
  print('went on for a second')
end
LUA
  start_server
  expect_exit 0 wobble bots "127.0.0.1:$port" --script "$folder/loop.lua" --count 4 --for 3 --summary "$folder/b.json" \
    --threshold 'disconnects==0'
  expect_line "$err" '^wobble bots: bot 2 stands still: .*loop.lua:4: stopped after'
  expect_line "$err" '^wobble bots: bot 3 stands still: .*loop.lua:7: stopped: '
  expect_line "$err" '^bot 1: went on for a second$'
  expect_line "$err" '^bot 4: went on for a second$'
  expect_figure "$folder/b.json" connected '== 4'
  expect_figure "$folder/b.json" script_errors '== 2'
}

case_storm_joins_and_leaves() {
  start_server --summary "$folder/a.json"
  expect_exit 0 wobble bots "127.0.0.1:$port" --script storm.lua --count 8 --for 6s --summary "$folder/b.json" \
    --threshold 'disconnects==0' --threshold 'joins>=12'
  expect_line "$out" '^8 of 8 bots connected ([0-9]* joins), 0 disconnects, 0 script errors'
  kill -INT "$server"
  expect_end server "$server" 0
  expect_figure "$folder/b.json" connected '== 8'
  # A bot that stops or leaves before its welcome arrives does not count the join; the server does.
  local joins
  joins="$(read_figure "$folder/b.json" joins)"
  expect_figure "$folder/a.json" joins ">= $joins"
  expect_figure "$folder/a.json" joins "<= $joins + 8"
  expect_figure "$folder/a.json" disconnects '== 0'
  expect_figure "$folder/a.json" non_finite '== 0'
}

# Players who come and go over a bad link, with trained bases: over this one of eighteen joins failed once. A night has
# 10,000 of them (WOBBLE_JOIN_SECONDS, WOBBLE_JOIN_BOTS, WOBBLE_JOINS).
case_joins_over_loss() {
  local seconds="${WOBBLE_JOIN_SECONDS:-15}" joins="${WOBBLE_JOINS:-40}"
  start_server --max-clients 200
  patience=$((seconds + 60))
  expect_exit 0 wobble bots "127.0.0.1:$port" --script storm.lua --count "${WOBBLE_JOIN_BOTS:-24}" --for "${seconds}s" \
    --ramp 2 --link 'loss=20%,delay=100ms,jitter=50ms,reorder=4%,duplicate=5%' --summary "$folder/joins.json" \
    --threshold 'disconnects==0' --threshold "joins>=$joins"
  cat "$out"
}

case_stages_go_up_and_down() {
  start_server --summary "$folder/a.json"
  expect_exit 0 wobble bots "127.0.0.1:$port" --script chase.lua --stage 2s:6 --stage 1s:6 --stage 2000ms:1 --status 0.5 \
    --summary "$folder/b.json" --threshold 'disconnects==0'
  expect_line "$out" '^bots [1-5]/6 stage 1/3 [0-9]*%, [0-9]* s left, '
  expect_line "$out" '^bots 6/6 stage 2/3 [4-5][0-9]%, [0-9]* s left, '
  expect_line "$out" '^bots [1-6]/1 stage 3/3 [6-9][0-9]%, [0-2] s left, '
  kill -INT "$server"
  expect_end server "$server" 0
  expect_figure "$folder/b.json" bots '== 6'
  expect_figure "$folder/b.json" connected '== 6'
  expect_figure "$folder/b.json" joins '== 6'
  expect_figure "$folder/b.json" script_errors '== 0'
  expect_figure "$folder/a.json" joins '== 6'
  expect_figure "$folder/a.json" clients_peak '== 6'
  expect_figure "$folder/a.json" disconnects '== 0'

  expect_exit 2 wobble bots 7962 --script idle.lua --stage 5s:10001 --stage 0s:5 --count 3 --for 1d --threshold 'joy>1'
  expect_lines "$err" 7 # all errors, one per line
  expect_line "$err" "^wobble bots: server: '7962' is no HOST:PORT"
  expect_line "$err" "^wobble bots: --for: '1d' is no duration; "
  expect_line "$err" "^wobble bots: --threshold: 'joy>1': unknown key 'joy'"
  expect_line "$err" "^wobble bots: --stage: '5s:10001' is no stage; "
  expect_line "$err" "^wobble bots: --stage: '0s:5' is no stage; "
  expect_line "$err" '^wobble bots: --count: not together with --stage'
}

# send_noise PORT SEED COUNT: sends datagrams of 1 to 120 random bytes from COUNT ports; the same bytes for the same
# seed.
send_noise() {
  local datagram i size text
  RANDOM=$2
  for ((datagram = 0; datagram < $3; ++datagram)); do
    size=$((RANDOM % 120 + 1))
    text=''
    for ((i = 0; i < size; ++i)); do printf -v text '%s\\x%02x' "$text" $((RANDOM % 256)); done
    # shellcheck disable=SC2059  # the bytes are the format
    printf "$text" >"/dev/udp/127.0.0.1/$1"
  done
}

case_random_datagrams() {
  start_server --summary "$folder/a.json"
  start bots wobble bots "127.0.0.1:$port" --script wander.lua --count 4 --status 0.5 --summary "$folder/b.json" \
    --threshold 'disconnects==0'
  local bots=$pid round
  wait_for_line bots '^bots 4/4'
  for round in 1 2 3 4; do
    echo "noise with seed $round"
    send_noise "$port" "$round" 150
    sleep 0.2
  done
  wait_for_more bots
  kill -0 "$bots" 2>/dev/null || fail "bots that still play after the noise" "$folder/bots.out" "$folder/bots.err"
  kill -INT "$bots"
  expect_end bots "$bots" 0
  kill -INT "$server"
  expect_end server "$server" 0
  expect_figure "$folder/a.json" datagrams_rejected '>= 500'
  expect_figure "$folder/a.json" joins '== 4'
  expect_figure "$folder/a.json" disconnects '== 0'
  expect_figure "$folder/a.json" refusals '== 0'
  expect_figure "$folder/b.json" disconnects '== 0'
  # Warnings about the load level are allowed: the machine may be slow.
  ! grep -qv 'load level' "$folder/server.err" || fail "a server that notices nothing" "$folder/server.err"
}

# A processor without AVX, emulated.
case_old_processor() {
  local program
  for program in wobbled wobble; do
    qemu-x86_64 -cpu Nehalem "$bin/$program" --version >"$out" 2>"$err"
    [ $? -eq 2 ] || fail "exit code 2 of $program" "$out" "$err"
    expect_line "$err" '^This program needs a processor of level x86-64-v3 '
    [ ! -s "$out" ] || fail "no other output of $program" "$out"
  done
}

case_help_and_version() {
  local program
  for program in wobbled wobble 'wobble bots' 'wobble play' 'wobble host' 'wobble watch' 'wobble link' 'wobble gateway'; do
    # shellcheck disable=SC2086  # program and command are two words
    expect_exit 0 $program --help
    expect_line "$out" '^Examples:'
    expect_line "$out" "^  ${program%% *} "
    # shellcheck disable=SC2086
    expect_exit 0 $program --version
    expect_line "$out" "^${program%% *} [0-9][0-9]*\.[0-9][0-9]*\.[0-9][0-9]*$"
  done
  expect_exit 0 wobbled --list-scenes
  expect_line "$out" '^arena '
}

case_link_alone() {
  start_server --summary "$folder/a.json"
  start link wobble link --listen 0 --to "localhost:$port" 'loss=5%,delay=50ms,jitter=20ms,duplicate=2%,reorder=2%' \
    --seed 3 --status 0.5 --bind 127.0.0.1
  local link=$pid link_port
  wait_for_line link "^relaying UDP port [1-9][0-9]* of 127.0.0.1 to localhost:$port, loss=5%"
  link_port="$(read_port link 'relaying UDP port ')"
  expect_exit 0 wobble bots "127.0.0.1:$link_port" --script wander.lua --count 4 --for 5 --threshold 'disconnects==0' \
    --threshold 'connected==4' --threshold 'input_to_snapshot_ms_p50>100' # two delays of 50 ms
  wait_for_line link '^players 4, up [0-9]* kbit/s in '
  expect_refusal "^wobble link: port $link_port (UDP) is in use$" wobble link --listen "$link_port" --to "127.0.0.1:$port"
  expect_refusal "^wobble link: 'here' is no IPv4 address to listen at$" \
    wobble link --listen 0 --bind here --to "127.0.0.1:$port"
  kill -INT "$link"
  expect_end link "$link" 0
  expect_line "$folder/link.out" '^up: [1-9][0-9]* received, [1-9][0-9]* passed, [1-9][0-9]* lost, [1-9][0-9]* duplicated'
  expect_line "$folder/link.out" '^down: [1-9][0-9]* received, .* [1-9][0-9]* reordered, 0 over rate, 0 blacked out'
  expect_line "$folder/link.out" '^players: 4, 0 datagrams of too many, all left '
  kill -INT "$server"
  expect_end server "$server" 0
  expect_figure "$folder/a.json" joins '== 4'
  expect_figure "$folder/a.json" disconnects '== 0'
}

case_bots_with_link() {
  start_server
  # A link that passes nothing looks like a missing server. The bots wait long for one, so other bots play meanwhile.
  start lost wobble bots "127.0.0.1:$port" --script idle.lua --count 2 --link 'loss=100%'
  local lost=$pid
  expect_exit 0 wobble bots "127.0.0.1:$port" --script wander.lua --count 4 --for 5 \
    --link 'up.loss=20%,delay=50ms,blackout=1s/4s' --threshold 'disconnects==0' --threshold 'connected==4'
  expect_line "$out" '^link up: [1-9][0-9]* received, [1-9][0-9]* passed, [1-9][0-9]* lost, 0 duplicated'
  expect_line "$out" '^link down: [1-9][0-9]* received, [1-9][0-9]* passed, 0 lost, .* [1-9][0-9]* blacked out'
  expect_end lost "$lost" 2
  expect_line "$folder/lost.err" '^wobble bots: no server answers at 127.0.0.1:'"$port$"
}

case_bad_link() {
  expect_refusal '^wobble link: loss=120%: must be 0% to 100%$' wobble link --listen 0 --to "$nobody" 'loss=120%'
  expect_refusal "^wobble link: 'los' is not known: must be loss, delay," wobble link --listen 0 --to "$nobody" 'los=1%'
  expect_refusal '^wobble bots: --link: delay=50: must be 0ms to 10s$' \
    wobble bots "$nobody" --script idle.lua --link 'delay=50'
  expect_refusal '^wobble link: --listen PORT is required' wobble link --to "$nobody"
  expect_refusal '^wobble link: --to HOST:PORT is required' wobble link --listen 0
  expect_refusal "^wobble link: --to: 'nowhere' is no HOST:PORT" wobble link --listen 0 --to nowhere
  expect_refusal '^wobble link: no IPv4 address is known for "no.such.host.invalid"$' \
    wobble link --listen 0 --to no.such.host.invalid:9
  expect_refusal "^wobble link: --listen: '65536' is not 0 to 65535" wobble link --listen 65536 --to "$nobody"
}

# get PORT PATH: prints the body of the answer of the endpoint on this machine.
get() {
  exec 3<>"/dev/tcp/127.0.0.1/$1" || fail "somebody on port $1"
  printf 'GET %s HTTP/1.0\r\n\r\n' "$2" >&3
  sed '1,/^\r$/d' <&3
  exec 3<&-
}

case_ops_and_trace() {
  start_server --ops 0 --trace "$folder/trace.json" --summary "$folder/a.json"
  local ops
  ops="$(read_port server 'metrics and health on TCP port ')"
  expect_exit 0 wobble health "127.0.0.1:$ops"
  expect_line "$out" '^ok$'
  [ "$(get "$ops" /readyz)" = ready ] || fail "ready"
  expect_exit 0 wobble bots "127.0.0.1:$port" --script "$bin/scripts/wander.lua" --count 2 --for 3
  get "$ops" /metrics >"$folder/metrics"
  promtool check metrics <"$folder/metrics" >"$folder/promtool" 2>&1 || fail "what promtool accepts" "$folder/promtool"
  expect_line "$folder/metrics" '^wobble_client_joins_total 2$'
  expect_line "$folder/metrics" '^wobble_tick_phase_seconds_count{phase="encode"} [1-9]'
  expect_refusal "^wobbled: --ops 127.0.0.1:$ops (TCP): cannot be listened on" wobbled --port 0 --ops "$ops"
  expect_refusal '^wobbled: --ops .nowhere.: must be HOST:PORT or PORT' wobbled --port 0 --ops nowhere
  expect_refusal '^wobbled: --trace /nowhere/a.json: cannot be written' wobbled --port 0 --trace /nowhere/a.json
  AGONES_SDK_HTTP_PORT=no expect_refusal '^wobbled: AGONES_SDK_HTTP_PORT no: must be 1 to 65535$' wobbled --port 0
  kill -TERM "$server"
  expect_end server "$server" 0 10
  local ticks
  ticks="$(read_figure "$folder/a.json" ticks)"
  [ "$(grep -c '"name":"tick"' "$folder/trace.json")" -eq "$ticks" ] || fail "$ticks ticks" "$folder/trace.json"
  expect_line "$folder/trace.json" '^\]$'
  expect_exit 1 wobble health "127.0.0.1:$ops"
  expect_line "$err" '^wobble health: no answer from 127.0.0.1:'"$ops$"
  expect_refusal "^wobble health: 'nowhere' is no HOST:PORT" wobble health nowhere
}

# Over IPv6 as over IPv4; where the machine has no IPv6 there is nothing to try.
case_ipv6() {
  grep -q ' lo$' /proc/net/if_inet6 2>/dev/null || return 0
  start_server --bind ::1 --summary "$folder/a.json"
  expect_exit 0 wobble bots "[::1]:$port" --script wander.lua --count 2 --for 2 --threshold 'connected==2'
  make_page
  start gateway wobble gateway --server "[::1]:$port" --http 0 --page "$folder/page"
  wait_for_line gateway '^open http://localhost:[1-9]'
  kill -TERM "$pid"
  expect_end gateway "$pid" 0 5
  kill -INT "$server"
  expect_end server "$server" 0
  expect_figure "$folder/a.json" joins '== 2'
  expect_refusal "^wobble bots: server: '::1' is no HOST:PORT" wobble bots ::1 --script idle.lua
}

# One round of ten seconds without a winner.
case_match_ends() {
  sed 's/^round = .*/round = 10/' "$bin/scenes/sumo.toml" >"$folder/short.toml"
  start_server --scene "$folder/short.toml" --rounds 1
  start bots wobble bots "127.0.0.1:$port" --script "$bin/scripts/idle.lua" --count 2
  expect_end server "$server" 0 40
  expect_refusal '^wobbled: --rounds 3: scene arena has no game$' wobbled --port 0 --rounds 3
  expect_refusal '^wobbled: --after-match dance: must be end, restart or next$' wobbled --port 0 --after-match dance
  expect_refusal '^wobbled: --after-match restart: --rounds must say how many rounds make a match$' \
    wobbled --port 0 --after-match restart
}

# The match of case_match_ends and the next one, in one process; then a world that all have left.
case_begins_anew() {
  sed 's/^round = .*/round = 10/' "$bin/scenes/sumo.toml" >"$folder/short.toml"
  start server wobbled --port 0 --scene "$folder/short.toml" --rounds 1 --after-match restart --reset-when-empty
  server=$pid
  wait_for_line server '^listening on UDP port [1-9]'
  port="$(read_port server 'listening on UDP port ')"
  start bots wobble bots "127.0.0.1:$port" --script "$bin/scripts/idle.lua" --count 2 --for 22
  expect_end bots "$pid" 0 40
  expect_line "$folder/bots.out" ' 0 disconnects'
  expect_line "$folder/server.err" 'tick [1-9][0-9]*: the world begins anew$'
  kill -INT "$server"
  expect_end server "$server" 0 10
  [ "$(grep -c 'the world begins anew$' "$folder/server.err")" = 2 ] ||
    fail 'begun anew at the end of the match, and when all had left' "$folder/server.err"
}

# Bots stay in while their server goes from scene to scene, by a match's end and by orders; each scene's recording plays
# the same again; and the state names its scene.
case_rotation() {
  local socket="$folder/admin.sock" file count=0
  local -a served=(--log-level info --port 0 --untrained --rotation "$folder/short.toml,pair,curtain" --rounds 1
    --admin-socket "$socket" --state "$folder/world" --record "$folder/matches")
  sed 's/^round = .*/round = 10/' "$bin/scenes/sumo.toml" >"$folder/short.toml"
  expect_exit 2 wobbled --port 0 --rotation nowhere,pair,pair,nothing.toml
  expect_line "$err" 'nowhere'
  expect_line "$err" '^wobbled: --rotation pair: a scene of this name is in it already$'
  expect_line "$err" 'nothing.toml'
  expect_lines "$err" 3
  expect_refusal '^wobbled: --rotation pair: must be two scenes or more$' wobbled --port 0 --rotation pair
  expect_refusal '^wobbled: --rounds 1: no scene of the rotation has a game$' wobbled --port 0 --rotation pair,curtain --rounds 1
  expect_refusal '^wobbled: --after-match next: --rotation must say which scenes follow$' wobbled --port 0 --after-match next
  start server wobbled "${served[@]}"
  server=$pid
  wait_for_line server '^listening on UDP port [1-9][0-9]*, scene short of short, pair, curtain$'
  port="$(read_port server 'listening on UDP port ')"
  start bots wobble bots "127.0.0.1:$port" --script "$bin/scripts/wander.lua" --count 4 --decode-share 1/2 --for 24 \
    --threshold 'disconnects==0' --threshold 'connected==4'
  local bots=$pid
  pid=$server wait_for_log server 'scene pair begins$'
  pid=$server wait_for_log server 'client 4 .* came along$'
  expect_exit 0 wobble admin --socket "$socket" next
  pid=$server wait_for_log server 'scene curtain begins$'
  expect_exit 1 wobble admin --socket "$socket" scene arena
  expect_line "$err" 'scene arena: must be one of short, pair, curtain'
  expect_end bots "$bots" 0 40
  expect_line "$folder/bots.out" ' 0 disconnects, 0 script errors'
  [ "$(grep -c 'came along$' "$folder/server.err")" = 8 ] || fail 'four bots come along twice' "$folder/server.err"
  kill -KILL "$server"
  wait "$server" 2>/dev/null
  for file in "$folder"/matches/*.wobrec; do
    expect_exit 0 wobbled --replay "$file" --verify
    expect_line "$out" '^identical: [1-9]'
    count=$((count + 1))
  done
  [ "$count" = 3 ] || fail 'a recording for each scene'
  start server wobbled "${served[@]}"
  server=$pid
  wait_for_line server '^listening on UDP port [1-9][0-9]*, scene curtain of short, pair, curtain$'
  kill -INT "$server"
  expect_end server "$server" 0 10
}

# A recording as people take it out: what cannot be done is said with the option, and the recording is never touched.
case_exports() {
  local match="$folder/match.wobrec" to="$folder/table.csv"
  expect_exit 0 wobbled --port 0 --untrained --scene pair --pause-after 0 --record "$folder/matches" --for 2
  mv "$folder"/matches/*.wobrec "$match"
  cp "$match" "$folder/copy"
  expect_refusal '^wobbled: .*match.wobrec is a recording or a state of wobble: must be another file$' \
    wobble export "$match" --output "$match"
  cmp "$match" "$folder/copy" || fail 'a recording that is as it was'
  expect_refusal '^wobbled: --from nan: must be 0 to 1000000, ' wobble export "$match" --output "$to" --from nan
  expect_refusal '^wobbled: --to 99: must be 0 to [0-9.]*, ' wobble export "$match" --output "$to" --to 99
  expect_refusal '^wobbled: --fps 0: must be 0.001 to 480$' wobble export "$match" --output "$to" --fps 0
  expect_refusal '^wobbled: --bodies -1: must be numbers of bodies' wobble export "$match" --output "$to" --bodies=-1
  expect_refusal '^wobbled: --bodies 99: there is no such body in these frames, which have 1,2,' \
    wobble export "$match" --output "$to" --bodies 99
  expect_refusal '^wobbled: none.wobrec does not exist$' wobble export none.wobrec --output "$to"
  expect_refusal "^wobble watch: '$folder' is a folder: " wobble watch "$folder"
  expect_refusal '^wobbled: --verify excludes --export' wobbled --replay "$match" --verify --export "$to"
  expect_refusal '^wobbled: --record-size requires --record' wobbled --port 0 --for 0.01 --untrained --record-size 3
  [ ! -e "$to" ] || fail 'no table' "$to"
  expect_exit 0 wobble export "$match" --output "$to" --to 0
  expect_line "$out" '^1 frames of 8 bodies, up to 0.00 s'
  expect_refusal '^wobbled: .*table.csv is there already: must be new, or --force given$' wobble export "$match" --output "$to"
  expect_exit 0 wobble export "$match" --output "$to" --force --to 0
  head -c -25 "$folder/copy" >"$match" # without its end
  expect_exit 0 wobble export "$match" --output "$folder/unended.csv"
  expect_line "$err" 'match.wobrec: the recording has no end: what wrote it was broken off$'
  head -c -60 "$folder/copy" >"$match"
  expect_exit 1 wobble export "$match" --output "$folder/damaged.csv"
  expect_line "$err" 'match.wobrec: exported up to its damage: byte [1-9]'
  expect_exit 0 wobble export "$match" --output "$folder/good.csv" --to 0.5
  (
    trap '' XFSZ
    ulimit -f 8 # KiB of a file
    expect_exit 1 wobble export "$folder/copy" --format gltf --output "$folder/large.glb"
    expect_line "$err" 'large.glb: cannot be written: File too large$'
  ) || exit 1
  [ -z "$(find "$folder" -name '*.partial')" ] || fail 'nothing that is written in part' <(ls "$folder")
}

# A state is not for a second server, and not for the server of another world.
case_state_is_one_worlds() {
  start_server --untrained --scene pair --state "$folder/world"
  expect_refusal "^wobbled: --state $folder/world: in use by another server, process $server\$" \
    wobbled --port 0 --untrained --scene pair --state "$folder/world"
  kill -INT "$server"
  expect_end server "$server" 0 10
  expect_refusal "^wobbled: --state .* holds a world of pair, 60 ticks a second, seed 1; this is arena, 60 ticks a second, seed 1: empty the folder or name another\$" \
    wobbled --port 0 --untrained --scene arena --state "$folder/world"
  expect_exit 0 wobbled --port 0 --untrained --rotation arena,pair --state "$folder/world" --for 0.1
}

# A disk that is full from the first blocks on, as a limit of the process, and folders that go: the log says why, no tick
# waits, the server goes on, and what was written before is good.
case_failing_disk() {
  (
    trap '' XFSZ
    ulimit -f 8 # KiB of a file
    exec "$bin/wobbled" --log-level warn --port 0 --untrained --scene arena --record "$folder/full" \
      --state "$folder/full" --summary "$folder/a.json" >"$folder/server.out" 2>"$folder/server.err"
  ) &
  pid=$! server=$!
  wait_for_line server '^listening on UDP port [1-9]'
  port="$(read_port server 'listening on UDP port ')"
  expect_exit 0 wobble bots "127.0.0.1:$port" --script "$bin/scripts/wander.lua" --count 4 --for 4 \
    --threshold 'disconnects==0' --threshold 'connected==4'
  wait_for_log server '--record: .*File too large; tried again every 10 s'
  wait_for_log server '--state: .*File too large; tried again every second'
  kill -INT "$server"
  expect_end server "$server" 0 10
  expect_figure "$folder/a.json" recording_failures '>= 1'
  expect_line "$folder/server.err" '--record: [1-9][0-9.]* s of what was played are not recorded: File too large$'
  # States that had room are whole: the next start complains of none.
  expect_exit 0 wobbled --log-level warn --port 0 --untrained --scene arena --state "$folder/full" --for 0.1
  [ ! -s "$err" ] || fail 'no state that is cut short' "$err"
  start server wobbled --log-level warn --port 0 --untrained --scene pair --record "$folder/gone" --state "$folder/gone" \
    --summary "$folder/a.json"
  server=$pid
  wait_for_line server '^listening on UDP port [1-9]'
  port="$(read_port server 'listening on UDP port ')"
  rm -r "$folder/gone"
  expect_exit 0 wobble bots "127.0.0.1:$port" --script idle.lua --count 2 --for 2 --threshold 'disconnects==0'
  wait_for_log server '--state: .*No such file or directory; tried again every second'
  mkdir "$folder/gone"
  local tries
  for ((tries = 0; tries < 100; ++tries)); do
    find "$folder/gone" -name '*.wobstate' | grep -q . && break
    sleep 0.05
  done
  [ "$tries" -lt 100 ] || fail 'the state again once the folder is back' "$folder/server.err"
  kill -INT "$server"
  expect_end server "$server" 0 10
  expect_refusal '^wobbled: --state /dev/null: must be a folder that can be written$' wobbled --port 0 --untrained --state /dev/null
  expect_refusal '^wobbled: --record /dev/null: must be a folder that can be written$' wobbled --port 0 --untrained --record /dev/null
}

# restart_server SIGNAL: ends the server, waits 1.2 s, starts it again on its port, and expects 8 players within 5 s.
restart_server() {
  local begin ops tries
  kill "-$1" "$server"
  wait "$server" 2>/dev/null
  sleep 1.2
  begin="$(date +%s%N)"
  start server wobbled --log-level warn --scene pair --untrained --port "$port" --ops 0 --summary "$folder/a.json"
  server=$pid
  wait_for_line server '^listening on UDP port '
  ops="$(read_port server 'metrics and health on TCP port ')"
  for ((tries = 0; tries < 400; ++tries)); do
    get "$ops" /metrics | grep -q '^wobble_client_joins_total 8$' && break
    sleep 0.05
  done
  awk "BEGIN { exit !($(date +%s%N) - $begin < 5e9) }" || fail '8 players within 5 s' "$folder/bots.out" "$folder/bots.err"
  echo "8 players $((($(date +%s%N) - begin) / 1000000)) ms after the start that followed $1"
}

# Killed or ended in order, and started again with the same key: everybody is back. They were lost all the same.
case_players_return() {
  start_server --scene pair --untrained
  start bots wobble bots "127.0.0.1:$port" --script idle.lua --count 8 --status 0.1 --summary "$folder/b.json" \
    --threshold 'disconnects==0'
  local bots=$pid
  wait_for_line bots '^bots 8/8'
  restart_server KILL
  restart_server TERM
  kill -INT "$bots"
  expect_end bots "$bots" 99
  expect_line "$folder/bots.err" '^wobble bots: bot [1-8] was cut off and joins again: the server was restarted'
  expect_line "$folder/bots.out" '^8 of 8 bots connected (24 joins), 8 disconnects, 16 rejoins, 0 script errors'
  expect_figure "$folder/b.json" disconnects '== 8'
  expect_figure "$folder/b.json" rejoins '== 16'
  expect_figure "$folder/b.json" rejoin_ms_p99 '< 6200' # from the end, 1.2 s before the start
  kill -INT "$server"
  expect_end server "$server" 0
  expect_figure "$folder/a.json" joins '== 8'
  expect_figure "$folder/a.json" disconnects '== 0'
}

# Bots whose server has gone for good say so and end; on Ctrl-C at once.
case_players_give_up() {
  start_server --scene pair --untrained
  start bots wobble bots "127.0.0.1:$port" --script idle.lua --count 2 --status 0.1 --rejoin 2s
  local bots=$pid patient
  start patient wobble bots "127.0.0.1:$port" --script idle.lua --count 1 --status 0.1
  patient=$pid
  wait_for_line patient '^bots 1/1'
  pid=$bots
  wait_for_line bots '^bots 2/2'
  kill -TERM "$server"
  expect_end server "$server" 0
  expect_end bots "$bots" 1 8
  expect_line "$folder/bots.err" '^wobble bots: bot 1 ended: server is closing; gave up joining again after 2 s'
  expect_line "$folder/bots.err" "^wobble bots: the server at 127.0.0.1:$port was lost, and no bot is back: server is closing"
  expect_line "$folder/bots.out" '^2 of 2 bots connected, 2 disconnects, 0 script errors'
  kill -0 "$patient" 2>/dev/null || fail 'a bot that still tries' "$folder/patient.out" "$folder/patient.err"
  kill -INT "$patient"
  expect_end patient "$patient" 1 1
}

# The example's own ball rolls in a circle: several positions, no two equal.
case_example() {
  start lost example 127.0.0.1 9 # waits long for an answer, while the other example plays
  local lost=$pid
  start_server
  expect_exit 0 example 127.0.0.1 "$port"
  [ "$(grep -c '^x *-\{0,1\}[0-9.]*  y *-\{0,1\}[0-9.]*  z *-\{0,1\}[0-9.]*$' "$out")" -ge 8 ] || fail 'eight places' "$out"
  [ "$(awk '{ print $2, $4 }' "$out" | sort -u | wc -l)" -ge 8 ] || fail 'places that change' "$out"
  kill -INT "$server"
  expect_end server "$server" 0
  expect_end lost "$lost" 1
  expect_line "$folder/lost.err" '^example: 127.0.0.1:9: no answer from the server$'
  expect_exit 1 example no.such.host.invalid
  expect_line "$err" '^example: no address is known for "no.such.host.invalid"$'
}

declare -F "case_$case_name" >/dev/null || {
  echo "unknown case '$case_name'; one of: $(declare -F | sed -n 's/^declare -f case_//p' | paste -sd' ')"
  exit 1
}
"case_$case_name"
echo "$case_name holds"
