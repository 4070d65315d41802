# The library and its headers are those of the wheel `casadi`, which is there for them: DAQP's own wheel has none. Neither
# header nor library tells a version.
lcpbench_add_wheel_peer(daqp LIBRARY_NAME DAQP WHEEL casadi PREFIX casadi INCLUDE include HEADER daqp/api.h
                        SHARED libdaqp.so VERSION_OF casadi VERSION_PREFIX "as in CasADi "
                        SOURCES qp/quadratic_program.cc)
