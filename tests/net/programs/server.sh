# Cases of programs_test.sh. What operators have of a server: metrics, traces, exported films, its state on a disk, IPv6.

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
