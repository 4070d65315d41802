# Installs BUILD_DIR into a fresh prefix, builds the consumer projects against it, one in C++ and one in C, and runs
# them; then the one in C without CMake. To them belong the classes that the installed command prints, and the programs
# of docs/embedding.md.
file(REMOVE_RECURSE "${WORK_DIR}")

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGV}\n${output}${errors}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# What the command prints where SOLVER is the one to choose, as a header.
function(write_printed solver name)
  run("${WORK_DIR}/prefix/bin/lcpbench" recommend --scene disc-pile --size 20 --rounds 1 --json --candidates ${solver})
  string(JSON code GET "${output}" cpp)
  file(WRITE "${made}/${name}.h" "${code}")
endfunction()

# A program of the documentation, and what it must print.
function(expect program text)
  run("${program}")
  if(NOT output STREQUAL "${text}\n")
    message(FATAL_ERROR "${program} printed '${output}', expected '${text}'")
  endif()
endfunction()

set(made "${WORK_DIR}/made")
set(options -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix" "-DMADE_DIR=${made}" -DCMAKE_BUILD_TYPE=Release)
run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${WORK_DIR}/prefix")
run(/usr/bin/python3 "${SOURCE_DIR}/examples.py" "${SOURCE_DIR}/../../docs/embedding.md" "${made}")
write_printed(dantzig printed_solver)
write_printed(auto printed_step)
file(STRINGS "${made}/printed_step.h" is_of_steps REGEX "lcpbench::StepSolver")
if(NOT is_of_steps)
  message(FATAL_ERROR "the command prints no StepSolver for small problems")
endif()

run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${WORK_DIR}/build" ${options} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}")
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
run("${WORK_DIR}/build/consumer")
run("${WORK_DIR}/build/printed_solver")
run("${WORK_DIR}/build/printed_step")
expect("${WORK_DIR}/build/step" "solved: 19.62 N and 9.81 N")

run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}/c" -B "${WORK_DIR}/build_c" ${options} "-DCMAKE_C_FLAGS=${CXX_FLAGS}")
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build_c")
run("${WORK_DIR}/build_c/main_c")
expect("${WORK_DIR}/build_c/step_c" "solved: 19.62 N and 9.81 N")

file(GLOB_RECURSE package "${WORK_DIR}/prefix/*/lcpbench.pc")
get_filename_component(package_dir "${package}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${package_dir}")
set(ENV{LD_LIBRARY_PATH} "${package_dir}/..")
run(sh -c "cc '${SOURCE_DIR}/c/main.c' ${CXX_FLAGS} -o '${WORK_DIR}/plain' $(pkg-config --cflags --libs lcpbench)")
run("${WORK_DIR}/plain")
