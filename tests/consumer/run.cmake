# Installs BUILD_DIR into a fresh prefix, builds the consumer projects against it, one in C++ and one in C, and runs them;
# then the one in C without CMake.
file(REMOVE_RECURSE "${WORK_DIR}")

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGV}\n${output}")
  endif()
endfunction()

set(options -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix" -DCMAKE_BUILD_TYPE=Release)
run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${WORK_DIR}/prefix")
run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${WORK_DIR}/build" ${options} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}")
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
run("${WORK_DIR}/build/consumer")

run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}/c" -B "${WORK_DIR}/build_c" ${options} "-DCMAKE_C_FLAGS=${CXX_FLAGS}")
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build_c")
run("${WORK_DIR}/build_c/consumer_c")

file(GLOB_RECURSE package "${WORK_DIR}/prefix/*/lcpbench.pc")
get_filename_component(package_dir "${package}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${package_dir}")
set(ENV{LD_LIBRARY_PATH} "${package_dir}/..")
run(sh -c "cc '${SOURCE_DIR}/c/main.c' ${CXX_FLAGS} -o '${WORK_DIR}/plain' $(pkg-config --cflags --libs lcpbench)")
run("${WORK_DIR}/plain")
