#!/bin/sh
# Builds the image `wobble`, also by the name of its version, with docker, or without a daemon with buildah.
#
#   sh docker/build_image.sh [OPTION...]   options are handed on, such as --no-cache
set -eu
cd "$(dirname "$0")/.."

version="$(sed -n 's/^project(wobble VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
revision="$(git rev-parse --short HEAD 2>/dev/null || echo unknown)"
set -- --file docker/Dockerfile --tag wobble --tag "wobble:$version" \
  --label "org.opencontainers.image.revision=$revision" "$@" .

if docker info >/dev/null 2>&1; then
  echo "Building wobble:$version with docker"
  # Before version 23 docker has to be asked for the builder that knows mounts.
  DOCKER_BUILDKIT=1 exec docker build "$@"
fi
if command -v buildah >/dev/null 2>&1; then
  echo "Building wobble:$version with buildah"
  # By chroot, which works within a container too. The OCI format has no place for a health check.
  exec buildah bud --isolation chroot --format docker --layers --ignorefile docker/Dockerfile.dockerignore "$@"
fi
echo "build_image.sh: no docker daemon answers and buildah is not there; start docker or apt-get install buildah" >&2
exit 1
