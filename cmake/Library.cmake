# The one shared library: the objects of every room. Programs link it and nothing else, so that there
# is one registry in a process, and so that the modules are found relative to one file.
get_property(archives GLOBAL PROPERTY faceta_archives)
list(APPEND archives faceta_builtin_models)
list(TRANSFORM archives REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
add_library(faceta_library SHARED ${objects})
# The archives bring the libraries that they use; the linker needs none of their own members.
target_link_libraries(faceta_library PRIVATE ${archives})
target_include_directories(faceta_library PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src>)
set_target_properties(faceta_library PROPERTIES OUTPUT_NAME faceta LINKER_LANGUAGE CXX)
