#!/usr/bin/env bash
# The assumptions of the container image that can be tested without building one.
#
#   bash image_test.sh CASE BIN_DIR
. "${0%/*}/case.sh"
trap 'rm -rf "$folder"' EXIT
docker="$(cd "$(dirname "$0")/../../docker" && pwd)" || exit 1
readonly docker

# list_packages PROGRAM...: Debian's packages of the libraries that the programs name themselves; indirect libraries
# come with the packages. dpkg is asked once for all, since it reads its whole list for every question.
list_packages() {
  local program name path
  for program in "$@"; do
    ldd "$program" >"$folder/loaded"
    readelf -d "$program" | sed -n 's/.*(NEEDED).*\[\(.*\)\]$/\1/p' | while read -r name; do
      case "$name" in ld-linux*) continue ;; esac # the loader, which ldd shows without a path; it is libc6's
      path="$(awk -v name="$name" '$1 == name { print $3 }' "$folder/loaded")"
      echo "$name $path"
    done
  done | sort -u >"$folder/libraries"
  # The loader finds in /lib the files that packages have in /usr/lib.
  awk '{ print $2; print "/usr" $2 }' "$folder/libraries" | xargs dpkg-query -S 2>/dev/null >"$folder/owners"
  while read -r name path; do
    sed -n "s|^\([^:]*\):.* \(/usr\)\{0,1\}$path$|\1|p" "$folder/owners" | grep . ||
      echo "no package has $name, which is '$path'"
  done <"$folder/libraries"
}

# The list must be exact, so that a new library is not forgotten and an old one not kept.
case_runtime_packages() {
  sh "$docker/packages.sh" --list runtime | sort >"$folder/listed"
  list_packages "$bin/wobbled" "$bin/wobble" | sort -u >"$folder/linked"
  grep -q '^libc6$' "$folder/linked" || fail "programs that are linked to libc6" "$folder/linked"
  diff "$folder/listed" "$folder/linked" >"$folder/difference" ||
    fail "group runtime of packages.sh ('<') to be what the programs are linked to ('>')" "$folder/difference"
}

# start_scene LOG: starts the scene once, with the cache that the environment names.
start_scene() {
  WOBBLE_UNTRAINED='' WOBBLE_CACHE="$folder/bases" \
    "$bin/wobbled" --scene sumo --for 0.001 --port 0 2>"$folder/$1" || fail "a server that ends well" "$folder/$1"
}

# The image has the bases of shipped scenes where nothing can be written. (Root can write there; other users cannot.)
case_bases_need_no_writing() {
  start_scene trained
  grep -q 'trained, ' "$folder/trained" || fail "a basis to be trained" "$folder/trained"
  chmod a-w "$folder/bases"
  start_scene read
  chmod u+w "$folder/bases"
  grep -q 'read from ' "$folder/read" || fail "a basis to be read" "$folder/read"
  if grep -q -e training -e warn "$folder/read"; then fail "nothing to be trained again" "$folder/read"; fi
}

# fake PROGRAM BODY: puts a script on the PATH of build_image.sh, which contains little else.
fake() {
  printf '#!/bin/sh\n%s\n' "$2" >"$folder/path/$1"
  chmod +x "$folder/path/$1"
}

# build CODE: expects this exit code of build_image.sh.
build() {
  local code sh
  sh="$(command -v sh)"
  PATH="$folder/path" "$sh" "$docker/build_image.sh" --no-cache >"$folder/build" 2>&1
  code=$?
  [ "$code" -eq "$1" ] || fail "exit code $1 of build_image.sh, not $code" "$folder/build"
}

expect_line() { grep -q -e "$1" "$folder/build" || fail "a line '$1'" "$folder/build"; }

# shellcheck disable=SC2016  # the fakes expand the variables
case_builds_with_what_is_there() {
  local program
  mkdir "$folder/path"
  for program in dirname sed; do ln -s "$(command -v "$program")" "$folder/path/$program"; done
  build 1
  expect_line '^build_image.sh: .*apt-get install buildah$'
  fake buildah 'echo buildah "$@"'
  fake docker '[ "$1" = info ] && exit 1; exit 7' # no daemon runs
  build 0
  expect_line '^buildah bud --isolation chroot --format docker .* --file docker/Dockerfile .*--no-cache \.$'
  fake docker '[ "$1" = info ] && exit 0; echo docker "$@"'
  build 0
  expect_line '^docker build --file docker/Dockerfile .*--no-cache \.$'
}

declare -F "case_$case_name" >/dev/null || {
  echo "unknown case '$case_name'; one of: $(declare -F | sed -n 's/^declare -f case_//p' | paste -sd' ')"
  exit 1
}
"case_$case_name"
echo "$case_name holds"
