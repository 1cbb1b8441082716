# `cmake --install`: the shared library, the program, the modules, the headers, the scenes, and what
# find_package(faceta) needs. Laid out as in the build tree, so that both find their parts the same
# way: the modules in faceta/ beside the library, the scenes in ../share/faceta/scenes from it.
#
# Include it at the end of the top CMakeLists. It reads the targets faceta_library (libfaceta.so)
# and faceta_cli (faceta), and the global property FACETA_MODULE_TARGETS.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY FACETA_MODULE_TARGETS)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/faceta)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/faceta)

# Headers include each other as "room/file.h"; a user may write that or <faceta/room/file.h>.
target_include_directories(faceta_library INTERFACE
  $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
  $<INSTALL_INTERFACE:${headers}>)
target_compile_features(faceta_library INTERFACE cxx_std_20)
string(REGEX MATCH "^[0-9]+\\.[0-9]+" soversion ${PROJECT_VERSION})
set_target_properties(faceta_library PROPERTIES
  OUTPUT_NAME faceta
  EXPORT_NAME faceta
  VERSION ${PROJECT_VERSION}
  SOVERSION ${soversion})
add_library(faceta::faceta ALIAS faceta_library)

file(RELATIVE_PATH to_library ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set_target_properties(faceta_cli PROPERTIES
  OUTPUT_NAME faceta
  INSTALL_RPATH "$ORIGIN/${to_library}")

install(TARGETS faceta_library EXPORT faceta_targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS faceta_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(modules)
  install(TARGETS ${modules} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/faceta)
endif()
install(DIRECTORY ${CMAKE_SOURCE_DIR}/src/ DESTINATION ${headers}
  FILES_MATCHING PATTERN "*.h" PATTERN "*.inc" PATTERN "cli" EXCLUDE PATTERN "server" EXCLUDE)
if(EXISTS ${CMAKE_SOURCE_DIR}/scenes)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/faceta)
endif()

install(EXPORT faceta_targets NAMESPACE faceta:: DESTINATION ${package})
set(FACETA_HEADERS ${headers})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/faceta-config.cmake.in
  ${CMAKE_BINARY_DIR}/faceta-config.cmake INSTALL_DESTINATION ${package}
  PATH_VARS FACETA_HEADERS)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/faceta-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/faceta-config.cmake
  ${CMAKE_BINARY_DIR}/faceta-config-version.cmake ${CMAKE_CURRENT_LIST_DIR}/Modules.cmake
  ${CMAKE_CURRENT_LIST_DIR}/module.map DESTINATION ${package})

# A project of somebody else's: installs this build to an empty prefix, then finds, builds and runs.
if(FACETA_TESTS)
  add_test(NAME install/consumer
    COMMAND ${CMAKE_COMMAND}
      -DBUILD=${CMAKE_BINARY_DIR} -DCONSUMER=${CMAKE_SOURCE_DIR}/tests/install
      -DGENERATOR=${CMAKE_GENERATOR} -DCOMPILER=${CMAKE_CXX_COMPILER}
      -DFLAGS=${CMAKE_CXX_FLAGS} -DLAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
      -DVERSION=${PROJECT_VERSION} -DBINDIR=${CMAKE_INSTALL_BINDIR}
      -P ${CMAKE_SOURCE_DIR}/tests/install/run.cmake)
  faceta_patience(seconds 300)
  set_tests_properties(install/consumer PROPERTIES TIMEOUT ${seconds})
endif()
