#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace lcpbench {

/// What a result was measured with.
struct Environment {
  std::string version;
  std::string git_commit;
  bool git_dirty = false;
  std::string compiler;
  std::string flags;         ///< of all our code
  std::string solver_flags;  ///< added in solvers/
  std::string build_type;
  std::string cpu;
  std::string instruction_sets;  ///< vector extensions of the processor, divided by spaces
  std::string kernel;            ///< name and release
  std::string hypervisor;        ///< vendor, as the processor names it; "none" on bare metal
  int cores = 0;
  long long memory_bytes = 0;
  std::string os;
  int library_threads = 0;  ///< of BLAS and OpenMP
  std::vector<std::pair<std::string, std::string>> libraries;
};

Environment DescribeEnvironment();

/// The members of result files (RESULTS.md), in the order above.
nlohmann::ordered_json ToJson(const Environment& environment);

}  // namespace lcpbench
