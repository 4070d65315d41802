#pragma once

#include <Eigen/Core>

#include "solvers/dantzig.h"
#include "solvers/pivot_base.h"

namespace lcpbench {

/// The workings of DantzigSolver, shared by dantzig.cc (a solve from loading to the final judgement) and
/// dantzig_drive.cc (the driving of one row); no part of the interface.
///
/// Positions: F = [0, m), of which [0, joints) are bilateral; watched rows [m, q) with f = 0, w >= 0; the driven row q
// and the waiting rows behind it, [q, open); then rows out of play: dependent bilateral rows and stuck ones.
class DantzigSolver::Engine final : public PivotBase {
 public:
  explicit Engine(DantzigOptions options)
      : PivotBase(options.rank_tolerance, options.block_start, options.self_check), options_(options) {}

  void Reserve(Index max_rows) override;

 private:
  struct Blocking {
    Index row = kNoRow;
    double step = 0;
  };

  End Run(LcpResult* result) override;
  End DriveAll(LcpResult* result);
  End Drive(LcpResult* result);
  Blocking FindBlocking(double s, double norm2, bool singular, bool least_index) const;
  void Advance(double step, double s, bool singular);
  void Retreat(double norm2);
  double NoiseAlongDirection() const;
  bool IsSmall(Index p, double norm2) const;
  bool FindViolations();

  Index rates_end() const { return options_.order == DantzigOrder::kIndex ? q_ : open_; }

  const DantzigOptions options_;
  Index q_ = 0;
  Eigen::VectorXd dw_;  // rates of w along the direction, by position
};

}  // namespace lcpbench
