#include "solvers/peers/dantzig_peer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/peers/given_matrix.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {

DantzigPeer::Options DantzigPeer::Options::FromSettings(std::string_view key, SettingsReader* reader) {
  const double cfm = reader->Number("cfm", key.ends_with("-cfm") ? kEngineCfm : 0, 0, 1);
  reader->Finish();
  return {cfm};
}

Index DantzigPeer::MakeRoom(Index rows) {
  const Index stride = code_.stride(static_cast<int>(rows));
  A_.resize(static_cast<std::size_t>(rows * stride));
  return stride;
}

void DantzigPeer::Shift(Index rows) {
  is_whole_ = true;
  if (options_.cfm == 0) return;
  const auto n = static_cast<std::size_t>(rows);
  const auto stride = static_cast<std::size_t>(code_.stride(static_cast<int>(rows)));
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(A_[i * stride + i]));
  for (std::size_t i = 0; i < n; ++i) A_[i * stride + i] += options_.cfm * largest;
}

void DantzigPeer::Assemble(const LcpProblem& problem) {
  const Index stride = MakeRoom(problem.size());
  WriteDenseRows(problem, stride, A_.data());
  Shift(problem.size());
}

template <typename Predicate>
void DantzigPeer::Run(Index rows, const double* b, Predicate is_bilateral, const LcpOptions& options,
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
      lower_[i] = is_bilateral(i) ? -kInfinity : 0;
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

void DantzigPeer::DoPrepare(const LcpProblem& problem) { Assemble(problem); }

void DantzigPeer::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  if (!is_whole_) TimeConversion(options, result, [&] { Assemble(problem); });
  const auto is_bilateral = [&](std::size_t row) { return problem.is_bilateral(static_cast<Index>(row)); };
  Run(problem.size(), problem.b().data(), is_bilateral, options, result);
}

bool DantzigPeer::DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  const Index stride = MakeRoom(arrays.rows);
  AssembleDenseA(arrays, A_.data(), stride);
  Shift(arrays.rows);
  const auto is_bilateral = [&](std::size_t row) { return !arrays.bilateral.empty() && arrays.bilateral[row] != 0; };
  Run(arrays.rows, arrays.b.data(), is_bilateral, options, result);
  return true;
}

}  // namespace lcpbench
