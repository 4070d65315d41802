lcpbench_peer_option(SICONOS Siconos libsiconos-numerics-dev)
if(LCPBENCH_WITH_SICONOS)
  # Debian's package file for CMake names components that this package does not hold.
  find_path(SICONOS_INCLUDE_DIR NAMES siconos/SiconosConfig.h)
  find_library(SICONOS_NUMERICS_LIBRARY NAMES siconos_numerics)
  mark_as_advanced(SICONOS_INCLUDE_DIR SICONOS_NUMERICS_LIBRARY)
  if(SICONOS_INCLUDE_DIR AND SICONOS_NUMERICS_LIBRARY)
    lcpbench_add_peer(siconos SOURCES siconos/siconos.cc siconos/siconos_contacts.cc siconos/siconos_numerics.cc ../linear_algebra/loaded_blas.cc
                      LIBRARIES "${SICONOS_NUMERICS_LIBRARY}" ${CMAKE_DL_LIBS})
    target_include_directories(lcpbench_worker_siconos SYSTEM PRIVATE
      "${SICONOS_INCLUDE_DIR}/siconos" "${SICONOS_INCLUDE_DIR}/siconos/numerics")
    # Neither headers nor library tell a version; the number of the shared library does. 7 is release 4.4.
    get_filename_component(siconos_file "${SICONOS_NUMERICS_LIBRARY}" REALPATH)
    string(REGEX REPLACE "^.*\\.so\\.?" "" siconos_number "${siconos_file}")
    if(siconos_number MATCHES "^7\\.")
      set(siconos_number "4.4")
    else()
      set(siconos_number "shared library ${siconos_number}")
    endif()
    target_compile_definitions(lcpbench_worker_siconos PRIVATE LCPBENCH_SICONOS_VERSION="${siconos_number}")
  else()
    lcpbench_peer_missing(SICONOS Siconos libsiconos-numerics-dev)
  endif()
endif()
