# Bullet's and ODE's Dantzig codes compiled as our own solvers are, of the sources that `make peers` has unpacked
# (cmake/install_sources.sh). All else, adapter and library, is that of the peer itself: what is compiled here takes the
# place of the library's own.
set(LCPBENCH_PEERS_SOURCES "${PROJECT_SOURCE_DIR}/build/peers-sources" CACHE PATH "Sources of peers, unpacked")

# lcpbench_add_native_peer(<peer> LIBRARY <target> FILES <file>... [INCLUDE <folder>]): the peer <peer>-native. FILES are
# below LCPBENCH_PEERS_SOURCES/<peer>.
function(lcpbench_add_native_peer peer)
  cmake_parse_arguments(ARG "" "LIBRARY;INCLUDE" "FILES" ${ARGN})
  list(TRANSFORM ARG_FILES PREPEND "${LCPBENCH_PEERS_SOURCES}/${peer}/")
  list(GET ARG_FILES 0 first)
  if(NOT TARGET lcpbench_linked_${peer} OR NOT EXISTS "${first}")
    return()
  endif()
  add_library(lcpbench_${peer}_native OBJECT ${ARG_FILES})
  get_filename_component(beside "${first}" DIRECTORY)
  target_include_directories(lcpbench_${peer}_native PRIVATE ${ARG_INCLUDE} "${beside}")
  target_compile_options(lcpbench_${peer}_native PRIVATE -w)
  target_link_libraries(lcpbench_${peer}_native PRIVATE lcpbench_fast ${ARG_LIBRARY})
  lcpbench_add_peer(${peer}-native LIBRARIES lcpbench_${peer}_native lcpbench_linked_${peer})
endfunction()

lcpbench_add_native_peer(bullet LIBRARY PkgConfig::bullet_float64
                         FILES src/BulletDynamics/MLCPSolvers/btDantzigLCP.cpp)
# What its configure script would find out, as far as these files ask.
file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/ode-native/config.h" CONTENT
"#define dTHREADING_INTF_DISABLED 1
#include <alloca.h>
#include <malloc.h>
#include <stdint.h>
#include <typedefs.h>
")
lcpbench_add_native_peer(ode LIBRARY PkgConfig::ode
                         FILES ode/src/lcp.cpp ode/src/matrix.cpp ode/src/fastdot.cpp
                         INCLUDE "${CMAKE_CURRENT_BINARY_DIR}/ode-native")
