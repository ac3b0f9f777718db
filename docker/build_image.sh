#!/bin/sh
# Builds the image `wobble`, also tagged with its version, with docker, or with buildah where no daemon runs.
#
#   sh docker/build_image.sh [OPTION...]   options are passed on, such as --no-cache
set -eu
cd "$(dirname "$0")/.."

version="$(sed -n 's/^project(wobble VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
revision="$(git rev-parse --short HEAD 2>/dev/null || echo unknown)"
set -- --file docker/Dockerfile --tag wobble --tag "wobble:$version" \
  --label "org.opencontainers.image.revision=$revision" "$@" .

if docker info >/dev/null 2>&1; then
  echo "Building wobble:$version with docker"
  # Docker before version 23 uses a builder without mounts unless BuildKit is asked for.
  DOCKER_BUILDKIT=1 exec docker build "$@"
fi
if command -v buildah >/dev/null 2>&1; then
  echo "Building wobble:$version with buildah"
  # Isolation by chroot works inside a container too. The OCI format has no health check, the docker format has.
  exec buildah bud --isolation chroot --format docker --layers --ignorefile docker/Dockerfile.dockerignore "$@"
fi
echo "build_image.sh: no docker daemon answers and buildah is not there; start docker or apt-get install buildah" >&2
exit 1
