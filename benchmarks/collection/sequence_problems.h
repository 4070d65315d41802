#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/collection/manifest.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A problem of a sequence, as it is met.
struct SequenceProblem {
  const LcpProblem& problem;
  /// For each row the index of the same row in the problem before, or -1: it was not there. Rows are the same by
  /// RowMatching in a motion, and by the engine's own names of contacts and rows in a recording.
  const std::vector<int>& previous;
  const LcpResult* result;  ///< the answer that drives a motion; null of a recording, which the engine drove
};

/// Makes a sequence's problems, in order, the same bits on every machine.
/// @param folder  of the manifest
/// @return "" or why a motion ended before its time
/// @throws InputError as ForEachSequenceProblem and RecordingReader, and where a recording lacks a step or a step has
/// no row or more than kMostSequenceRows
std::string ForEachProblemOf(const SequenceEntry& entry, const std::string& folder,
                             const std::function<void(const SequenceProblem& met)>& handle);

}  // namespace lcpbench
