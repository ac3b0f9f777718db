#!/usr/bin/env bash
# The programs as users run them: real processes, real sockets, exit codes and printed lines.
#
#   bash programs_test.sh CASE BIN_DIR
#
# The system picks the ports, so that cases run side by side. Cases wait for events and not for a number of seconds,
# because sanitizer builds take several times as long.
. "${0%/*}/case.sh"
# The cases, by subject, and the steps that they are made of.
for part in "${0%/*}"/programs/*.sh; do . "$part"; done

declare -F "case_$case_name" >/dev/null || {
  echo "unknown case '$case_name'; one of: $(declare -F | sed -n 's/^declare -f case_//p' | paste -sd' ')"
  exit 1
}
"case_$case_name"
echo "$case_name holds"
