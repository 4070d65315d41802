#include "solvers/active_set_solver.h"

namespace lcpbench {

BppOptions ActiveSetOptions::Defaults() {
  BppOptions options;
  options.form = BppOptions::Form::kAny;
  return options;
}

ActiveSetOptions ActiveSetOptions::FromSettings(const Settings& settings) {
  ActiveSetOptions options;
  options.method = BppOptions::FromSettings(settings, "active-set");
  if (options.method.form == BppOptions::Form::kAuto) options.method.form = BppOptions::Form::kAny;
  return options;
}

}  // namespace lcpbench
