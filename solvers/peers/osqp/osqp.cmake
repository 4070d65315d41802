# The library and its headers are those of the wheel `casadi`, which is there for them: OSQP's own wheel has none.
lcpbench_peer_option(OSQP OSQP "PyPI: casadi")
if(LCPBENCH_WITH_OSQP)
  if(EXISTS "${LCPBENCH_PEERS_PACKAGES}/casadi/include/osqp/osqp.h")
    lcpbench_add_peer(osqp SOURCES osqp/osqp.cc qp/quadratic_program.cc
                      LIBRARIES "${LCPBENCH_PEERS_PACKAGES}/casadi/libosqp.so")
    target_include_directories(lcpbench_worker_osqp SYSTEM PRIVATE "${LCPBENCH_PEERS_PACKAGES}/casadi/include")
  else()
    lcpbench_peer_missing(OSQP OSQP "PyPI: casadi")
  endif()
endif()
