#include "solvers/peers/simbody/impulse_code.h"

#include <simbody/internal/ImpulseSolver.h>
#include <simbody/internal/PGSImpulseSolver.h>
#include <simbody/internal/PLUSImpulseSolver.h>
#include <simbody/internal/common.h>

#include <cstddef>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

namespace lcpbench {
namespace {

// The library counts, and tells nobody.
template <typename Base>
class Counting : public Base {
 public:
  using Base::Base;
  long long iterations() const { return Base::m_nIters[0]; }
};

template <typename Solver>
class Code : public ImpulseCode {
 public:
  void SetMatrix(int rows, const double* A, const std::vector<int>& joints,
                 const std::vector<Contact>& contacts) override {
    A_.resize(rows, rows);
    for (int column = 0; column < rows; ++column) {
      for (int row = 0; row < rows; ++row) {
        A_(row, column) =
            A[static_cast<std::size_t>(row) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(column)];
      }
    }
    D_.resize(rows);
    D_.setToZero();
    rows_.clear();
    joints_.clear();
    contacts_.clear();
    for (int row = 0; row < rows; ++row) rows_.push_back(SimTK::MultiplierIndex(row));
    for (const int row : joints) {
      SimTK::ImpulseSolver::UncondRT joint;
      joint.m_mults.push_back(SimTK::MultiplierIndex(row));
      joints_.push_back(joint);
    }
    for (const Contact& given : contacts) {
      SimTK::ImpulseSolver::UniContactRT contact;
      contact.m_Nk = SimTK::MultiplierIndex(given.normal);
      contact.m_slipVel = SimTK::Vec2(0, 0);
      contact.m_slipMag = 0;
      contact.m_type = SimTK::ImpulseSolver::Participating;
      if (given.tangent >= 0) {
        contact.m_Fk.push_back(SimTK::MultiplierIndex(given.tangent));
        contact.m_Fk.push_back(SimTK::MultiplierIndex(given.other_tangent));
        contact.m_effMu = given.mu;
      }
      contacts_.push_back(contact);
    }
  }

  void Begin(const double* b, const Limits& limits) override {
    constexpr double kNoSlip = 0;  // the speed up to which a contact counts as one that sticks
    solver_.emplace(kNoSlip);
    if (limits.tolerance >= 0) solver_->setConvergenceTol(limits.tolerance);
    if (limits.iterations > 0) solver_->setMaxIterations(limits.iterations);
    velocity_.resize(D_.size());
    for (int row = 0; row < D_.size(); ++row) velocity_[row] = b[row];
    expansion_.resize(D_.size());
    expansion_.setToZero();
    solved_joints_ = joints_;
    solved_contacts_ = contacts_;
  }

  bool Solve() override {
    SimTK::Vector applied;
    SimTK::Array_<SimTK::MultiplierIndex> expanding;
    SimTK::Array_<SimTK::ImpulseSolver::UniSpeedRT> speeds;
    SimTK::Array_<SimTK::ImpulseSolver::BoundedRT> bounded;
    SimTK::Array_<SimTK::ImpulseSolver::ConstraintLtdFrictionRT> joint_friction;
    SimTK::Array_<SimTK::ImpulseSolver::StateLtdFrictionRT> known_friction;
    return solver_->solve(0, rows_, A_, D_, expanding, expansion_, velocity_, applied, impulse_, solved_joints_,
                          solved_contacts_, speeds, bounded, joint_friction, known_friction);
  }
  double Force(int row) const override { return row < impulse_.size() ? -impulse_[row] : 0; }
  long long iterations() const override { return solver_->iterations(); }

 private:
  std::optional<Solver> solver_;
  SimTK::Matrix A_;
  SimTK::Vector D_, velocity_, expansion_, impulse_;
  SimTK::Array_<SimTK::MultiplierIndex> rows_;
  SimTK::Array_<SimTK::ImpulseSolver::UncondRT> joints_, solved_joints_;
  SimTK::Array_<SimTK::ImpulseSolver::UniContactRT> contacts_, solved_contacts_;
};

}  // namespace

std::unique_ptr<ImpulseCode> MakeImpulseCode(bool by_pruning) {
  // Debian's library has its debugging code in, which formats and writes each step.
  std::cout.setstate(std::ios::badbit);
  std::clog.setstate(std::ios::badbit);
  if (by_pruning) return std::make_unique<Code<Counting<SimTK::PLUSImpulseSolver>>>();
  return std::make_unique<Code<Counting<SimTK::PGSImpulseSolver>>>();
}

std::string SimbodyVersion() {
  int major = 0;
  int minor = 0;
  int build = 0;
  SimTK_version_simbody(&major, &minor, &build);
  return std::to_string(major) + "." + std::to_string(minor);
}

}  // namespace lcpbench
