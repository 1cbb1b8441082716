# The kernels' sampling of lights in a small module per instruction set, for light_kernels.h.
foreach(isa ${FACETA_ISAS})
  set(target test_lights_${isa})
  add_library(${target} MODULE ${CMAKE_CURRENT_LIST_DIR}/light_module/light_module.cpp)
  target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR}/src)
  target_compile_options(${target} PRIVATE ${FACETA_FLAGS_${isa}} -fvisibility=hidden
    -fvisibility-inlines-hidden -Wno-missing-field-initializers)
  target_link_options(${target} PRIVATE -Wl,--version-script=${FACETA_MODULE_SCRIPT})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME lights_${isa}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests/lights)
  add_dependencies(test_render ${target})
endforeach()
# Rays of the tests' own, in double precision.
target_sources(test_render PRIVATE ${CMAKE_SOURCE_DIR}/tests/unit/scene/view_math.cpp)
target_include_directories(test_render PRIVATE ${CMAKE_CURRENT_LIST_DIR}
  ${CMAKE_SOURCE_DIR}/tests/unit/scene)
target_compile_definitions(test_render PRIVATE FACETA_LIGHT_MODULES="${CMAKE_BINARY_DIR}/tests/lights")
