# Sourced by the scripts of this folder, after `case_name` is set: the source tree, a folder for what the script writes,
# which goes with all that the script has started, `fail`, and a server.
set -euo pipefail
source="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
folder="$(mktemp -d)"
readonly source folder
clean_up() {
  for running in $(jobs -pr); do kill "$running" 2>/dev/null || true; done
  wait
  if mountpoint -q "$folder/root/proc" 2>/dev/null; then umount "$folder/root/proc"; fi
  rm -rf "$folder"
}
trap clean_up EXIT
trap 'exit 1' HUP INT TERM
export XDG_STATE_HOME="$folder/state" # where the server keeps its key
unset STATE_DIRECTORY

fail() {
  echo "FAILED $case_name: $1"
  exit 1
}

# start_server COMMAND...: starts `wobbled` in this way, and sets `server` to its process and `port`.
start_server() {
  "$@" --port 0 >"$folder/server" 2>&1 &
  server=$!
  port=""
  for _ in $(seq 600); do
    port="$(sed -n 's/^listening on UDP port \([0-9]*\).*/\1/p' "$folder/server")"
    [ -n "$port" ] && return
    sleep 0.1
  done
  cat "$folder/server"
  fail "a server that listens"
}
