#include "solvers/peers/dantzig_peer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool IsPlain(const ProblemView& given) { return given.friction.empty() && given.bounded.empty(); }

std::string WhyNotTaken(const ProblemView& given) {
  const auto excludes = [](const BoundedRow& row) { return row.lower > 0 || row.upper < 0; };  // the codes start at 0
  return std::ranges::any_of(given.bounded, excludes) ? "bounds that exclude 0" : WhySliding(given.friction);
}

}  // namespace

std::string DantzigPeer::WhyUnsupported(const LcpProblem& problem) const { return WhyNotTaken(problem.view()); }

void DantzigPeer::Assemble(const ProblemView& given) {
  RequireDenseMatrices(given.rows, 2);  // and the code's own factor
  const Index stride = code_.stride(static_cast<int>(given.rows));
  A_.resize(static_cast<std::size_t>(given.rows * stride));
  AssembleDenseA(given, A_.data(), stride);
  is_whole_ = true;
  if (cfm_ == 0) return;
  Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>> diagonal(A_.data(), given.rows,
                                                                Eigen::InnerStride<>(stride + 1));
  diagonal.array() += cfm_ * diagonal.cwiseAbs().maxCoeff();
}

void DantzigPeer::SetBounds(const ProblemView& given) {
  for (const BoundedRow& row : given.bounded) {
    lower_[static_cast<std::size_t>(row.row)] = row.lower;
    upper_[static_cast<std::size_t>(row.row)] = row.upper;
  }
  for (const FrictionRow& row : given.friction) {
    lower_[static_cast<std::size_t>(row.row)] = -row.mu;
    upper_[static_cast<std::size_t>(row.row)] = row.mu;
    findex_[static_cast<std::size_t>(row.row)] = static_cast<int>(row.normal);
  }
}

void DantzigPeer::Run(const ProblemView& given, const LcpOptions& options, LcpResult* result) {
  const int n = static_cast<int>(given.rows);
  const int stride = code_.stride(n);
  const auto room = static_cast<std::size_t>(stride);
  DantzigProblem call;
  TimeConversion(options, result, [&] {
    is_whole_ = false;
    b_.resize(room);
    lower_.resize(room);
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      b_[i] = -given.b[i];
      lower_[i] = !given.bilateral.empty() && given.bilateral[i] != 0 ? -kInfinity : 0;
    }
    upper_.assign(room, kInfinity);
    x_.assign(room, 0);
    w_.assign(room, 0);
    findex_.assign(room, -1);
    if (!IsPlain(given)) SetBounds(given);
    call = {n,         stride,        A_.data(),     x_.data(),      b_.data(),
            w_.data(), lower_.data(), upper_.data(), findex_.data(), !given.friction.empty()};
    if (code_.before != nullptr) code_.before(call);
  });
  bool solved = false;
  TimeLibraryCall(options, result, [&] { solved = code_.call(call); });
  if (code_.after != nullptr) TimeConversion(options, result, [&] { code_.after(call); });
  result->f = Eigen::Map<const Eigen::VectorXd>(x_.data(), given.rows);
  result->status = solved ? LcpStatus::kSolved : LcpStatus::kNumericalFailure;
  if (!solved) result->detail = "the code returned failure";
  if (solved && call.has_friction) TakeBounds(given, result);
}

// Where the code has permuted findex and the bounds, the friction rows of a normal row stand in an unknown order; but
// the larger mu is, the larger is the bound.
void DantzigPeer::TakeBounds(const ProblemView& given, LcpResult* result) const {
  std::vector<std::pair<Index, double>> found;
  for (std::size_t i = 0; i < static_cast<std::size_t>(given.rows); ++i) {
    if (findex_[i] >= 0) found.emplace_back(findex_[i], upper_[i]);
  }
  std::vector<std::tuple<Index, double, Index>> rows;
  for (const FrictionRow& row : given.friction) rows.emplace_back(row.normal, row.mu, row.row);
  std::ranges::sort(found);
  std::ranges::sort(rows);
  result->model = FrictionModel::kFrozenBounds;
  result->friction_bounds.setZero(given.rows);
  for (std::size_t k = 0; k < rows.size(); ++k) result->friction_bounds[std::get<2>(rows[k])] = found[k].second;
}

void DantzigPeer::DoPrepare(const LcpProblem& problem) { Assemble(problem.view()); }

void DantzigPeer::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  if (!is_whole_) TimeConversion(options, result, [&] { Assemble(problem.view()); });
  Run(problem.view(), options, result);
}

bool DantzigPeer::DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  const ProblemView given = arrays;
  if (!IsPlain(given) && !WhyNotTaken(given).empty()) return false;  // Solve says so
  Assemble(given);
  Run(given, options, result);
  return true;
}

}  // namespace lcpbench
