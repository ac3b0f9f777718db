# Cases of programs_test.sh. What a wrong call is told, and help.

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
  expect_refusal "scene file '$folder/none.toml' cannot be read: there is no such file$" wobbled --port 0 --scene "$folder/none.toml"
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
