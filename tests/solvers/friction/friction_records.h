#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "solvers/io/json_lines.h"

namespace lcpbench {

/// A record of tests/data/oracle/friction.jsonl or friction_counterexamples.jsonl: README.md there has the format.
struct FrictionRecord {
  std::string line;
  LcpRecord parsed;
  nlohmann::json json;

  const LcpProblem& problem() const { return parsed.problem; }
  bool is_solved() const { return json["status"] == "solved"; }
};

/// All 101 records, those of the oracle first.
const std::vector<FrictionRecord>& FrictionRecords();

/// Numbers and "p/q", each rounded once.
Eigen::VectorXd ToVector(const nlohmann::json& numbers);

/// Solutions of a solved record, rounded: f_exact, the vertices of its pieces, and those moved along a ray or line.
std::vector<Eigen::VectorXd> KnownSolutions(const FrictionRecord& record);

}  // namespace lcpbench
