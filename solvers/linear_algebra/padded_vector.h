#pragma once

#include <Eigen/Core>

/// Internal to solvers/.
namespace lcpbench {

/// Whole cache lines, but no multiple of 4 KiB: walking along a row would then hit one cache set only.
inline Eigen::Index PaddedStride(Eigen::Index rows) {
  const Eigen::Index stride = (rows + 7) / 8 * 8;
  return stride % 512 == 0 ? stride + 8 : stride;
}

/// Numbers in whole cache lines: methods read and write up to the end of the register that the last number is in. Only
/// `head` says how many numbers count.
class PaddedVector : public Eigen::VectorXd {
 public:
  /// Makes it at least so long; what it holds then is not defined.
  void Lengthen(Eigen::Index size) {
    if (this->size() < PaddedStride(size)) resize(PaddedStride(size));
  }
};

}  // namespace lcpbench
