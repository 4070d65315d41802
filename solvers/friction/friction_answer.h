#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "solvers/friction/contact_rows.h"
#include "solvers/lcp/solver.h"

/// Internal to solvers/.
namespace lcpbench {

/// The answer of one solve of a problem with friction: keeps the best candidate and judges it as the verifier does.
class FrictionAnswer {
 public:
  /// What a candidate is compared and kept in; of one solve after the other.
  struct Room {
    PaddedVector gaps, f;
  };
  /// @param rows     of `problem`, with its b
  /// @param problem  nullptr where there is none: then candidates pass by `rows` alone, or not
  /// @param result   its f, of n numbers or more, takes the best candidate
  /// @param room     nullptr: its own
  FrictionAnswer(const ContactRows& rows, const LcpProblem* problem, const LcpOptions& options, LcpResult* result,
                 Room* room = nullptr)
      : rows_(rows), problem_(problem), options_(options), result_(result), room_(room == nullptr ? own_ : *room) {
    if (Deadline::IsNeeded(options)) deadline_.emplace(options);
  }
  FrictionAnswer(const FrictionAnswer&) = delete;
  FrictionAnswer& operator=(const FrictionAnswer&) = delete;

  /// Whether this candidate, n scaled forces, passes; result->status is kSolved then, and its f is kept.
  /// O(nnz), and of one whose rho is small enough and near the limit the verifier's cost.
  bool Take(const PaddedVector& phi);
  /// The same where its gaps are known.
  bool Take(const PaddedVector& phi, const PaddedVector& gaps);
  /// The same of n forces in the problem's units, which are kept bit by bit.
  bool TakeForces(const Eigen::VectorXd& f);
  /// The best candidate so far, scaled. False without one.
  bool GetBest(PaddedVector* phi) const;
  /// rho of the best candidate; infinite without one.
  double rho() const { return rho_; }

  const LcpProblem& problem() const { return *problem_; }  ///< that is solved
  const LcpOptions& options() const { return options_; }   ///< of the solve
  double tolerance() const { return options_.tolerance; }  ///< of rho
  /// Whether time is up, or less is left than passed between two of these questions: what cannot be interrupted, such
  /// as a factorization, is not begun then.
  bool IsLate() const {
    if (!deadline_) return false;
    const double left = deadline_->Remaining();
    longest_ = std::max(longest_, left_ - left);
    left_ = left;
    return left <= longest_;
  }
  /// After what keeps its own limit: the time since IsLate does not count.
  void ForgetTime() const { left_ = 0; }
  double Remaining() const { return deadline_ ? deadline_->Remaining() : kUnlimited; }  ///< seconds, may be infinite
  std::int64_t& iterations() { return result_->iterations; }                            ///< of all methods together
  /// Without a problem: rounding alone leaves open whether the best candidate passes, which a problem's verifier tells.
  bool is_unclear() const {
    return problem_ == nullptr && result_->status != LcpStatus::kSolved && rho_ <= options_.tolerance;
  }
  /// Whether iterations or time are up, or the best candidate is unclear.
  bool IsOver() const {
    return is_unclear() || (options_.max_iterations > 0 && result_->iterations >= options_.max_iterations) || IsLate();
  }
  /// The end of a solve without an answer: the best candidate is judged by the verifier, then a limit, or `detail`.
  void Fail(const char* detail) const;

 private:
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  bool Judge();

  const ContactRows& rows_;
  const LcpProblem* const problem_;
  const LcpOptions& options_;
  std::optional<Deadline> deadline_;  // none where it is not needed: reading the clock costs
  mutable double left_ = 0, longest_ = 0;
  LcpResult* const result_;
  double rho_ = std::numeric_limits<double>::infinity();
  Room own_;
  Room& room_;
};

}  // namespace lcpbench
