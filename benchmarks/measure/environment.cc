#include "benchmarks/measure/environment.h"

#include <sys/utsname.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <cpuid.h>
#endif

#include <boost/version.hpp>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "build_info.h"
#include "git_revision.h"
#include "solvers/library_versions.h"
#include "solvers/linear_algebra/loaded_blas.h"

namespace lcpbench {
namespace {

// The value after `separator` on the first line that starts with `key`.
std::string FirstValue(const char* path, const std::string& key, char separator) {
  std::ifstream file(path);
  file.exceptions(std::ios::badbit);  // else what cannot be read would be another environment
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

// The flags in the kernel's list that decide how fast dense loops are.
std::string InstructionSets() {
  std::istringstream flags(FirstValue("/proc/cpuinfo", "flags", ':'));
  flags.exceptions(std::ios::badbit);  // else the list would end where memory does
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

std::string Version(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
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

nlohmann::ordered_json DescribeEnvironment() {
  nlohmann::ordered_json libraries = nlohmann::ordered_json::object();
  for (const auto& [name, version] : LibraryVersions()) libraries[name] = version;
  libraries["nlohmann-json"] =
      Version(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH);
  libraries["Boost"] = Version(BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100);
  nlohmann::ordered_json json;
  json["version"] = kVersion;
  json["git_commit"] = kGitCommit;
  json["git_dirty"] = kGitDirty;
  json["compiler"] = kCompiler;
  json["flags"] = kFlags;               // of all our code
  json["solver_flags"] = kSolverFlags;  // added in solvers/
  json["build_type"] = kBuildType;
  json["cpu"] = FirstValue("/proc/cpuinfo", "model name", ':');
  json["instruction_sets"] = InstructionSets();
  json["kernel"] = Kernel();
  json["hypervisor"] = Hypervisor();
  json["cores"] = static_cast<int>(std::thread::hardware_concurrency());
  json["memory_bytes"] = static_cast<long long>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGE_SIZE);
  json["os"] = FirstValue("/etc/os-release", "PRETTY_NAME", '=');
  json["library_threads"] = LimitLibraryThreads(1);  // of BLAS and OpenMP
  json["libraries"] = std::move(libraries);
  return json;
}

}  // namespace lcpbench
