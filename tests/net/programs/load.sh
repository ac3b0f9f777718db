# Cases of programs_test.sh. Bots, links and noise: players by script, over lines that lose.

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
