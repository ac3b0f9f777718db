# Sourced by the scripts of this folder whose cases are tests, `bash SCRIPT CASE BIN_DIR`: the two words, a folder for what
# the case writes, which the script removes, and `fail`. Exit code 0: the case holds; 1: it fails, and the expected and the
# actual result are printed.
set -uo pipefail

readonly case_name="${1:?usage: ${0##*/} CASE BIN_DIR}"
bin="$(cd "${2:?usage: ${0##*/} CASE BIN_DIR}" && pwd)" || exit 1
folder="$(mktemp -d)" || exit 1
readonly bin folder
export XDG_STATE_HOME="$folder/state" # where the server keeps its key
unset STATE_DIRECTORY

# fail EXPECTED FILE...: ends the case and prints the actual result.
fail() {
  echo "FAILED $case_name: expected $1; came:"
  shift
  for file in "$@"; do sed "s|^|  ${file##*/}: |" "$file"; done
  exit 1
}
