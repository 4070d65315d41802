# The target doc: a reference of the headers that users include, as HTML. It fails where a comment does not fit what it
# stands at.
set(LCPBENCH_DOC_DIR "${PROJECT_BINARY_DIR}/doc" CACHE PATH "Where the target doc writes html/")
find_package(Doxygen)
if(NOT DOXYGEN_FOUND)
  return()
endif()

# lcpbench_doc_headers(<variable> <target>...): the header sets of these targets.
function(lcpbench_doc_headers variable)
  set(all)
  foreach(target IN LISTS ARGN)
    get_target_property(headers ${target} HEADER_SET)
    get_target_property(source_dir ${target} SOURCE_DIR)
    foreach(header IN LISTS headers)
      cmake_path(ABSOLUTE_PATH header BASE_DIRECTORY "${source_dir}")
      list(APPEND all "${header}")
    endforeach()
  endforeach()
  set(${variable} "${all}" PARENT_SCOPE)
endfunction()

set(DOXYGEN_OUTPUT_DIRECTORY "${LCPBENCH_DOC_DIR}")
set(DOXYGEN_STRIP_FROM_PATH "${PROJECT_SOURCE_DIR}")
set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
set(DOXYGEN_GENERATE_LATEX NO)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_QUIET YES)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
# A parameter whose name says all needs no line.
set(DOXYGEN_WARN_IF_INCOMPLETE_DOC NO)

# Solvers and their interface are what programs are written against: each of their members says what it is.
lcpbench_doc_headers(interface lcpbench_c lcpbench_lcp lcpbench_io lcpbench_external lcpbench_solvers lcpbench_step)
set(DOXYGEN_WARN_IF_UNDOCUMENTED YES)
# Doxygen insists on writing something.
set(DOXYGEN_GENERATE_HTML NO)
set(DOXYGEN_GENERATE_XML YES)
set(DOXYGEN_XML_PROGRAMLISTING NO)
doxygen_add_docs(doc_of_interface ${interface} COMMENT "Looking for members of the interface without documentation")

# The model's points, sums and accessors need no words.
lcpbench_doc_headers(model lcpbench_model)
set(DOXYGEN_WARN_IF_UNDOCUMENTED NO)
set(DOXYGEN_GENERATE_HTML YES)
set(DOXYGEN_GENERATE_XML NO)
set(DOXYGEN_EXTRACT_ALL YES)
set(DOXYGEN_IMAGE_PATH "${PROJECT_SOURCE_DIR}/docs" "${PROJECT_SOURCE_DIR}/report/reference")
set(DOXYGEN_FILTER_PATTERNS "*.md=${PROJECT_SOURCE_DIR}/cmake/markdown_filter.sh")
set(DOXYGEN_USE_MATHJAX YES)
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE "${PROJECT_SOURCE_DIR}/README.md")
# README, and every page that it leads to.
file(GLOB pages CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/docs/*.md" "${PROJECT_SOURCE_DIR}/docs/solvers/*.md")
list(PREPEND pages "${PROJECT_SOURCE_DIR}/README.md")
foreach(page SECURITY.md benchmarks/RESULTS.md benchmarks/FIELDS.md data/README.md data/scenes/README.md tests/data/oracle/README.md
             tests/data/myphysicslab/README.md report/reference/README.md report/reference/summary.md)
  list(APPEND pages "${PROJECT_SOURCE_DIR}/${page}")
endforeach()
doxygen_add_docs(doc ${pages} ${interface} ${model} COMMENT "Writing ${LCPBENCH_DOC_DIR}/html")
add_dependencies(doc doc_of_interface)
