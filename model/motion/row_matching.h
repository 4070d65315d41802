#pragma once

#include <optional>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"

namespace lcpbench {

/// Recognises the rows of one instant in the next: the same constraint type and axis between the same features of the
/// same bodies. Where one pair of features touches at several places (two general curves), rows go to those whose
/// normals have turned least. One object follows one motion.
class RowMatching {
 public:
  /// For every row of the instant the index that it had in the instant given before, or nothing: it was not there.
  /// O(rows) expected; k places of one pair of features cost O(k^2).
  /// @param system  the instant whose assembly `rows` is (AssembledLcp::rows)
  std::vector<std::optional<int>> Follow(const ContactSystem& system, const std::vector<RowInfo>& rows);

 private:
  std::vector<std::vector<double>> keys_;  // of the instant before, by row
  std::vector<Vec2> normals_;
};

}  // namespace lcpbench
