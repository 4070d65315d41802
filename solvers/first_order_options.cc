#include "solvers/first_order_options.h"

#include <string>

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

}  // namespace lcpbench
