#include "solvers/peers/dantzig_peer.h"

#include <algorithm>
#include <limits>

#include "solvers/peers/peer_library.h"

namespace lcpbench {

DantzigPeer::Options DantzigPeer::Options::FromSettings(const Settings& settings, std::string_view owner,
                                                        double default_cfm) {
  SettingsReader reader(owner, settings);
  Options options;
  options.cfm = reader.Number("cfm", default_cfm, 0, 1);
  reader.Finish();
  return options;
}

void DantzigPeer::DoPrepare(const LcpProblem& problem) {
  const auto n = static_cast<std::size_t>(problem.size());
  const auto stride = static_cast<std::size_t>(code_.stride(static_cast<int>(n)));
  const Eigen::MatrixXd& A = problem.DenseA();
  const double shift = options_.cfm * problem.DiagonalA().cwiseAbs().maxCoeff();
  A_.assign(n * stride, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) A_[i * stride + j] = A(static_cast<Index>(i), static_cast<Index>(j));
    A_[i * stride + i] += shift;
  }
  b_.assign(stride, 0);
  lower_.assign(stride, 0);
  upper_.assign(stride, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < n; ++i) {
    b_[i] = -problem.b()[static_cast<Index>(i)];
    if (problem.is_bilateral(static_cast<Index>(i))) lower_[i] = -std::numeric_limits<double>::infinity();
  }
  work_A_.resize(A_.size());
  x_.resize(stride);
  w_.resize(stride);
  work_b_.resize(stride);
  work_lower_.resize(stride);
  work_upper_.resize(stride);
  findex_.resize(stride);
}

void DantzigPeer::DoSolve(const LcpProblem& problem, const LcpOptions& /*options*/, LcpResult* result) {
  const auto rows = static_cast<int>(problem.size());
  const DantzigProblem call{rows,      code_.stride(rows), work_A_.data(),     x_.data(),     work_b_.data(),
                            w_.data(), work_lower_.data(), work_upper_.data(), findex_.data()};
  TimeConversion(result, [&] {
    std::copy(A_.begin(), A_.end(), work_A_.begin());
    std::copy(b_.begin(), b_.end(), work_b_.begin());
    std::copy(lower_.begin(), lower_.end(), work_lower_.begin());
    std::copy(upper_.begin(), upper_.end(), work_upper_.begin());
    std::fill(x_.begin(), x_.end(), 0);
    std::fill(w_.begin(), w_.end(), 0);
    std::fill(findex_.begin(), findex_.end(), -1);
    if (code_.before != nullptr) code_.before(call);
  });
  bool solved = false;
  TimeLibraryCall(result, [&] { solved = code_.call(call); });
  if (code_.after != nullptr) TimeConversion(result, [&] { code_.after(call); });
  result->f = Eigen::Map<const Eigen::VectorXd>(x_.data(), problem.size());
  result->status = solved ? LcpStatus::kSolved : LcpStatus::kNumericalFailure;
  if (!solved) result->detail = "the code returned failure";
}

}  // namespace lcpbench
