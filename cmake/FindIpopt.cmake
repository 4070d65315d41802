# Ipopt, as the imported target Ipopt::Ipopt.
#
# Debian 12 ships 3.11.9, whose pkg-config file names a nested include folder and whose headers choose between <cstddef>
# and <stddef.h> by HAVE_CSTDDEF, a macro of Ipopt's own configure script that the installed config header does not set.
# Its headers also predate -Woverloaded-virtual and friends, hence SYSTEM includes.
find_path(Ipopt_INCLUDE_DIR NAMES IpIpoptApplication.hpp PATH_SUFFIXES coin coin-or)
find_library(Ipopt_LIBRARY NAMES ipopt)
if(Ipopt_INCLUDE_DIR AND EXISTS "${Ipopt_INCLUDE_DIR}/IpoptConfig.h")
  file(STRINGS "${Ipopt_INCLUDE_DIR}/IpoptConfig.h" _ipopt_version REGEX "#define IPOPT_VERSION +\"")
  string(REGEX REPLACE ".*\"(.*)\".*" "\\1" Ipopt_VERSION "${_ipopt_version}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Ipopt REQUIRED_VARS Ipopt_LIBRARY Ipopt_INCLUDE_DIR VERSION_VAR Ipopt_VERSION)
if(Ipopt_FOUND AND NOT TARGET Ipopt::Ipopt)
  add_library(Ipopt::Ipopt UNKNOWN IMPORTED)
  set_target_properties(Ipopt::Ipopt PROPERTIES
    IMPORTED_LOCATION "${Ipopt_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${Ipopt_INCLUDE_DIR}"
    INTERFACE_COMPILE_DEFINITIONS HAVE_CSTDDEF)
endif()
mark_as_advanced(Ipopt_INCLUDE_DIR Ipopt_LIBRARY)
