#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "benchmarks/collection/manifest.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

// A sequence's problems as a file, so that driving the motion by exact arithmetic is paid once per campaign: JSON lines
// compressed by gzip, one per problem. A line is FormatLcpRecord, with `status` and `w` where the exact answer is
// known, and besides
//   previous  for each row the index of the same row in the line before, or -1: it was not there
//   floor     the problem's rounding floor (verify.h): of the exact answer, or the least of FindReferenceFloor;
//             null where there is none

struct SequenceStep {
  LcpProblem problem;
  std::vector<int> previous;  ///< by row, as above; all -1 in the first step
  LcpReference reference;     ///< w and floor, as far as they are known
};

/// FOLDER/sequences/ID.jsonl.gz
std::string SequencePath(const std::string& folder, const std::string& id);

/// Makes the sequence and writes it, as WriteGzipFile.
/// @param folder  of its manifest
/// @throws InputError where the problems are not those of the manifest (SHA-256), and as WriteGzipFile; Interrupted
/// (progress.h) after a signal
void WriteSequenceFile(const SequenceEntry& entry, const std::string& folder, const std::string& path);

/// @param sha256  SequenceHash of the problems
/// Writes given steps as such a file; of the references `status`, `w` and `floor`.
/// @return SequenceHash of the problems
/// @throws as WriteGzipFile
std::string WriteSequenceSteps(const std::vector<SequenceStep>& steps, const std::string& path);

/// @throws InputError naming the file and what it should be, also where the hash is another
std::vector<SequenceStep> ReadSequenceFile(const std::string& path, const std::string& sha256);

/// @throws InputError unless `previous` has a row of the line before, or -1, for every row
void RequirePrevious(const std::vector<int>& previous, Index rows, std::size_t rows_before, const std::string& where);

/// Whether the file is there and has the sequence; where it is there and has not, one line on standard error says so.
bool IsSequenceFile(const std::string& path, const std::string& sha256);

/// Forces on the rows of a step from those of the step before: rows that were not there start at 0.
/// @param previous  SequenceStep::previous, indices < f.size() or -1
Eigen::VectorXd CarryOver(const Eigen::VectorXd& f, const std::vector<int>& previous);

}  // namespace lcpbench
