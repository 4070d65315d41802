lcpbench_add_wheel_peer(qpoases LIBRARY_NAME qpOASES WHEEL cmeel-qpoases PREFIX cmeel.prefix INCLUDE include
                        HEADER qpOASES.hpp SHARED lib/libqpOASES.so VERSION_OF cmeel_qpoases
                        SOURCES qp/quadratic_program.cc)
