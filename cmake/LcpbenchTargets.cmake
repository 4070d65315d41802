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
  target_compile_options(lcpbench_fast INTERFACE -march=${LCPBENCH_MARCH}
    # GCC 12's own AVX-512 intrinsics trip this warning (GCC bug 105593); builds without native flags keep it.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
endif()

# lcpbench_add_library(<name> [FOLDERS <folder>...] [SOURCES <file>...] [HEADERS <file>...] [WITHOUT <regex>]): static
# library lcpbench_<name>, alias lcpbench::<name>, of all .cc in the folders (default: the one of the CMakeLists.txt) but
# those whose path fits WITHOUT, and of SOURCES. HEADERS are what it shows; default: all .h in the folders.
function(lcpbench_add_library name)
  cmake_parse_arguments(ARG "" "WITHOUT" "FOLDERS;SOURCES;HEADERS" ${ARGN})
  if(NOT ARG_FOLDERS)
    set(ARG_FOLDERS .)
  endif()
  set(headers)
  foreach(folder IN LISTS ARG_FOLDERS)
    file(GLOB found CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cc")
    list(APPEND ARG_SOURCES ${found})
    file(GLOB found CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.h")
    list(APPEND headers ${found})
  endforeach()
  if(ARG_WITHOUT)
    list(FILTER ARG_SOURCES EXCLUDE REGEX "${ARG_WITHOUT}")
    list(FILTER headers EXCLUDE REGEX "${ARG_WITHOUT}")
  endif()
  if(NOT ARG_HEADERS)
    set(ARG_HEADERS ${headers})
  endif()
  add_library(lcpbench_${name} STATIC ${ARG_SOURCES})
  add_library(lcpbench::${name} ALIAS lcpbench_${name})
  set_target_properties(lcpbench_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_sources(lcpbench_${name} PUBLIC FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${ARG_HEADERS})
  target_compile_features(lcpbench_${name} PUBLIC cxx_std_20)
  target_link_libraries(lcpbench_${name} PRIVATE $<BUILD_INTERFACE:lcpbench_warnings>)
endfunction()

# lcpbench_files(<variable> <folder>...): all .cc in these folders.
function(lcpbench_files variable)
  list(TRANSFORM ARGN APPEND "/*.cc" OUTPUT_VARIABLE patterns)
  list(TRANSFORM patterns PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
  file(GLOB found CONFIGURE_DEPENDS ${patterns})
  set(${variable} ${found} PARENT_SCOPE)
endfunction()

# lcpbench_unite(<target> [TOGETHER] [WITHOUT <regex>]): compiles the target's files as one, by folders or TOGETHER, but
# for those that fit WITHOUT: what they include is then compiled once for all of them. Names of one file (in anonymous
# namespaces) must not mean something else in another one that is compiled with it. Not for solvers: what is inlined, and
# so what is fused, depends on the file.
function(lcpbench_unite target)
  cmake_parse_arguments(ARG "TOGETHER" "WITHOUT" "" ${ARGN})
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(GET source PARENT_PATH folder)
    if(ARG_WITHOUT AND source MATCHES "${ARG_WITHOUT}")
      continue()
    elseif(ARG_TOGETHER)
      set(folder all)
    endif()
    cmake_path(GET folder FILENAME group)
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP "of_${group}")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${LCPBENCH_UNITE} UNITY_BUILD_MODE GROUP)
  # GCC takes a class of one file's anonymous namespace for one of a header.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# lcpbench_untimed(<target>): no benchmark times this code, and the compiler's work on it pays in its time, not in ours.
# The bits of results do not depend on it: only solvers' targets have fused operations.
function(lcpbench_untimed target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# lcpbench_precompile(<target> [<header>...]): compiles once what most of the target's files include: Eigen, the standard
# library's common headers, and these headers. It takes a third of the time of a build from nothing.
function(lcpbench_precompile target)
  list(TRANSFORM ARGN REPLACE "(.+)" "<\\1>")
  target_precompile_headers(${target} PRIVATE <Eigen/Core> <Eigen/SparseCore> <functional> <memory> <optional> <string>
                                              <vector> ${ARGN})
  # GCC 12 no longer knows then what stands in a system header, and warns of std::string's own code (GCC bug 105651).
  target_compile_options(${target} PRIVATE
    "$<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow;-Wno-stringop-overread>")
endfunction()
