# Cases of programs_test.sh. Who may come in and who may rule: the server's key, the password, orders, and players who return.

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
