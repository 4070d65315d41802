#include "solvers/exact/modes/enumeration.h"

#include <algorithm>
#include <string>
#include <utility>

#include "solvers/exact/modes/mode_search.h"

namespace lcpbench {
namespace {

// A row with w < 0 whatever f >= 0; -1 where there is none.
Index HopelessRow(const LcpProblem& problem) {
  if (!problem.bilateral_rows().empty()) return -1;
  for (Index i = 0; i < problem.size(); ++i) {
    bool has_positive = false;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) has_positive = has_positive || it.value() > 0;
    if (problem.b()[i] < 0 && !has_positive) return i;
  }
  return -1;
}

}  // namespace

std::optional<std::vector<Rational>> GapsOfAnswer(const LcpProblem& problem, const std::vector<Rational>& f) {
  std::vector<Rational> w(At(problem.size()));
  for (Index i = 0; i < problem.size(); ++i) {
    Rational& gap = w[At(i)];
    gap = problem.b()[i];
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
      if (f[At(it.col())] != 0) gap += Rational(it.value()) * f[At(it.col())];
    }
    const bool solves = problem.is_bilateral(i) ? gap == 0 : gap >= 0 && f[At(i)] >= 0 && (gap == 0 || f[At(i)] == 0);
    if (!solves) return std::nullopt;
  }
  return w;
}

ModeAnswer SolveByEnumeration(const LcpProblem& problem, const std::vector<Eigen::VectorXd>& guesses) {
  using Status = LcpReference::Status;
  ModeAnswer answer;
  answer.detail = "no answer was guessed";
  if (const Index row = HopelessRow(problem); row >= 0) {
    answer.status = Status::kInfeasible;
    answer.detail = "w < 0 on row " + std::to_string(row) + " whatever f >= 0";
    return answer;
  }
  if (problem.size() > kMostGuessedRows) return answer;
  const ExactLcp exact = ExactFromAny(problem);
  for (const Eigen::VectorXd& guess : guesses) {
    if (guess.size() != problem.size() || !guess.allFinite()) continue;
    const auto modes = [&] { return std::vector{ModesOf(problem, guess)}; };
    ModeAnswer guessed = SolveByModes(exact, {.most_modes = 0, .guesses = modes, .follows_path = false});
    if (guessed.status != Status::kSolved) continue;
    if (answer.status != Status::kSolved) {
      answer = std::move(guessed);
    } else if (guessed.f != answer.f) {
      answer.f_unique = false;
    }
  }
  ModeAnswer all = SolveByModes(exact, {.follows_path = false});
  if (!all.complete) return answer;
  if (answer.status == Status::kSolved) {
    all.f = std::move(answer.f);
    all.w = std::move(answer.w);
    all.modes = std::move(answer.modes);
  }
  if (all.status == Status::kInfeasible) all.detail = "by enumeration of all active sets";
  return all;
}

}  // namespace lcpbench
