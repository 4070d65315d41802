#include "solvers/first_order/sweeps/first_order_options.h"

#include <string>

#include "support/input_error.h"

namespace lcpbench {

RowForm ReadRowForm(SettingsReader* reader) {
  const std::string form = reader->Choice("form", "auto", {"auto", "assembled", "matrix-free"});
  if (form == "assembled") return RowForm::kAssembled;
  return form == "matrix-free" ? RowForm::kMatrixFree : RowForm::kAuto;
}

SweepOrder ReadSweepOrder(SettingsReader* reader) {
  const std::string sweep = reader->Choice("sweep", "coloured", {"forward", "symmetric", "coloured"});
  if (sweep == "symmetric") return SweepOrder::kSymmetric;
  return sweep == "forward" ? SweepOrder::kForward : SweepOrder::kColoured;
}

void CheckRelaxation(std::string_view solver, std::string_view option, double relaxation) {
  if (relaxation > 0 && relaxation < 2) return;
  throw InputError(std::string(solver) + ": option '" + std::string(option) + "' must be in (0, 2), found " +
                   std::to_string(relaxation));
}

}  // namespace lcpbench
