# Interface targets that every target of ours links, so that flags are written once.

add_library(lcpbench_warnings INTERFACE)
target_compile_options(lcpbench_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Woverloaded-virtual
  # GCC 12 sees overlapping copies in std::string's operator+ where there are none (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<BOOL:${LCPBENCH_WERROR}>:-Werror>)

# The model and the problem type must give the same bits on every x86-64 machine: no fused multiply-add, no native
# instructions. Solvers may use whatever the machine has.
add_library(lcpbench_reproducible INTERFACE)
target_compile_options(lcpbench_reproducible INTERFACE -ffp-contract=off
  # Told to use FMA, GCC 12 vectorises a - b c into fused subtractions all the same.
  $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)

add_library(lcpbench_fast INTERFACE)
if(LCPBENCH_NATIVE)
  target_compile_options(lcpbench_fast INTERFACE -march=native
    # GCC 12's own AVX-512 intrinsics trip this warning (GCC bug 105593); builds without native flags keep it.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()

# lcpbench_add_library(<name> SOURCES ... HEADERS ...): static library lcpbench_<name>, alias lcpbench::<name>.
function(lcpbench_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS" ${ARGN})
  add_library(lcpbench_${name} STATIC ${ARG_SOURCES})
  add_library(lcpbench::${name} ALIAS lcpbench_${name})
  set_target_properties(lcpbench_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_sources(lcpbench_${name} PUBLIC FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${ARG_HEADERS})
  target_compile_features(lcpbench_${name} PUBLIC cxx_std_20)
  target_link_libraries(lcpbench_${name} PRIVATE $<BUILD_INTERFACE:lcpbench_warnings>)
endfunction()
