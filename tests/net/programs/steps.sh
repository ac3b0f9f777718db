# Sourced by programs_test.sh: what its cases are made of. They run programs, wait for lines, and compare what came.
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

# wait_in NAME.out|NAME.err PATTERN: waits until the program started under NAME has written the line there.
wait_in() {
  local tries name="${1%.*}"
  for ((tries = 0; tries < patience * 20; ++tries)); do
    grep -q -e "$2" "$folder/$1" && return
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.05
  done
  fail "a line '$2' from $name" "$folder/$name.out" "$folder/$name.err"
}

# wait_for_line NAME PATTERN, wait_for_log NAME PATTERN: a line of its output, of its standard error.
wait_for_line() { wait_in "$1.out" "$2"; }
wait_for_log() { wait_in "$1.err" "$2"; }

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

# make_page: makes a folder that the gateway accepts as the page.
make_page() { mkdir -p "$folder/page" && echo '<!doctype html><title>wobble</title>' >"$folder/page/index.html"; }

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

# get PORT PATH: prints the body of the answer of the endpoint on this machine.
get() {
  exec 3<>"/dev/tcp/127.0.0.1/$1" || fail "somebody on port $1"
  printf 'GET %s HTTP/1.0\r\n\r\n' "$2" >&3
  sed '1,/^\r$/d' <&3
  exec 3<&-
}
