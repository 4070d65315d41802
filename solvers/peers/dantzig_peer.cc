#include "solvers/peers/dantzig_peer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

// Without any, all rows are unilateral.
const unsigned char* DataOf(const std::vector<unsigned char>& bilateral) {
  return bilateral.empty() ? nullptr : bilateral.data();
}

}  // namespace

// @param given  a problem, or its arrays
template <typename Given>
void DantzigPeer::Assemble(const Given& given, Index rows) {
  RequireDenseMatrices(rows, 2);  // and the code's own factor
  const Index stride = code_.stride(static_cast<int>(rows));
  A_.resize(static_cast<std::size_t>(rows * stride));
  AssembleDenseA(given, A_.data(), stride);
  is_whole_ = true;
  if (cfm_ == 0) return;
  Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>> diagonal(A_.data(), rows, Eigen::InnerStride<>(stride + 1));
  diagonal.array() += cfm_ * diagonal.cwiseAbs().maxCoeff();
}

void DantzigPeer::Run(Index rows, const double* b, const unsigned char* bilateral, const LcpOptions& options,
                      LcpResult* result) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const int n = static_cast<int>(rows);
  const int stride = code_.stride(n);
  const auto room = static_cast<std::size_t>(stride);
  DantzigProblem call;
  TimeConversion(options, result, [&] {
    is_whole_ = false;
    b_.resize(room);
    lower_.resize(room);
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      b_[i] = -b[i];
      lower_[i] = bilateral != nullptr && bilateral[i] != 0 ? -kInfinity : 0;
    }
    upper_.assign(room, kInfinity);
    x_.assign(room, 0);
    w_.assign(room, 0);
    findex_.assign(room, -1);
    call = {n, stride, A_.data(), x_.data(), b_.data(), w_.data(), lower_.data(), upper_.data(), findex_.data()};
    if (code_.before != nullptr) code_.before(call);
  });
  bool solved = false;
  TimeLibraryCall(options, result, [&] { solved = code_.call(call); });
  if (code_.after != nullptr) TimeConversion(options, result, [&] { code_.after(call); });
  result->f = Eigen::Map<const Eigen::VectorXd>(x_.data(), rows);
  result->status = solved ? LcpStatus::kSolved : LcpStatus::kNumericalFailure;
  if (!solved) result->detail = "the code returned failure";
}

void DantzigPeer::DoPrepare(const LcpProblem& problem) { Assemble(problem, problem.size()); }

void DantzigPeer::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  if (!is_whole_) TimeConversion(options, result, [&] { Assemble(problem, problem.size()); });
  Run(problem.size(), problem.b().data(), DataOf(problem.bounds().bilateral), options, result);
}

bool DantzigPeer::DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  Assemble(arrays, arrays.rows);
  Run(arrays.rows, arrays.b.data(), DataOf(arrays.bilateral), options, result);
  return true;
}

}  // namespace lcpbench
