# Installs BUILD_DIR into a fresh prefix, builds the examples against it, those in C++ and those in C, and runs them;
# then one in C without CMake. The classes that the installed command prints are built and run with them.
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

# What an example must print.
function(expect program text)
  run("${program}")
  if(NOT output MATCHES "${text}")
    message(FATAL_ERROR "${program} printed '${output}', expected '${text}'")
  endif()
endfunction()

set(made "${WORK_DIR}/made")
set(options -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix" "-DMADE_DIR=${made}" -DCMAKE_BUILD_TYPE=Release
    "-DCMAKE_CXX_FLAGS_RELEASE=-O0 -DNDEBUG")  # what they call is optimised
run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${WORK_DIR}/prefix")
# A peer in Python uses the module beside the installed worker, not that of the source: it ends with the module.
file(GLOB_RECURSE module "${WORK_DIR}/prefix/*/lcpbench/python/peers.py")
file(GLOB_RECURSE worker "${WORK_DIR}/prefix/*/lcpbench-worker-quadprog")
if(module AND worker)
  set(solve sh -c "'${WORK_DIR}/prefix/bin/lcpbench' generate disc-pile --size 5 | '${WORK_DIR}/prefix/bin/lcpbench' solve --solver quadprog-dual -")
  run(${solve})
  if(NOT output MATCHES "\"status\":\"solved\"")
    message(FATAL_ERROR "an installed peer in Python does not solve:\n${output}")
  endif()
  file(RENAME "${module}" "${module}.away")
  execute_process(COMMAND ${solve} OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  file(RENAME "${module}.away" "${module}")
  if(output MATCHES "\"status\":\"solved\"" OR NOT "${output}${errors}" MATCHES "peers")
    message(FATAL_ERROR "an installed peer in Python does not use the module beside it:\n${output}${errors}")
  endif()
endif()
write_printed(dantzig printed_solver)
write_printed(auto printed_step)
file(STRINGS "${made}/printed_step.h" is_of_steps REGEX "lcpbench::StepSolver")
if(NOT is_of_steps)
  message(FATAL_ERROR "the command prints no StepSolver for small problems")
endif()

set(examples "${SOURCE_DIR}/../../examples")
run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${WORK_DIR}/build" ${options}
    "-DCMAKE_CXX_FLAGS=${CXX_FLAGS} -Wall -Wextra -Werror")
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
run("${WORK_DIR}/build/printed_solver")
run("${WORK_DIR}/build/printed_step")
set(two_forces "^solved: 19.62 N and 9.81 N\n$")
expect("${WORK_DIR}/build/examples/step" "${two_forces}")
expect("${WORK_DIR}/build/examples/curved_contact" "f = 31.62 N, expected 31.62 N")
expect("${WORK_DIR}/build/examples/engine_loop" "warm starts.*cold starts")
set(campaign "${WORK_DIR}/campaign")
run("${WORK_DIR}/prefix/bin/lcpbench" run --suite smoke --filter disc-pile --no-fills --tiers 1e-6 --launches 1
    --output "${campaign}" --external "mine=${WORK_DIR}/build/examples/own_solver" --solvers auto mine)
file(STRINGS "${campaign}/streams.jsonl" passed REGEX "\"mine\".*\"judge\".*\"best_tier\":.1e-0[69]")
if(NOT passed)
  message(FATAL_ERROR "the campaign has no pass of the example's solver")
endif()

run("${CMAKE_COMMAND}" -S "${examples}/c" -B "${WORK_DIR}/build_c" ${options} "-DCMAKE_C_FLAGS=${CXX_FLAGS}")
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build_c")
run("${WORK_DIR}/build_c/problem")
expect("${WORK_DIR}/build_c/step" "${two_forces}")

file(GLOB_RECURSE package "${WORK_DIR}/prefix/*/lcpbench.pc")
get_filename_component(package_dir "${package}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${package_dir}")
set(ENV{LD_LIBRARY_PATH} "${package_dir}/..")
run(sh -c "cc '${examples}/c/problem.c' ${CXX_FLAGS} -o '${WORK_DIR}/plain' $(pkg-config --cflags --libs lcpbench)")
run("${WORK_DIR}/plain")
