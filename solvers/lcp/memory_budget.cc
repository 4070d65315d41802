#include "solvers/lcp/memory_budget.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>
#include <optional>

namespace lcpbench {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr double kKibibyte = 1024;

// "Name:   123 kB" in /proc/meminfo and /proc/self/status.
std::optional<double> Field(const char* path, const std::string& name) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, name.size(), name) != 0 || line.size() <= name.size() || line[name.size()] != ':') continue;
    double kilobytes = 0;
    if (std::sscanf(line.c_str() + name.size() + 1, "%lf", &kilobytes) == 1) return kKibibyte * kilobytes;
  }
  return std::nullopt;
}

// A file of one number; none where it says "max".
std::optional<double> Number(const std::string& path) {
  std::ifstream file(path);
  double value = 0;
  if (file >> value) return value;
  return std::nullopt;
}

double OfMachine() { return Field("/proc/meminfo", "MemAvailable").value_or(kUnknown); }

double OfControlGroup() {
  std::ifstream groups("/proc/self/cgroup");
  double least = kUnknown;
  for (std::string line; std::getline(groups, line);) {
    if (line.rfind("0::", 0) != 0) continue;
    // A limit of any group on the way up holds.
    for (std::string group = line.substr(3); !group.empty(); group.erase(group.find_last_of('/'))) {
      const std::string folder = "/sys/fs/cgroup" + (group == "/" ? "" : group) + "/";
      const std::optional<double> most = Number(folder + "memory.max");
      const std::optional<double> present = Number(folder + "memory.current");
      if (most.has_value() && present.has_value()) least = std::min(least, *most - *present);
      if (group.find('/') == std::string::npos) break;
    }
  }
  return least;
}

double OfAddressSpace() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
  return static_cast<double>(limit.rlim_cur) - Field("/proc/self/status", "VmSize").value_or(0);
}

std::string Gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GB", bytes / 1e9);
  return text;
}

}  // namespace

double AvailableMemory() { return std::max(0.0, std::min({OfMachine(), OfControlGroup(), OfAddressSpace()})); }

void RequireMemory(double bytes, const std::string& what) {
  if (bytes <= kAlwaysAllowed) return;
  const double available = AvailableMemory();
  if (bytes <= available) return;
  throw MemoryRefusal(what + " needs " + Gigabytes(bytes) + ", " + Gigabytes(available) + " are available");
}

namespace {

void RequireMatrices(double bytes, const char* kind, std::int64_t n, int count) {
  if (count * bytes <= kAlwaysAllowed) return;  // small problems shall not pay for the words
  const std::string size = std::string(kind) + " " + std::to_string(n) + " x " + std::to_string(n);
  RequireMemory(count * bytes, count == 1 ? "a " + size + " matrix" : std::to_string(count) + " " + size + " matrices");
}

}  // namespace

void RequireDenseMatrices(std::int64_t n, int count) {
  RequireMatrices(static_cast<double>(n) * static_cast<double>(n) * sizeof(double), "dense", n, count);
}

void RequireSparseMatrices(std::int64_t n, double entries, int count) {
  RequireMatrices(entries * (sizeof(double) + sizeof(int)), "sparse", n, count);
}

}  // namespace lcpbench
