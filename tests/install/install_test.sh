#!/usr/bin/env bash
# An installed copy as outside projects meet it.
#
#   bash install_test.sh CASE BUILD_DIR
#
#   client    a project with find_package(wobble) and one with pkg-config build client/example.cpp and play
#   c         the same in C, with find_package(libwobble) and pkg-config: client/example.c plays for C_SECONDS (2) in an
#             SDL2 window without a screen, and its picture shows the world
#   engines   client/engines: what Unity uses plays in Mono; all of it compiles against stand-ins of what it names of the
#             engines, which Debian does not have
#   world     the same with the physics for C: server/library/example.c steps a scene
#   interface of the two libraries for C is the one that their .abi files describe, is all that they export, and compiles
#             as C and C++
#   physics   a project builds a headless example of the engine and drops a ball
#   embed     a project adds this tree as a subdirectory with the client alone
#   packages  three .deb files, installed and run in a fresh Debian (root, mmdebstrap and the network are needed; else the
#             case is skipped with exit code 77)
readonly case_name="${1:?usage: install_test.sh CASE BUILD_DIR}"
. "${0%/*}/place.sh"
export CMAKE_BUILD_PARALLEL_LEVEL=1  # other tests run beside this one and wait for answers
build="$(cd "${2:?usage: install_test.sh CASE BUILD_DIR}" && pwd)"
readonly build

