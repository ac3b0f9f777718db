# cpack -G DEB, in the build folder: packages for Debian 12.
#
#   wobble-server   wobbled and wobble with scenes, scripts and the page; three systemd units, a user, /etc/wobble
#   libwobble-dev   headers and static libraries, find_package(wobble), wobble.pc; and for C libwobble.so and
#                   libwobble_world.so with their own; the latter's scenes are wobble-server's
#   wobble-lab      wobble_lab
#   python3-wobble  the module for Debian's Python, with the scenes
#
# The component `client` is in two packages, so that no file is in both of them.
#
# Dependencies on shared libraries are read from the programs by dpkg-shlibdeps. In a build for another machine it finds no
# installed libraries, so there they are all of packages.sh's group `runtime`.
if(NOT (WOBBLE_BUILD_SERVER AND WOBBLE_BUILD_TOOLS))
  return()
endif()
set(packaging ${PROJECT_SOURCE_DIR}/docker/packaging)
install(FILES ${packaging}/wobbled.service ${packaging}/wobble-gateway.service ${packaging}/wobble-host.service
  DESTINATION lib/systemd/system COMPONENT deb EXCLUDE_FROM_ALL)
install(FILES ${packaging}/wobbled.conf ${packaging}/gateway.conf ${PROJECT_SOURCE_DIR}/client/host/worlds.toml
  DESTINATION /etc/wobble COMPONENT deb EXCLUDE_FROM_ALL)
install_programs(deb_wobble_server EXCLUDE_FROM_ALL)
install_c(libwobble client/wobble.h deb_libwobble_dev EXCLUDE_FROM_ALL)
install_c(libwobble_world server/library/wobble_world.h deb_libwobble_dev EXCLUDE_FROM_ALL)
install(TARGETS wobble_c wobble_world LIBRARY COMPONENT deb_libwobble_dev EXCLUDE_FROM_ALL)
foreach(package wobble-server libwobble-dev wobble-lab python3-wobble)
  string(REPLACE - _ component deb_${package})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION share/doc/${package} RENAME copyright
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME wobble)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The wobble authors <wobble@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Soft bodies for many players")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_COMPONENTS_ALL server deb deb_wobble_server dev deb_libwobble_dev)

set(CPACK_DEBIAN_SERVER_PACKAGE_NAME wobble-server)
set(CPACK_DEBIAN_SERVER_PACKAGE_SECTION games)
set(CPACK_DEBIAN_SERVER_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS "init-system-helpers, passwd")
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA
  "${packaging}/conffiles;${packaging}/postinst;${packaging}/prerm;${packaging}/postrm")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libwobble-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libflatbuffers-dev, libenet-dev, libsodium-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "libeigen3-dev, libtbb-dev, wobble-server")
if(TARGET wobble_lab)
  list(APPEND CPACK_COMPONENTS_ALL lab deb_wobble_lab)
  set(CPACK_DEBIAN_LAB_PACKAGE_NAME wobble-lab)
  set(CPACK_DEBIAN_LAB_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_LAB_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_LAB_PACKAGE_DEPENDS "wobble-server (= ${PROJECT_VERSION})")
  set(CPACK_DEBIAN_LAB_PACKAGE_RECOMMENDS "gnuplot-nox, valgrind")
endif()
if(TARGET wobble_python)
  list(APPEND CPACK_COMPONENTS_ALL python deb_python3_wobble)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-wobble)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  math(EXPR next "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib")
endif()

if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  execute_process(COMMAND sh ${PROJECT_SOURCE_DIR}/docker/packages.sh --list runtime
    OUTPUT_VARIABLE runtime OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  string(REPLACE "\n" ", " runtime "${runtime}")
  foreach(package SERVER DEV)
    set(CPACK_DEBIAN_${package}_PACKAGE_SHLIBDEPS OFF)
    string(APPEND CPACK_DEBIAN_${package}_PACKAGE_DEPENDS ", ${runtime}")
  endforeach()
endif()

include(CPack)
cpack_add_component_group(server DESCRIPTION "Host a world of soft bodies for many players, connect to it, load-test it")
cpack_add_component_group(dev DESCRIPTION "Libraries and headers for programs that connect to a world of soft bodies")
cpack_add_component_group(python DESCRIPTION "Soft bodies for Python: simulate them, play recordings, play on servers")
cpack_add_component_group(lab DESCRIPTION "Accuracy, stability and speed of soft-body integrators, measured and plotted")
foreach(component server deb deb_wobble_server)
  cpack_add_component(${component} GROUP server)
endforeach()
foreach(component dev deb_libwobble_dev)
  cpack_add_component(${component} GROUP dev)
endforeach()
foreach(component lab deb_wobble_lab)
  cpack_add_component(${component} GROUP lab)
endforeach()
foreach(component python deb_python3_wobble)
  cpack_add_component(${component} GROUP python)
endforeach()
