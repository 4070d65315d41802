#pragma once

#include <map>
#include <optional>
#include <string>

#include "benchmarks/collection/manifest.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A known answer of the collection.
struct KnownAnswer {
  /// With the rounding floor of f: that of an answer proved before any campaign, in which no judged solver has a say.
  LcpReference reference;
  Eigen::VectorXd f;  ///< also where it is not unique; empty of problems without a solution
};

/// The answers of a manifest's file of references. Numbers are parsed when they are wanted.
class References {
 public:
  /// @throws InputError where the file cannot be read
  References(const Manifest& manifest, const std::string& folder);

  /// Nothing where the file has no answer. @throws InputError for a line that is no answer to this problem
  std::optional<KnownAnswer> Find(const LcpProblem& problem) const;

  /// The file's line, "" where it has none.
  std::string Line(const std::string& id) const;

 private:
  std::string name_;
  std::map<std::string, std::string> lines_;  // by id
};

}  // namespace lcpbench
