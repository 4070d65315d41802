# The library and its headers are those of the wheel `casadi`, which is there for them: DAQP's own wheel has none.
lcpbench_peer_option(DAQP DAQP "PyPI: casadi")
if(LCPBENCH_WITH_DAQP)
  if(EXISTS "${LCPBENCH_PEERS_PACKAGES}/casadi/include/daqp/api.h")
    lcpbench_add_peer(daqp SOURCES daqp/daqp.cc qp/quadratic_program.cc
                      LIBRARIES "${LCPBENCH_PEERS_PACKAGES}/casadi/libdaqp.so")
    target_include_directories(lcpbench_worker_daqp SYSTEM PRIVATE "${LCPBENCH_PEERS_PACKAGES}/casadi/include")
    lcpbench_wheel_version(casadi_version casadi)
    # Neither header nor library tells a version.
    target_compile_definitions(lcpbench_worker_daqp PRIVATE LCPBENCH_DAQP_VERSION="as in CasADi ${casadi_version}")
  else()
    lcpbench_peer_missing(DAQP DAQP "PyPI: casadi")
  endif()
endif()
