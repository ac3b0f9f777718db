#!/bin/sh
# Runs the command that Pterodactyl or Pelican gives in STARTUP, with its {{NAME}} replaced by the variables NAME. The
# first start leaves a worlds.toml in the server's folder, to be changed there.
#
# The command takes this shell's place, so that the panel's stop signal reaches it.
here="$(cd "$(dirname "$0")" && pwd)" || exit 1
cd "${HOME:?}" || exit 1
[ -e worlds.toml ] || cp "$here/worlds.toml" . || exit 1
command="$(printf '%s' "${STARTUP:?the panel gives the command in STARTUP}" | sed -e 's/{{\([A-Za-z0-9_]*\)}}/${\1}/g')"
printf '%s$ %s\n' "$HOME" "$STARTUP"
eval "exec $command"
