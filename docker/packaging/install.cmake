# cmake --install, by component; programs look for what they ship beside themselves, as in a build folder, and then in
# ../share/wobble:
#
#   server   wobbled, its scenes
#   client   wobble, its scripts, the page, the npm package; for C libwobble.so, wobble.h, find_package(libwobble) and
#            libwobble.pc
#   world    the physics for C: libwobble_world.so, wobble_world.h, find_package(libwobble_world), libwobble_world.pc, and
#            the scenes
#   python   the module wobble, its types, documents and examples, and the scenes, in lib/python3/dist-packages
#   dev      for C++ headers, static libraries, find_package(wobble) and wobble.pc
#
# The libraries carry no flag of ours: an embedding project compiles its own files as it likes. They themselves are
# compiled for x86-64-v3.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(data ${CMAKE_INSTALL_DATADIR}/wobble)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/wobble)
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/wobble)

# The protocol and the client library; `enet` is the transport that a player needs beside them.
set(libraries wobble_protocol wobble_enet wobble_client)
if(WOBBLE_BUILD_SERVER)
  list(APPEND libraries wobble_physics)
  install(TARGETS wobbled RUNTIME COMPONENT server)
  function(install_scenes component folder)
    install(DIRECTORY server/scenes/ DESTINATION ${folder} COMPONENT ${component}
      FILES_MATCHING PATTERN "*.toml" PATTERN "*.obj" PATTERN examples EXCLUDE)
  endfunction()
  install_scenes(server ${data}/scenes)
  install(DIRECTORY server/physics DESTINATION ${headers}/server COMPONENT dev FILES_MATCHING PATTERN "*.h")
endif()
# What the Debian packages have in another component (deb.cmake): programs, and what belongs to a library for C. The
# export of a library may be filled only once, so the library itself is installed where these are called.
function(install_programs component)
  install(TARGETS wobble RUNTIME COMPONENT ${component} ${ARGN})
  install(DIRECTORY client/bots/scripts DESTINATION ${data} COMPONENT ${component} ${ARGN}
    FILES_MATCHING PATTERN "*.lua")
  install(FILES client/host/worlds.toml DESTINATION ${data} COMPONENT ${component} ${ARGN})
  if(TARGET page)
    install(DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/page DESTINATION ${data} COMPONENT ${component} ${ARGN})
  endif()
endfunction()
function(install_c name header component)
  set(config ${CMAKE_INSTALL_LIBDIR}/cmake/${name})
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component} ${ARGN})
  install(EXPORT ${name} NAMESPACE ${name}:: FILE ${name}Config.cmake DESTINATION ${config}
    COMPONENT ${component} ${ARGN})
  install(FILES ${PROJECT_BINARY_DIR}/wobbleConfigVersion.cmake DESTINATION ${config}
    RENAME ${name}ConfigVersion.cmake COMPONENT ${component} ${ARGN})
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
    COMPONENT ${component} ${ARGN})
endfunction()
if(WOBBLE_BUILD_TOOLS)
  install_programs(client)
endif()
if(TARGET npm_package)
  # Target `programs` alone does not pack it.
  install(FILES ${PROJECT_BINARY_DIR}/npm/wobble-client-${PROJECT_VERSION}.tgz DESTINATION ${data}
    COMPONENT client OPTIONAL)
endif()
set_target_properties(wobble_c PROPERTIES EXPORT_NAME libwobble)
install(TARGETS wobble_c EXPORT libwobble LIBRARY COMPONENT client INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install_c(libwobble client/wobble.h client)
if(TARGET wobble_world)
  set_target_properties(wobble_world PROPERTIES EXPORT_NAME libwobble_world)
  install(TARGETS wobble_world EXPORT libwobble_world LIBRARY COMPONENT world
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install_c(libwobble_world server/library/wobble_world.h world)
  install_scenes(world ${data}/scenes)
endif()
if(TARGET wobble_python)
  set(module lib/python3/dist-packages/wobble)
  install(TARGETS wobble_python LIBRARY DESTINATION ${module} COMPONENT python)
  install(FILES server/library/python/__init__.py server/library/python/__init__.pyi server/library/python/py.typed
    server/library/python/README.md DESTINATION ${module} COMPONENT python)
  install(DIRECTORY server/library/python/examples DESTINATION ${module} COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN __pycache__ EXCLUDE)
  install_scenes(python ${module}/scenes)
endif()
if(TARGET wobble_lab)
  install(TARGETS wobble_lab wobble_terms RUNTIME COMPONENT lab)
endif()

set_target_properties(wobble_protocol PROPERTIES EXPORT_NAME protocol)
set_target_properties(wobble_enet PROPERTIES EXPORT_NAME enet)
set_target_properties(wobble_client PROPERTIES EXPORT_NAME client)
if(TARGET wobble_physics)
  set_target_properties(wobble_physics PROPERTIES EXPORT_NAME physics)
endif()
foreach(library IN LISTS libraries)
  string(REPLACE wobble_ "wobble::" alias ${library})
  add_library(${alias} ALIAS ${library})
endforeach()
install(TARGETS ${libraries} EXPORT wobble ARCHIVE COMPONENT dev INCLUDES DESTINATION ${headers})
install(EXPORT wobble NAMESPACE wobble:: DESTINATION ${config} COMPONENT dev)
install(DIRECTORY protocol DESTINATION ${headers} COMPONENT dev FILES_MATCHING PATTERN "*.h" PATTERN usage EXCLUDE)
install(DIRECTORY ${PROJECT_BINARY_DIR}/generated/protocol DESTINATION ${headers} COMPONENT dev
  FILES_MATCHING PATTERN "*.h")
file(GLOB clientHeaders CONFIGURE_DEPENDS client/*.h)
list(FILTER clientHeaders EXCLUDE REGEX "/wobble\\.h$")
install(FILES ${clientHeaders} DESTINATION ${headers}/client COMPONENT dev)
install(FILES client/files/kept_folder.h DESTINATION ${headers}/client/files COMPONENT dev)

configure_package_config_file(docker/packaging/wobbleConfig.cmake.in ${PROJECT_BINARY_DIR}/wobbleConfig.cmake
  INSTALL_DESTINATION ${config})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/wobbleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/wobbleConfig.cmake ${PROJECT_BINARY_DIR}/wobbleConfigVersion.cmake
  DESTINATION ${config} COMPONENT dev)
# From the folder of the file back to the prefix: an installed copy can be moved.
file(RELATIVE_PATH pcToPrefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
foreach(name wobble libwobble libwobble_world)
  configure_file(docker/packaging/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/wobble.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
