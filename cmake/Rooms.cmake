# A room is one folder of src/: a static library faceta_<name> of its *.cpp that may use the rooms
# named after USES, and a test program test_<name> of tests/unit/<name>/*.cpp that links exactly
# this room and those below it, so that an arrow pointing up the house fails to link.
#
#   faceta_room(<name> [USES <room>...] [LIBS <target>...])
function(faceta_room name)
  cmake_parse_arguments(ROOM "" "" "USES;LIBS" ${ARGN})
  list(TRANSFORM ROOM_USES PREPEND faceta_)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/${name}/*.cpp)
  if(sources)
    add_library(faceta_${name} STATIC ${sources})
    set(scope PUBLIC)
    set_property(GLOBAL APPEND PROPERTY faceta_archives faceta_${name})
  else()
    add_library(faceta_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(faceta_${name} ${scope} $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src>)
  target_link_libraries(faceta_${name} ${scope} ${ROOM_USES} ${ROOM_LIBS})
  set_property(GLOBAL APPEND PROPERTY faceta_rooms ${name})
endfunction()

# Seconds that a test may take; sanitizers make programs slow.
function(faceta_patience variable seconds)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    math(EXPR seconds "10 * ${seconds}")
  endif()
  set(${variable} ${seconds} PARENT_SCOPE)
endfunction()

# The unit tests of a room: tests/unit/<name>/*.cpp, data files beside them.
function(faceta_room_tests name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/unit/${name}/*.cpp)
  if(sources)
    add_executable(test_${name} ${sources})
    target_link_libraries(test_${name} PRIVATE faceta_${name} Ceres::ceres GTest::gtest
      GTest::gtest_main)
    target_compile_definitions(test_${name} PRIVATE
      FACETA_TEST_DATA="${CMAKE_SOURCE_DIR}/tests/unit/${name}"
      FACETA_SHARED_DATA="${CMAKE_SOURCE_DIR}/../shared/data")
    # What the tests of a room need beside their sources.
    include(${CMAKE_SOURCE_DIR}/tests/unit/${name}/tests.cmake OPTIONAL)
    faceta_patience(discovery 60)
    faceta_patience(seconds 900)
    gtest_discover_tests(test_${name} TEST_PREFIX "${name}/" DISCOVERY_TIMEOUT ${discovery}
      PROPERTIES TIMEOUT ${seconds})
  endif()
endfunction()
