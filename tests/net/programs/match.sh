# Cases of programs_test.sh. Matches: their end, the next one, and the next scene.

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
