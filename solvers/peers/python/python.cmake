# Libraries whose wheels have no headers: their Python modules, run by an interpreter within the worker.
lcpbench_peer_option(PYTHON_PEERS "Python peers" "libpython3-dev, PyPI: cmake/packages/requirements-peers.txt")
if(LCPBENCH_WITH_PYTHON_PEERS)
  find_package(Python3 QUIET COMPONENTS Development.Embed)
  # Folder of the table, and the module that has to be there.
  foreach(peer piqp:piqp clarabel:clarabel qpalm:qpalm scs:scs quadprog:quadprog drake:pydrake daqp-avi:daqp
          pinocchio:cmeel.prefix/lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages/pinocchio)
    string(REGEX REPLACE ":.*" "" folder ${peer})
    string(REGEX REPLACE "^[^:]*:" "" module ${peer})
    file(GLOB found LIST_DIRECTORIES true "${LCPBENCH_PEERS_PACKAGES}/${module}"
         "${LCPBENCH_PEERS_PACKAGES}/${module}.*.so")
    if(TARGET Python3::Python AND found AND EXISTS "${LCPBENCH_PEERS_VENV}/bin/python")
      lcpbench_add_peer(${folder} SOURCES python/python.cc qp/quadratic_program.cc LIBRARIES Python3::Python)
      target_compile_definitions(lcpbench_worker_${folder} PRIVATE
        LCPBENCH_PYTHON="${LCPBENCH_PEERS_VENV}/bin/python")
      set(has_python_peers TRUE)
    else()
      lcpbench_peer_missing(PYTHON_PEERS ${folder} "libpython3-dev, PyPI: cmake/packages/requirements-peers.txt")
    endif()
  endforeach()
  # Beside the workers (python.cc), in the build as in an installation.
  if(has_python_peers)
    configure_file(python/peers.py "${PROJECT_BINARY_DIR}/python/peers.py" COPYONLY)
    install(FILES python/peers.py DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/lcpbench/python")
  endif()
endif()
