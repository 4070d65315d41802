#pragma once

#include <vector>

#include "tests/solvers/test_problems.h"

namespace lcpbench {

/// One problem of independent parts given by factors, its rows shuffled by `seed`.
LcpProblem Compose(const std::vector<LcpProblem>& parts, unsigned seed);

}  // namespace lcpbench
