# Per-instruction-set modules: every material of a list is compiled once per set into a shared module
# of its own (<name>_scalar.so, <name>_v3.so, <name>_v4.so) that exports one C symbol. They are loaded
# at run time after asking the CPU. Linking several sets into one binary would let the linker merge
# inline functions across them, and old CPUs would meet instructions they do not have.
#
#   faceta_add_material_modules(<name> [NAMESPACE <ns>] MATERIALS <header>:<Struct>...
#                               [EXTRA <source>...] [LIBS <target>...]
#                               [OUTPUT_DIRECTORY <folder>])
#
# makes the static library faceta_<name>_models with `std::vector<faceta::Model> <name>_models()` in
# namespace <ns> (double reference, derivatives, descriptors) and the modules in lib/faceta/. With an
# OUTPUT_DIRECTORY they go there instead and are not installed: a program adds them by
# Registry::global().add(<name>_models(), folder, "<name>"). Installed, this file serves those who
# find_package(faceta), too; it then wants Highway and Ceres, whose headers kernels and derivatives
# include.

set(FACETA_ISAS scalar v3 v4)
set(FACETA_FLAGS_scalar -DFACETA_LANE_WIDTH=1)
set(FACETA_FLAGS_v3 -march=x86-64-v3 -maes -mpclmul -DFACETA_LANE_WIDTH=8)
set(FACETA_FLAGS_v4 -march=x86-64-v4 -maes -mpclmul -DFACETA_LANE_WIDTH=16)
if(FACETA_FUZZ)
  # Kernels see no untrusted input, and clang has no sanitizers to link a module with.
  set(FACETA_MODULE_OPTIMISATION -fno-sanitize=all -O1)
elseif(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  # GCC 12 unrolls the loops over channels and coefficients at -O3 only.
  set(FACETA_MODULE_OPTIMISATION $<$<CONFIG:Release,RelWithDebInfo>:-O3>)
endif()
set(FACETA_MODULE_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/module.map)
# This tree; find_package(faceta) has named the installed headers and library instead.
if(NOT FACETA_INCLUDE_FOLDER)
  set(FACETA_INCLUDE_FOLDER ${CMAKE_SOURCE_DIR}/src)
  set(FACETA_MODULE_LIBRARY faceta_bsdf)
endif()

# Writes a file only if its content changed, so that nothing rebuilds for nothing.
function(faceta_write path content)
  file(GENERATE OUTPUT ${path} CONTENT "${content}")
endfunction()

function(faceta_add_material_modules name)
  cmake_parse_arguments(M "" "NAMESPACE;OUTPUT_DIRECTORY" "MATERIALS;EXTRA;LIBS" ${ARGN})
  if(NOT M_NAMESPACE)
    set(M_NAMESPACE faceta)
  endif()
  set(folder ${CMAKE_BINARY_DIR}/lib/faceta)
  if(M_OUTPUT_DIRECTORY)
    set(folder ${M_OUTPUT_DIRECTORY})
  endif()
  # A folder that no program's file is called like: a list may bear the name of one made here.
  set(dir ${CMAKE_CURRENT_BINARY_DIR}/${name}.modules)
  set(models "")
  set(kernels "")
  set(declare_models "")
  set(declare_kernels "")
  set(call_models "")
  set(call_kernels "")
  set(count 0)
  foreach(entry ${M_MATERIALS})
    string(REGEX MATCH "^(.*):([A-Za-z0-9_]+)$" ok "${entry}")
    set(header ${CMAKE_MATCH_1})
    set(struct ${CMAKE_MATCH_2})
    faceta_write(${dir}/${struct}_model.cpp
      "#include \"${header}\"\n#include \"bsdf/reference.h\"\nFACETA_MATERIAL_REFERENCE(${struct}, ${M_NAMESPACE}::${struct})\n")
    faceta_write(${dir}/${struct}_kernel.cpp
      "#include \"${header}\"\n#include \"bsdf/kernel_impl.h\"\nFACETA_MATERIAL_KERNEL(${struct}, ${M_NAMESPACE}::${struct})\n")
    list(APPEND models ${dir}/${struct}_model.cpp)
    list(APPEND kernels ${dir}/${struct}_kernel.cpp)
    string(APPEND declare_models "faceta::Model faceta_model_${struct}();\n")
    string(APPEND declare_kernels "const faceta::MaterialKernel* faceta_kernel_${struct}();\n")
    string(APPEND call_models "faceta_model_${struct}(), ")
    string(APPEND call_kernels "faceta_kernel_${struct}(), ")
    math(EXPR count "${count} + 1")
  endforeach()
  faceta_write(${dir}/models.cpp
    "#include \"bsdf/registry.h\"\n${declare_models}namespace ${M_NAMESPACE} {\nstd::vector<faceta::Model> ${name}_models() { return {${call_models}}; }\n}\n")
  set(render "nullptr")
  if(M_EXTRA)
    set(render "faceta_render_kernels()")
    string(APPEND declare_kernels "const faceta::RenderKernels* faceta_render_kernels();\n")
  endif()
  faceta_write(${dir}/table.cpp
    "#include \"bsdf/kernel.h\"\n${declare_kernels}extern \"C\" __attribute__((visibility(\"default\"))) const faceta::ModuleTable* faceta_module_table() {\n  static const faceta::MaterialKernel* const kernels[] = {${call_kernels}};\n  static const faceta::ModuleTable table{faceta::kModuleAbi, FACETA_LANE_WIDTH, FACETA_ISA_NAME, ${count}, kernels, ${render}};\n  return &table;\n}\n")

  find_package(Ceres REQUIRED) # its targets are seen in this folder only
  add_library(faceta_${name}_models STATIC ${models} ${dir}/models.cpp)
  target_include_directories(faceta_${name}_models PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(faceta_${name}_models PUBLIC ${FACETA_MODULE_LIBRARY} Ceres::ceres)
  target_compile_features(faceta_${name}_models PUBLIC cxx_std_20)
  target_compile_options(faceta_${name}_models PRIVATE ${FACETA_MODULE_FLAGS})
  foreach(isa ${FACETA_ISAS})
    set(target faceta_${name}_${isa})
    add_library(${target} MODULE ${kernels} ${dir}/table.cpp ${M_EXTRA})
    target_include_directories(${target} PRIVATE ${FACETA_INCLUDE_FOLDER} ${CMAKE_CURRENT_SOURCE_DIR})
    target_compile_features(${target} PRIVATE cxx_std_20)
    target_compile_options(${target} PRIVATE ${FACETA_MODULE_FLAGS} ${FACETA_FLAGS_${isa}} -DFACETA_ISA_NAME="${isa}"
      -fvisibility=hidden -fvisibility-inlines-hidden -Wno-missing-field-initializers
      ${FACETA_MODULE_OPTIMISATION})
    target_link_options(${target} PRIVATE -Wl,--version-script=${FACETA_MODULE_SCRIPT} -Wl,--no-undefined)
    target_link_libraries(${target} PRIVATE ${M_LIBS})
    set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${name}_${isa}
      LIBRARY_OUTPUT_DIRECTORY ${folder})
    if(NOT M_OUTPUT_DIRECTORY)
      set_property(GLOBAL APPEND PROPERTY FACETA_MODULE_TARGETS ${target})
    endif()
    add_dependencies(faceta_${name}_models ${target})
  endforeach()
endfunction()
