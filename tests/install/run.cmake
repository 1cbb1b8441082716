# Installs BUILD into an empty prefix, builds the project CONSUMER against it, and runs both its
# program and the installed one.
set(work ${BUILD}/install-test)
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${work})

function(run output)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT code EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${command}: exit code ${code}\n${text}")
  endif()
  set(${output} "${text}" PARENT_SCOPE)
endfunction()

function(expect text wanted)
  string(FIND "${text}" "${wanted}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "expected '${wanted}' in:\n${text}")
  endif()
endfunction()

run(text ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run(text ${CMAKE_COMMAND} -S ${CONSUMER} -B ${work}/build -G ${GENERATOR}
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
  -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DFACETA_VERSION=${VERSION})
run(text ${CMAKE_COMMAND} --build ${work}/build)

run(text ${work}/build/consumer)
# Lambert: value = reflectance / pi * 0.8, pdf = 0.8 / pi.
foreach(way double lanes)
  expect("${text}" "${way}: 0.06366 0.12732 0.25465, pdf 0.25465")
endforeach()
# A grain of albedo 0.5: 0.5 * 0.8 / (4 pi (0.8 + 1)).
run(cpu ${prefix}/${BINDIR}/faceta info --cpu)
foreach(way double scalar v3 v4)
  string(REGEX MATCH "instruction sets[^\n]* ${way} " supported "${cpu}")
  if(supported OR way MATCHES "double|scalar")
    expect("${text}" "dust ${way}: 0.01768, pdf 0.25465")
  endif()
endforeach()
expect("${text}" "error: unknown material 'difuse' (did you mean 'diffuse'?")
run(text ${prefix}/${BINDIR}/faceta --version)
expect("${text}" "${VERSION}")
