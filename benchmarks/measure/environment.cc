#include "benchmarks/measure/environment.h"

#include <sys/utsname.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <cpuid.h>
#endif

#include <boost/version.hpp>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "build_info.h"
#include "git_revision.h"
#include "solvers/library_versions.h"
#include "solvers/linear_algebra/library_threads.h"

namespace lcpbench {
namespace {

// The value after `separator` on the first line that starts with `key`.
std::string FirstValue(const char* path, const std::string& key, char separator) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const auto at = line.find(separator);
    if (at == std::string::npos) continue;
    const auto first = line.find_first_not_of(" \t\"", at + 1);
    const auto last = line.find_last_not_of(" \t\"");
    if (first == std::string::npos || last < first) continue;
    return line.substr(first, last - first + 1);
  }
  return "unknown";
}

// Of the flags that the kernel lists, those that decide how fast dense loops are.
std::string InstructionSets() {
  std::istringstream flags(FirstValue("/proc/cpuinfo", "flags", ':'));
  std::string found;
  for (std::string flag; flags >> flag;) {
    const bool is_vector = flag.starts_with("sse") || flag.starts_with("ssse") || flag.starts_with("avx") ||
                           flag == "fma" || flag == "bmi2";
    if (is_vector) found += (found.empty() ? "" : " ") + flag;
  }
  return found.empty() ? "unknown" : found;
}

std::string Kernel() {
  utsname names{};
  return uname(&names) == 0 ? std::string(names.sysname) + " " + names.release : "unknown";
}

// CPUID leaf 1 says whether there is one, leaf 0x40000000 who.
std::string Hypervisor() {
#if defined(__x86_64__)
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  constexpr unsigned kIsGuest = 1U << 31U;
  if (__get_cpuid(1, &a, &b, &c, &d) == 0 || (c & kIsGuest) == 0) return "none";
  constexpr unsigned kVendorLeaf = 0x40000000U;
  __cpuid(kVendorLeaf, a, b, c, d);
  char vendor[13] = {};
  std::memcpy(vendor, &b, 4);
  std::memcpy(vendor + 4, &c, 4);
  std::memcpy(vendor + 8, &d, 4);
  return vendor[0] == 0 ? "unnamed" : vendor;
#else
  return "unknown";
#endif
}

}  // namespace

Environment DescribeEnvironment() {
  Environment environment;
  environment.version = kVersion;
  environment.git_commit = kGitCommit;
  environment.git_dirty = kGitDirty;
  environment.compiler = kCompiler;
  environment.flags = kFlags;
  environment.solver_flags = kSolverFlags;
  environment.build_type = kBuildType;
  environment.cpu = FirstValue("/proc/cpuinfo", "model name", ':');
  environment.instruction_sets = InstructionSets();
  environment.kernel = Kernel();
  environment.hypervisor = Hypervisor();
  environment.cores = static_cast<int>(std::thread::hardware_concurrency());
  environment.memory_bytes = static_cast<long long>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGE_SIZE);
  environment.os = FirstValue("/etc/os-release", "PRETTY_NAME", '=');
  environment.library_threads = LimitLibraryThreads(1);
  environment.libraries = LibraryVersions();
  environment.libraries.emplace_back("nlohmann-json", std::to_string(NLOHMANN_JSON_VERSION_MAJOR) + "." +
                                                          std::to_string(NLOHMANN_JSON_VERSION_MINOR) + "." +
                                                          std::to_string(NLOHMANN_JSON_VERSION_PATCH));
  environment.libraries.emplace_back("Boost", std::to_string(BOOST_VERSION / 100000) + "." +
                                                  std::to_string(BOOST_VERSION / 100 % 1000) + "." +
                                                  std::to_string(BOOST_VERSION % 100));
  return environment;
}

nlohmann::ordered_json ToJson(const Environment& environment) {
  nlohmann::ordered_json json;
  json["version"] = environment.version;
  json["git_commit"] = environment.git_commit;
  json["git_dirty"] = environment.git_dirty;
  json["compiler"] = environment.compiler;
  json["flags"] = environment.flags;
  json["solver_flags"] = environment.solver_flags;
  json["build_type"] = environment.build_type;
  json["cpu"] = environment.cpu;
  json["instruction_sets"] = environment.instruction_sets;
  json["kernel"] = environment.kernel;
  json["hypervisor"] = environment.hypervisor;
  json["cores"] = environment.cores;
  json["memory_bytes"] = environment.memory_bytes;
  json["os"] = environment.os;
  json["library_threads"] = environment.library_threads;
  json["libraries"] = nlohmann::ordered_json::object();
  for (const auto& [name, version] : environment.libraries) json["libraries"][name] = version;
  return json;
}

}  // namespace lcpbench
