#pragma once

#include <string>
#include <vector>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A problem on its way from a scene to the collection: the bodies, and rows that have a geometry each. Rows that were
/// added by a change stand last and have that of the row they were made from.
struct Instance {
  ContactSystem system;
  std::vector<RowInfo> rows;
  LcpProblem problem;
};

/// @throws InputError as AssembleContactLcp
Instance InstanceOf(ContactSystem system);

/// The same problem, given by factors, under another name.
LcpProblem WithId(const LcpProblem& given, std::string id);

}  // namespace lcpbench
