# Cases of programs_test.sh. `wobble host`: the worlds of one file.

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
