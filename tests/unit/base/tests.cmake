# The functions of the number types in a small module per instruction set, for lanes_test.cpp.
foreach(isa ${FACETA_ISAS})
  set(target test_lanes_${isa})
  add_library(${target} MODULE ${CMAKE_CURRENT_LIST_DIR}/lanes_module/lane_module.cpp)
  target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR}/src ${CMAKE_CURRENT_LIST_DIR})
  target_compile_options(${target} PRIVATE ${FACETA_FLAGS_${isa}} -fvisibility=hidden
    -fvisibility-inlines-hidden -Wno-missing-field-initializers)
  target_link_options(${target} PRIVATE -Wl,--version-script=${FACETA_MODULE_SCRIPT})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME lanes_${isa}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests/lanes)
  add_dependencies(test_base ${target})
endforeach()
target_include_directories(test_base PRIVATE ${CMAKE_CURRENT_LIST_DIR})
target_compile_definitions(test_base PRIVATE FACETA_LANE_MODULES="${CMAKE_BINARY_DIR}/tests/lanes")
