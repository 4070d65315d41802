lcpbench_peer_option(DART DART libdart-dev)
if(LCPBENCH_WITH_DART)
  # Its package file would ask for all that DART itself was built with; the LCP solvers need none of it to compile.
  find_path(DART_INCLUDE_DIR NAMES dart/constraint/PgsBoxedLcpSolver.hpp)
  find_library(DART_LIBRARY NAMES dart)
  mark_as_advanced(DART_INCLUDE_DIR DART_LIBRARY)
  if(DART_INCLUDE_DIR AND DART_LIBRARY)
    # Objects with Eigen members pass between this worker and libdart, and both define the same inline functions of
    # Eigen: the whole worker is compiled with Eigen's own alignment, as libdart was, and not with lcpbench::lcp's.
    file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/solvers/lcp/*.cc" "${PROJECT_SOURCE_DIR}/support/*.cc")
    add_library(lcpbench_dart_runtime STATIC
      ${lcpbench_peer_runtime_sources} protocol/protocol.cc protocol/worker.cc ${sources})
    target_include_directories(lcpbench_dart_runtime PUBLIC "${PROJECT_SOURCE_DIR}")
    target_compile_features(lcpbench_dart_runtime PUBLIC cxx_std_20)
    target_link_libraries(lcpbench_dart_runtime PUBLIC Eigen3::Eigen PRIVATE lcpbench_warnings lcpbench_reproducible
                          Boost::headers nlohmann_json::nlohmann_json)
    lcpbench_add_peer(dart SOURCES dart/dart.cc dantzig_peer.cc LIBRARIES "${DART_LIBRARY}" RUNTIME lcpbench_dart_runtime)
    target_include_directories(lcpbench_worker_dart SYSTEM PRIVATE "${DART_INCLUDE_DIR}")
    # libdart was built with assertions, and one virtual function of its classes exists only then.
    target_compile_options(lcpbench_worker_dart PRIVATE -UNDEBUG)
  else()
    lcpbench_peer_missing(DART DART libdart-dev)
  endif()
endif()
