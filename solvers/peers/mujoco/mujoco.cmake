# The wheel `mujoco-core` is the library of the wheel `mujoco` without viewer. The adapter fills structures that change
# between releases, hence one version.
lcpbench_add_wheel_peer(mujoco LIBRARY_NAME "MuJoCo 4.0.0" WHEEL mujoco-core PREFIX mujoco INCLUDE include
                        HEADER mujoco/mujoco.h SHARED libmujoco.so.4.0.0)
