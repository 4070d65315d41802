#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "solvers/exact/exact_lcp.h"
#include "solvers/exact/modes/mode_answer.h"

namespace lcpbench {

/// What is proved of a problem in rational numbers. The members that ExactAnswer or ModeAnswer have say the same.
struct Certificate {
  std::string status;      ///< solved, infeasible, unknown; of plain problems also as ToString(ExactAnswer::Status)
  bool certified = false;  ///< f and its modes, or the lack of any, are proved
  bool complete = false;   ///< all solutions are known of: all modes were tried; of plain problems where `certified`
  std::string fault;       ///< what a check of the answer from the definitions objects to; "" where it holds
  RationalVector f, w, ray;
  std::optional<bool> f_unique, w_unique;
  std::int64_t steps = 0;  ///< exact solves; modes that were tried, or steps of Lemke's path
  std::string detail;

  // For plain problems only.
  RationalVector f_least_norm;
  std::optional<Index> rank;
  bool rank_is_proved = false;
  Index nullity_on_active = 0;
  std::vector<Index> degenerate;

  // For problems with friction or bounded rows only.
  std::string modes;
  std::vector<ModePiece> pieces;
  Index components = 0;

  bool is_solved() const { return status == "solved"; }
};

struct CertifyOptions {
  ExactOptions plain;
  ModeOptions modes;
};

/// By SolveExactly a plain problem, by SolveByModes any other one; its answer is checked from the definitions.
Certificate Certify(const ExactLcp& problem, const CertifyOptions& options);

}  // namespace lcpbench
