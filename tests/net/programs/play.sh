# Cases of programs_test.sh. `wobble play`: server and gateway by one command.

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
