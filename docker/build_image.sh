#!/bin/sh
# Builds the image `wobble` with docker, or without a daemon with buildah, whichever is there.
#
#   sh docker/build_image.sh [OPTION...]   options are handed on, such as --no-cache
set -eu
cd "$(dirname "$0")/.."

name="${WOBBLE_IMAGE:-wobble}"
revision="$(git rev-parse --short HEAD 2>/dev/null || echo unknown)"
set -- --file docker/Dockerfile --tag "$name" --label "org.opencontainers.image.revision=$revision" "$@" .

if docker info >/dev/null 2>&1; then
  echo "Building $name with docker"
  # Before version 23 docker has to be asked for the builder that knows mounts.
  DOCKER_BUILDKIT=1 exec docker build "$@"
fi
if command -v buildah >/dev/null 2>&1; then
  echo "Building $name with buildah"
  # By chroot, which works within a container too. The OCI format has no place for a health check.
  exec buildah bud --isolation chroot --format docker --layers --ignorefile docker/Dockerfile.dockerignore "$@"
fi
echo "build_image.sh: no docker daemon answers and buildah is not there; start docker or apt-get install buildah" >&2
exit 1
