# The one shared library: every room's archive, whole.
get_property(archives GLOBAL PROPERTY faceta_archives)
list(APPEND archives faceta_builtin_models)
file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/library_anchor.cpp CONTENT "")
add_library(faceta_library SHARED ${CMAKE_BINARY_DIR}/library_anchor.cpp)
target_link_libraries(faceta_library PRIVATE
  "$<LINK_LIBRARY:WHOLE_ARCHIVE,${archives}>")
target_include_directories(faceta_library PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src>)
set_target_properties(faceta_library PROPERTIES OUTPUT_NAME faceta)
