lcpbench_add_wheel_peer(highs LIBRARY_NAME HiGHS WHEEL highsbox PREFIX highsbox/highs_dist INCLUDE include/highs
                        HEADER Highs.h SHARED lib/libhighs.so SOURCES qp/quadratic_program.cc)