# Not optimised, since what is tested is that it builds and plays. The compiler's launcher, as everywhere: the second run
# of a test need not compile again.
configure() { cmake -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" \
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "$@" >"$folder/log" 2>&1 || { cat "$folder/log"; fail "cmake"; }; }
compile() { cmake --build "$1" >"$folder/log" 2>&1 || { cat "$folder/log"; fail "the build of $1"; }; }
install_dev() {
  cmake --install "$build" --prefix "$folder/prefix" --component dev >/dev/null
  # The copy must do without the tree: nothing in it names a place of this machine.
  if grep -rlF "$source" "$folder/prefix" --include='*.cmake' --include='*.pc' --include='*.h'; then
    fail "the installed files above name the source tree"
  fi
}

# No flag of ours in what an outside project compiles with.
expect_no_flags() {
  grep -q main "$1/compile_commands.json" || grep -q cpp "$1/compile_commands.json" || fail "commands in $1"
  if grep -E -e '-(march|Werror|Wshadow|ffp-contract|fno-math-errno)' "$1/compile_commands.json"; then
    fail "no flag of wobble's own in the commands above"
  fi
}

install_client() { cmake --install "$build" --prefix "$folder/prefix" --component client >/dev/null; }

start_ball_drop() { start_server "$build/bin/wobbled" --scene ball_drop --for 90; }
# play LINES PROGRAM ARGUMENT...: the examples print where their body is, twice a second.
play() {
  local lines="$1"
  shift
  timeout 60 "$@" >"$folder/played" || fail "$1 to play"
  [ "$(grep -c '^x ' "$folder/played")" -ge "$lines" ] || { cat "$folder/played"; fail "places of the body"; }
}

# check_interface LIBRARY HEADER MACRO: that an installed library for C exports what its header declares, that this
# compiles as C and as C++, and that the binary interface is the stored one.
check_interface() {
  local library="$folder/prefix/lib/$1.so" header
  header="$(basename "$2")"
  [ "$(readelf -d "$library" | sed -n 's/.*soname: \[\(.*\)\]/\1/p')" = "$1.so.0" ] || fail "the name $1.so.0"
  nm -D --defined-only "$library" | cut -d ' ' -f 3 | sort >"$folder/exported"
  sed -n "s/^$3 .*[ *]\(wobble_[a-z_]*\)(.*/\1/p" "$folder/prefix/include/$header" | sort >"$folder/declared"
  diff "$folder/declared" "$folder/exported" || fail "what $header declares ('<') to be what is exported ('>')"
  echo "#include <$header>" >"$folder/header.c"
  for compiler in "cc -std=c11" "c++ -x c++ -std=c++11"; do
    $compiler -pedantic -Wall -Wextra -Werror -fsyntax-only -I"$folder/prefix/include" "$folder/header.c" || fail "$compiler"
  done
  # Another compiler describes the same types in other words.
  grep -q 'COMPILER_ID "GNU"' "$build"/CMakeFiles/*/CMakeCXXCompiler.cmake && command -v abidw >/dev/null ||
    { echo "skipped: gcc and abidw"; exit 77; }
  abidw --headers-dir "$folder/prefix/include" --drop-private-types --exported-interfaces-only --no-corpus-path \
    --no-comp-dir-path --no-show-locs --no-elf-needed --type-id-style hash "$library" >"$folder/$1.abi" || fail "abidw"
  [ -z "${NEW_ABI:-}" ] || cp "$folder/$1.abi" "$NEW_ABI"
  abidiff "$source/tests/install/$1.abi" "$folder/$1.abi" ||
    fail "the interface that $1.abi describes; if it is to be another, NEW_ABI=FOLDER leaves there what it is now"
}

# compile_with_stand_in STAND_IN SOURCE HEADER...: the headers of an engine, each of which is the stand-in.
compile_with_stand_in() {
  local stand_in="$source/tests/install/engines/$1" file="$source/client/engines/$2" header
  shift 2
  for header in "$@"; do
    mkdir -p "$(dirname "$folder/engine/$header")"
    echo "#include \"$stand_in\"" >"$folder/engine/$header"
  done
  c++ -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I"$folder/engine" -I"$folder/prefix/include" "$file" ||
    fail "$file to compile"
}

case "$case_name" in
  client)
    install_dev
    configure -S "$source/tests/install/client" -B "$folder/game" -DCMAKE_PREFIX_PATH="$folder/prefix" \
      -DEXAMPLE="$source/client/example.cpp"
    compile "$folder/game"
    expect_no_flags "$folder/game"
    start_ball_drop
    play 5 "$folder/game/game" 127.0.0.1 "$port"
    # shellcheck disable=SC2046  # the flags are words
    c++ -std=c++20 "$source/client/example.cpp" -o "$folder/by_pkg_config" \
      $(PKG_CONFIG_PATH="$folder/prefix/lib/pkgconfig" pkg-config --cflags --libs wobble) || fail "a build by pkg-config"
    [ "$(PKG_CONFIG_PATH="$folder/prefix/lib/pkgconfig" pkg-config --modversion wobble)" = \
      "$("$build/bin/wobble" --version | cut -d ' ' -f 2)" ] || fail "one version"
    ;;
  c)
    pkg-config --exists sdl2 || { echo "skipped: SDL2"; exit 77; }
    install_client
    export PKG_CONFIG_PATH="$folder/prefix/lib/pkgconfig" LD_LIBRARY_PATH="$folder/prefix/lib"
    configure -S "$source/tests/install/c" -B "$folder/game" -DCMAKE_PREFIX_PATH="$folder/prefix" \
      -DEXAMPLE="$source/client/example.c"
    compile "$folder/game"
    # shellcheck disable=SC2046  # the flags are words
    cc -std=c11 -pedantic -Wall -Wextra -Werror "$source/client/example.c" -o "$folder/by_pkg_config" \
      $(pkg-config --cflags --libs libwobble sdl2) -lm || fail "a build by pkg-config"
    [ "$(pkg-config --modversion libwobble)" = "$("$build/bin/wobble" --version | cut -d ' ' -f 2)" ] || fail "one version"
    start_ball_drop
    export SDL_VIDEODRIVER=dummy SDL_RENDER_DRIVER=software
    seconds="${C_SECONDS:-2}"
    play $((2 * seconds - 2)) "$folder/by_pkg_config" "127.0.0.1:$port" "$seconds"
    [ "$(sort -u "$folder/played" | wc -l)" -ge 2 ] || { cat "$folder/played"; fail "a body that moves"; }
    mkdir "$folder/pictures"
    cd "$folder/pictures" # SDL writes every picture here
    SDL_VIDEO_DUMMY_SAVE_FRAMES=1 play 1 "$folder/game/game" "127.0.0.1:$port" 1
    python3 "$source/tests/install/c/find_bodies.py" ./*.bmp || fail "a picture with the own body in orange, others in blue"
    if "$folder/game/game" nowhere 2>"$folder/told"; then fail "an exit code"; fi
    grep -q '^example: the address is no HOST:PORT' "$folder/told" || { cat "$folder/told"; fail "a reason"; }
    ;;
  engines)
    command -v mcs >/dev/null && command -v mono >/dev/null || { echo "skipped: mono"; exit 77; }
    install_client
    cd "$source/client/engines/unity"
    stand_ins="$source/tests/install/engines"
    mcs -warnaserror -out:"$folder/headless.exe" WobbleNative.cs WobblePlayer.cs "$stand_ins/headless.cs" || fail "mcs"
    # 0649, 0414: fields of the stand-in that nobody sets
    mcs -warnaserror -nowarn:0649,0414 -target:library -out:"$folder/unity.dll" ./*.cs "$stand_ins/UnityEngine.cs" ||
      fail "WobbleWorld.cs to compile"
    start_ball_drop
    export LD_LIBRARY_PATH="$folder/prefix/lib"
    play 3 mono "$folder/headless.exe" "127.0.0.1:$port" 2
    [ "$(grep -c ' ball162 162$' "$folder/played")" -ge 3 ] || { cat "$folder/played"; fail "a body that is where its pose says"; }
    [ "$(sort -u "$folder/played" | wc -l)" -ge 2 ] || { cat "$folder/played"; fail "a body that moves"; }
    if mono "$folder/headless.exe" nowhere 1 2>"$folder/told"; then fail "an exit code"; fi
    grep -q 'the address is no HOST:PORT' "$folder/told" || { cat "$folder/told"; fail "a reason"; }
    # shellcheck disable=SC2046  # the names of headers are words
    compile_with_stand_in godot_cpp.h gdextension/wobble_world.cpp \
      $(sed -n 's/^#include <\(godot_cpp.*\)>/\1/p' ../gdextension/*.h ../gdextension/*.cpp)
    # shellcheck disable=SC2046
    compile_with_stand_in unreal.h unreal/WobbleWorld.cpp \
      $(sed -n 's/^#include "\(.*\)"/\1/p' ../unreal/*.h ../unreal/*.cpp | grep -vx -e WobbleWorld.h -e wobble.h)
    ;;
  interface)
    install_client
    cmake --install "$build" --prefix "$folder/prefix" --component world >/dev/null
    check_interface libwobble client/wobble.h WOBBLE_API
    check_interface libwobble_world server/library/wobble_world.h WOBBLE_WORLD_API
    ;;
  world)
    cmake --install "$build" --prefix "$folder/prefix" --component world >/dev/null
    export PKG_CONFIG_PATH="$folder/prefix/lib/pkgconfig" LD_LIBRARY_PATH="$folder/prefix/lib"
    configure -S "$source/tests/install/world" -B "$folder/study" -DCMAKE_PREFIX_PATH="$folder/prefix" \
      -DEXAMPLE="$source/server/library/example.c"
    compile "$folder/study"
    # shellcheck disable=SC2046  # the flags are words
    cc -std=c11 -pedantic -Wall -Wextra -Werror "$source/server/library/example.c" -o "$folder/by_pkg_config" \
      $(pkg-config --cflags --libs libwobble_world) || fail "a build by pkg-config"
    "$folder/study/study" ball_drop 2 >"$folder/stepped" || fail "the example"
    [ "$(grep -c '^ [0-2].0 s  4 bodies, ball12 at [0-9.]* m, kinetic' "$folder/stepped")" -eq 3 ] ||
      { cat "$folder/stepped"; fail "three seconds of four bodies"; }
    "$folder/by_pkg_config" ball_drop 2 | cmp - "$folder/stepped" || fail "the same bits again"
    if "$folder/study/study" nowhere 2>"$folder/told"; then fail "an exit code"; fi
    grep -q "^study: scene 'nowhere' is not known" "$folder/told" || { cat "$folder/told"; fail "a reason"; }
    ;;
  physics)
    install_dev
    configure -S "$source/tests/install/physics" -B "$folder/study" -DCMAKE_PREFIX_PATH="$folder/prefix"
    compile "$folder/study"
    expect_no_flags "$folder/study"
    "$folder/study/study" >"$folder/fallen"
    grep -qE '^t 0.00 s  z +3.000 m$' "$folder/fallen" || { cat "$folder/fallen"; fail "a ball that begins at 3 m"; }
    [ "$(wc -l <"$folder/fallen")" -eq 7 ] || { cat "$folder/fallen"; fail "seven lines"; }
    awk '$5 < 0.2 || $5 > 3.001 { exit 1 }' "$folder/fallen" || { cat "$folder/fallen"; fail "a ball above the ground"; }
    ;;
  embed)
    mkdir "$folder/embedding"
    cat >"$folder/embedding/CMakeLists.txt" <<EOF
cmake_minimum_required(VERSION 3.25)
project(embedding LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
add_subdirectory($source wobble)
add_executable(game $source/client/example.cpp)
target_link_libraries(game PRIVATE wobble::client wobble::enet)
if(Eigen3_FOUND OR TBB_FOUND OR spdlog_FOUND OR CLI11_FOUND OR Boost_FOUND OR LUA_FOUND)
  message(FATAL_ERROR "The client asked for packages that it does not need")
endif()
EOF
    configure -S "$folder/embedding" -B "$folder/embedded" -DWOBBLE_BY_ROOM=ON
    cmake --build "$folder/embedded" --target game >"$folder/log" 2>&1 || { cat "$folder/log"; fail "the build"; }
    start_ball_drop
    play 5 "$folder/embedded/game" 127.0.0.1 "$port"
    ;;
  packages)
    [ "$(id -u)" -eq 0 ] && command -v mmdebstrap >/dev/null || { echo "skipped: root and mmdebstrap"; exit 77; }
    (cd "$build" && cpack -G DEB -B "$folder/packages" >"$folder/log" 2>&1) || { cat "$folder/log"; fail "cpack"; }
    for package in wobble-server libwobble-dev wobble-lab; do
      ls "$folder/packages/$package"_*.deb >/dev/null || fail "$package"
      dpkg-deb --info "$folder/packages/$package"_*.deb >"$folder/info"
      grep -q "^ Version: $("$build/bin/wobble" --version | cut -d ' ' -f 2)$" "$folder/info" || fail "the version of $package"
    done
    includes=()
    for file in "$folder"/packages/*.deb; do includes+=("--include=$file"); done
    mmdebstrap --variant=apt --hook-dir=/usr/share/mmdebstrap/hooks/file-mirror-automount "${includes[@]}" \
      bookworm "$folder/root" >"$folder/log" 2>&1 || { tail -20 "$folder/log"; fail "a fresh Debian with the packages"; }
    mount -t proc proc "$folder/root/proc"  # the programs look for themselves there
    inside() { chroot "$folder/root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp "$@"; }
    case "$(inside getent passwd wobble)" in *nologin) ;; *) fail "the user wobble" ;; esac
    for file in include/wobble.h lib/libwobble.so lib/pkgconfig/libwobble.pc lib/cmake/libwobble/libwobbleConfig.cmake; do
      [ -e "$folder/root/usr/$file" ] || fail "$file"
    done
    if inside ldd /usr/lib/libwobble.so.0 | grep 'not found'; then fail "the libraries that libwobble.so needs"; fi
    inside wobbled --list-scenes >"$folder/scenes"
    grep -q '^arena ' "$folder/scenes" || fail "shipped scenes"
    [ -f "$folder/root/usr/share/wobble/page/index.html" ] || fail "the page"
    inside wobble host /etc/wobble/worlds.toml --check || fail "worlds.toml"
    inside grep -q '^WOBBLED_OPTIONS=--scene arena' /etc/wobble/wobbled.conf || fail "the service's options"
    for unit in wobbled wobble-gateway wobble-host; do
      [ -f "$folder/root/lib/systemd/system/$unit.service" ] || [ -f "$folder/root/usr/lib/systemd/system/$unit.service" ] ||
        fail "the unit $unit"
    done
    inside setpriv --reuid wobble --regid wobble --clear-groups \
      wobble play --for 6 --http 0 >"$folder/played" 2>&1 || { cat "$folder/played"; fail "wobble play as the user wobble"; }
    grep -q 'all went well' "$folder/played" || { cat "$folder/played"; fail "a play that went well"; }
    if compgen -G "$folder/packages/python3-wobble_*.deb" >/dev/null; then
      inside python3 -c 'import wobble; w = wobble.World("arena"); w.step(); print(w.bodies[0].positions.shape)' ||
        fail "the module for Python"
    fi
    [ "$(inside wobble_lab --version)" = "wobble_lab $("$build/bin/wobble" --version | cut -d ' ' -f 2)" ] || fail "the laboratory"
    # The world is enabled, and started where systemd runs, here a stand-in that notes what it is asked.
    [ -L "$folder/root/etc/systemd/system/multi-user.target.wants/wobbled.service" ] || fail "an enabled world"
    mkdir -p "$folder/root/run/systemd/system"
    cat >"$folder/root/usr/bin/systemctl" <<'EOF'
#!/bin/sh
echo "$@" >>/tmp/asked
case "$*" in *is-enabled*wobbled*) echo enabled ;; *is-enabled*) echo disabled ;; *is-active*) exit 3 ;; esac
EOF
    chmod 755 "$folder/root/usr/bin/systemctl"
    rm -f "$folder/root/usr/sbin/policy-rc.d"
    cp "$folder"/packages/wobble-server_*.deb "$folder/root/tmp/server.deb"
    inside dpkg -i /tmp/server.deb >"$folder/log" 2>&1 || { cat "$folder/log"; fail "the package installed again"; }
    grep -qx -- '--quiet --system restart wobbled.service' "$folder/root/tmp/asked" ||
      { cat "$folder/root/tmp/asked"; fail "a world that is started, and no gateway"; }
    # What the unit starts, as its user, with the shipped options but for ports, which may be in use here.
    options="$(sed -n 's/^WOBBLED_OPTIONS=//p' "$folder/root/etc/wobble/wobbled.conf" | sed 's/7777/0/;s/127.0.0.1:9100/0/')"
    # shellcheck disable=SC2086  # the options are words, as in the unit
    inside STATE_DIRECTORY=/tmp setpriv --reuid wobble --regid wobble --clear-groups \
      wobbled --cache /tmp/cache $options --for 1 >"$folder/world" 2>&1 || { cat "$folder/world"; fail "the unit's world"; }
    grep -q '^listening on UDP port' "$folder/world" || { cat "$folder/world"; fail "a world that listens"; }
    inside dpkg --force-depends --remove wobble-server >"$folder/log" 2>&1 || { cat "$folder/log"; fail "a removal"; }
    grep -q 'stop wobbled.service wobble-gateway.service' "$folder/root/tmp/asked" || fail "services that are stopped"
    mkdir -p "$folder/root/var/lib/wobble"
    inside dpkg --purge wobble-lab wobble-server >"$folder/log" 2>&1 || { cat "$folder/log"; fail "a purge"; }
    for left in etc/wobble var/lib/wobble etc/systemd/system/wobbled.service \
      etc/systemd/system/multi-user.target.wants/wobbled.service; do
      [ ! -e "$folder/root/$left" ] && [ ! -L "$folder/root/$left" ] || fail "/$left gone after a purge"
    done
    ;;
  *) fail "no such case" ;;
esac
echo "ok $case_name"
