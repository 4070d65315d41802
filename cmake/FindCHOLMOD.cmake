# CHOLMOD of SuiteSparse, with the BLAS and LAPACK that it calls, and KLU beside it, as the imported target
# CHOLMOD::CHOLMOD.
# Debian 12's SuiteSparse 5.12 has no CMake package files.
find_path(CHOLMOD_INCLUDE_DIR NAMES cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY NAMES cholmod)
find_library(KLU_LIBRARY NAMES klu)
if(CHOLMOD_INCLUDE_DIR AND EXISTS "${CHOLMOD_INCLUDE_DIR}/cholmod.h")
  set(CHOLMOD_VERSION "")
  foreach(_cholmod_part MAIN SUB SUBSUB)
    file(STRINGS "${CHOLMOD_INCLUDE_DIR}/cholmod.h" _cholmod_line REGEX "#define CHOLMOD_${_cholmod_part}_VERSION [0-9]+")
    if(NOT _cholmod_line)  # SuiteSparse 5 defines the version one header further
      file(STRINGS "${CHOLMOD_INCLUDE_DIR}/cholmod_core.h" _cholmod_line
           REGEX "#define CHOLMOD_${_cholmod_part}_VERSION [0-9]+")
    endif()
    if(_cholmod_line MATCHES "_VERSION ([0-9]+)")
      list(APPEND CHOLMOD_VERSION "${CMAKE_MATCH_1}")
    endif()
  endforeach()
  list(JOIN CHOLMOD_VERSION "." CHOLMOD_VERSION)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CHOLMOD REQUIRED_VARS CHOLMOD_LIBRARY KLU_LIBRARY CHOLMOD_INCLUDE_DIR VERSION_VAR CHOLMOD_VERSION)
if(CHOLMOD_FOUND AND NOT TARGET CHOLMOD::CHOLMOD)
  add_library(CHOLMOD::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(CHOLMOD::CHOLMOD PROPERTIES
    IMPORTED_LOCATION "${CHOLMOD_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${CHOLMOD_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${KLU_LIBRARY}")
endif()
mark_as_advanced(CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY KLU_LIBRARY)
