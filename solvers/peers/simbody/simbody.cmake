lcpbench_peer_option(SIMBODY Simbody libsimbody-dev)
if(LCPBENCH_WITH_SIMBODY)
  # Its package file for CMake asks for its visualizer's libraries.
  find_path(SIMBODY_INCLUDE_DIR NAMES simbody/internal/ImpulseSolver.h PATH_SUFFIXES simbody)
  find_library(SIMBODY_LIBRARY NAMES SimTKsimbody)
  find_library(SIMBODY_COMMON_LIBRARY NAMES SimTKcommon)
  mark_as_advanced(SIMBODY_INCLUDE_DIR SIMBODY_LIBRARY SIMBODY_COMMON_LIBRARY)
  if(SIMBODY_INCLUDE_DIR AND SIMBODY_LIBRARY AND SIMBODY_COMMON_LIBRARY)
    # Its headers are ambiguous in C++20.
    add_library(lcpbench_simbody_code OBJECT simbody/impulse_code.cc)
    target_compile_features(lcpbench_simbody_code PRIVATE cxx_std_17)
    set_target_properties(lcpbench_simbody_code PROPERTIES CXX_STANDARD 17)
    target_include_directories(lcpbench_simbody_code PRIVATE "${PROJECT_SOURCE_DIR}")
    target_include_directories(lcpbench_simbody_code SYSTEM PRIVATE "${SIMBODY_INCLUDE_DIR}")
    target_link_libraries(lcpbench_simbody_code PRIVATE lcpbench_warnings)
    lcpbench_add_peer(simbody SOURCES simbody/simbody.cc ../linear_algebra/loaded_blas.cc
                      LIBRARIES lcpbench_simbody_code "${SIMBODY_LIBRARY}" "${SIMBODY_COMMON_LIBRARY}"
                                ${CMAKE_DL_LIBS})
  else()
    lcpbench_peer_missing(SIMBODY Simbody libsimbody-dev)
  endif()
endif()
