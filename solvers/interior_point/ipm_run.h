#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "solvers/active_set/block_pivoting.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"
#include "solvers/linear_algebra/scaled_system.h"

namespace lcpbench {

/// What happened below an IpmSolver, for tests and tuning.
struct IpmStatistics {
  std::int64_t analyses = 0;        ///< symbolic, in the latest Prepare; 0 if those of the problem before serve
  std::int64_t factorizations = 0;  ///< numeric, in the latest Solve
  std::int64_t interior_steps = 0;  ///< of these, interior-point steps
  std::int64_t pivots = 0;          ///< of these, active sets tried
  bool body_space = false;          ///< the systems live on the bodies
  double fill = 0;                  ///< entries of L
  double factor_flops = 0;          ///< of one factorization
};

/// One solve of the `ipm` backend: limits, counters and the best iterate so far, shared by its two methods; the system
/// as the block that active sets are tried on.
class IpmRun final : public AnswerSink, public ActiveBlock {
 public:
  /// Those of IpmOptions.
  struct Own {
    double proximal;
    int correctors;
    bool self_check;
  };

  /// @param test  of the system's problem
  IpmRun(ScaledSystem& system, GivenFormTest& test, const Own& own, const LcpOptions& options,
         IpmStatistics& statistics)
      : system_(system),
        test_(test),
        own_(own),
        options_(options),
        deadline_(options),
        limit_(options.max_iterations > 0 ? options.max_iterations : kDefaultLimit),
        statistics_(statistics),
        best_f_(Eigen::VectorXd::Zero(system.size())),
        candidate_(best_f_) {}

  ScaledSystem& system() { return system_; }
  /// Weight of the proximal term.
  double proximal() const { return own_.proximal; }
  int correctors() const { return own_.correctors; }
  const LcpOptions& options() const { return options_; }
  IpmStatistics& statistics() { return statistics_; }

  /// Factorizes A^ + diag(theta) if the limits allow it. False: limit_hit() or a breakdown told by system().why().
  bool Factorize(const Eigen::VectorXd& theta) {
    if (limit_hit()) return false;
    if (statistics_.factorizations >= limit_) {
      status_ = LcpStatus::kIterationLimit;
      return false;
    }
    if (NoTimeForAnother()) {
      status_ = LcpStatus::kTimeLimit;
      return false;
    }
    ++statistics_.factorizations;
    return system_.Factorize(theta);
  }
  /// Seconds until the limit; false where none are left.
  bool TimeLeft(double* seconds) const {
    *seconds = options_.time_limit_s - deadline_.Elapsed();
    return *seconds > 0;
  }
  /// True once a limit has stopped a factorization; limit_status() says which.
  bool limit_hit() const { return status_ != LcpStatus::kNotRun; }
  LcpStatus limit_status() const { return status_; }

  /// Whether f (in the problem's units) meets the tier, in extended precision; remembers the iterate of least rho, one
  /// that meets the tier before all that do not.
  bool Accept(const Eigen::VectorXd& f) {
    const double tolerance = kMargin * options_.tolerance;
    const auto rho = static_cast<double>(test_.Rho(f));
    bool meets = rho <= tolerance;
    for (Index i = 0; meets && own_.self_check && i < f.size(); ++i) meets = test_.RowMeets(tolerance, f, i);
    return Note(f, rho, meets);
  }
  /// The same for f^ in scaled variables; *w becomes the scaled gaps unless it is nullptr.
  bool AcceptScaled(const Eigen::VectorXd& scaled_f, Eigen::VectorXd* w) {
    const ScaledVectors& rows = system_.rows();
    for (Index i = 0; i < scaled_f.size(); ++i) candidate_[i] = rows.GivenForce(i, scaled_f[i]);
    const bool meets = Accept(candidate_);
    for (Index i = 0; w != nullptr && i < w->size(); ++i) {
      (*w)[i] = rows.ScaledGap(i, static_cast<double>(test_.w(i)));
    }
    return meets;
  }
  const Eigen::VectorXd& best_f() const { return best_f_; }
  double best_rho() const { return best_rho_; }
  /// Whether best_f() meets the tier.
  bool accepted() const { return accepted_; }

