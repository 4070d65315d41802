# cmake --install, and the package files that find_package(lcpbench) reads.
include(CMakePackageConfigHelpers)

# Headers keep their folders (solvers/lcp/problem.h), below a folder of our own.
set(LCPBENCH_INSTALL_INCLUDEDIR "${CMAKE_INSTALL_INCLUDEDIR}/lcpbench")
set(LCPBENCH_INSTALL_CMAKEDIR "${CMAKE_INSTALL_LIBDIR}/cmake/lcpbench")

install(TARGETS lcpbench_support lcpbench_lcp lcpbench_io lcpbench_exact lcpbench_external lcpbench_model
  lcpbench_solvers lcpbench_step EXPORT lcpbench_targets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  FILE_SET HEADERS DESTINATION "${LCPBENCH_INSTALL_INCLUDEDIR}")
# The C interface is <lcpbench.h>, without a folder: it is the one header that its users need.
install(TARGETS lcpbench_c
  EXPORT lcpbench_targets
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
file(RELATIVE_PATH LCPBENCH_PREFIX_FROM_PC "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file("${PROJECT_SOURCE_DIR}/cmake/lcpbench.pc.in" "${PROJECT_BINARY_DIR}/lcpbench.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/lcpbench.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
install(EXPORT lcpbench_targets NAMESPACE lcpbench:: DESTINATION "${LCPBENCH_INSTALL_CMAKEDIR}")

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/lcpbenchConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/lcpbenchConfig.cmake" INSTALL_DESTINATION "${LCPBENCH_INSTALL_CMAKEDIR}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/lcpbenchConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/lcpbenchConfig.cmake" "${PROJECT_BINARY_DIR}/lcpbenchConfigVersion.cmake"
  DESTINATION "${LCPBENCH_INSTALL_CMAKEDIR}")
install(FILES "${PROJECT_SOURCE_DIR}/cmake/FindIpopt.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindCHOLMOD.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/FindFLINT.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindMPFR.cmake" DESTINATION "${LCPBENCH_INSTALL_CMAKEDIR}")
if(LCPBENCH_BUILD_BENCHMARKS)
  install(TARGETS lcpbench_command RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT command)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/report/" DESTINATION "${CMAKE_INSTALL_DATADIR}/lcpbench/report"
    COMPONENT command
    FILES_MATCHING PATTERN "*.py" PATTERN "*.json" PATTERN "*.j2" PATTERN "*.css" PATTERN "*.js" PATTERN "tests" EXCLUDE
    PATTERN "__pycache__" EXCLUDE)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/python/lcpbench/formats" DESTINATION "${CMAKE_INSTALL_DATADIR}/lcpbench"
    COMPONENT command FILES_MATCHING PATTERN "*.py" PATTERN "__pycache__" EXCLUDE)
  install(FILES "${PROJECT_SOURCE_DIR}/data/sealed.json" DESTINATION "${CMAKE_INSTALL_DATADIR}/lcpbench/data"
          COMPONENT command)
  # The suites that need no more of the collection than a manifest and its answers.
  foreach(suite smoke engine)
    install(FILES "${PROJECT_SOURCE_DIR}/data/${suite}.json" DESTINATION "${CMAKE_INSTALL_DATADIR}/lcpbench/data"
            COMPONENT command)
    install(FILES "${PROJECT_SOURCE_DIR}/data/references/${suite}.jsonl.gz"
            DESTINATION "${CMAKE_INSTALL_DATADIR}/lcpbench/data/references" COMPONENT command)
  endforeach()
endif()
# For LCPBENCH_BUILD_TREE of another build.
if(LCPBENCH_BUILD_BENCHMARKS)
  export(TARGETS lcpbench_warnings lcpbench_reproducible lcpbench_fast lcpbench_support lcpbench_lcp lcpbench_io
    lcpbench_external lcpbench_exact lcpbench_model lcpbench_solvers lcpbench_step lcpbench_campaign
    lcpbench_command
    NAMESPACE lcpbench:: FILE "${PROJECT_BINARY_DIR}/lcpbench_build_tree.cmake")
endif()
