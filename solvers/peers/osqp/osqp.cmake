# The library and its headers are those of the wheel `casadi`, which is there for them: OSQP's own wheel has none.
lcpbench_add_wheel_peer(osqp LIBRARY_NAME OSQP WHEEL casadi PREFIX casadi INCLUDE include HEADER osqp/osqp.h
                        SHARED libosqp.so SOURCES qp/quadratic_program.cc)