  // AnswerSink
  Eigen::VectorXd& candidate() override { return candidate_; }
  /// Accept where the candidate is near by its rho in double.
  bool Publish() override {
    const ScaledVectors& rows = system_.rows();
    scaled_.resize(candidate_.size());
    for (Index i = 0; i < candidate_.size(); ++i) scaled_[i] = rows.ScaledForce(i, candidate_[i]);
    system_.Multiply(scaled_, &product_);
    product_ += system_.b();
    latest_rho_ = rows.Rho(scaled_, product_);
    return latest_rho_ > kNear * options_.tolerance ? Note(candidate_, latest_rho_, false) : Accept(candidate_);
  }
  double rho() const override { return latest_rho_; }
  double tier() const override { return accepted_ ? best_rho_ : std::numeric_limits<double>::infinity(); }

  // ActiveBlock, of the prepared system: a factor within the limits of the run.
  void Analyze(const LcpProblem& /*problem*/) override {}
  void Load(const LcpProblem& /*problem*/, const Eigen::VectorXd& /*scale*/) override {}
  bool Factor(const std::vector<char>& active, double shift, const Deadline* /*deadline*/) override {
    out_.resize(system_.size());
    for (Index i = 0; i < out_.size(); ++i) out_[i] = active[static_cast<size_t>(i)] != 0 ? shift : ScaledSystem::kOut;
    if (!Factorize(out_)) return false;
    ++statistics_.pivots;
    return true;
  }
  void Solve(double* x) override {
    Eigen::Map<Eigen::VectorXd> values(x, out_.size());
    right_ = (out_.array() < ScaledSystem::kOut).select(values, 0.0);
    system_.Solve(right_, &right_);
    values = (out_.array() < ScaledSystem::kOut).select(right_, 0.0);
  }
  void Multiply(const double* x, double* y) const override {
    system_.Multiply(Eigen::Map<const Eigen::VectorXd>(x, out_.size()), &product_);
    std::copy(product_.begin(), product_.end(), y);
  }
  double factor_time() const override { return 0; }
  Index CountDependentRows() const override { return 0; }

 private:
  // Remembers it as Accept says.
  bool Note(const Eigen::VectorXd& f, double rho, bool meets) {
    if (meets == accepted_ ? rho < best_rho_ : meets) {
      best_f_ = f;
      best_rho_ = rho;
    }
    accepted_ = accepted_ || meets;
    return meets;
  }
  // A factorization cannot be interrupted, so none is begun that would end late by more than kAllowedOvershoot, if it
  // takes as long as the one before with all that followed.
  bool NoTimeForAnother() {
    const double now = deadline_.Elapsed();
    if (!std::isfinite(options_.time_limit_s)) return false;
    const double lap = last_factorization_ < 0 ? 0.0 : now - last_factorization_;
    last_factorization_ = now;
    return now >= options_.time_limit_s || now + lap > (1 + kAllowedOvershoot) * options_.time_limit_s;
  }

  static constexpr double kAllowedOvershoot = 0.1;
  static constexpr std::int64_t kDefaultLimit = 500;
  // Our residual and the verdict's differ by rounding; a claim must hold in both.
  static constexpr double kMargin = 0.9;
  // Times the tolerance: rho in double that calls for extended precision.
  static constexpr double kNear = 10;

  ScaledSystem& system_;
  GivenFormTest& test_;
  const Own own_;
  const LcpOptions& options_;
  Deadline deadline_;
  std::int64_t limit_;
  IpmStatistics& statistics_;
  LcpStatus status_ = LcpStatus::kNotRun;
  double last_factorization_ = -1;  // when it began [s]
  Eigen::VectorXd best_f_;
  Eigen::VectorXd candidate_;
  Eigen::VectorXd scaled_;  // the latest candidate
  mutable Eigen::VectorXd product_;
  double latest_rho_ = 0;        // in double
  Eigen::VectorXd out_, right_;  // theta of the latest active set
  bool accepted_ = false;
  double best_rho_ = std::numeric_limits<double>::infinity();
};

}  // namespace lcpbench
