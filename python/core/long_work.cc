#include "python/core/long_work.h"

namespace lcpbench::python {
namespace nb = nanobind;

bool IsMainThread() {
  static const auto main =
      nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
  return PyThread_get_thread_ident() == main;
}

bool HasSignalRaised(void* /*unused*/) {
  const nb::gil_scoped_acquire gil;
  return PyErr_CheckSignals() != 0;
}

}  // namespace lcpbench::python
