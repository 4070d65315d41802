#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "solvers/io/fclib_file.h"
#include "tests/fuzz/error_law.h"
#include "tests/fuzz/laws.h"
#include "tests/solvers/lcp/same_problem.h"

namespace lcpbench {
namespace {

// In memory where there is such a folder. Not memfd_create: libhdf5 wants a file with a name.
class TemporaryFile {
 public:
  TemporaryFile() {
    const std::filesystem::path memory = "/dev/shm";
    path_ = (std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path()) / "fclib-XXXXXX";
    descriptor_ = mkstemp(path_.data());
    if (descriptor_ < 0) throw std::runtime_error(path_ + ": " + std::strerror(errno));
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    close(descriptor_);
    std::remove(path_.c_str());
  }

  const std::string& path() const { return path_; }
  void Write(const std::string& bytes) const {
    for (std::size_t written = 0; written < bytes.size();) {
      const ssize_t count = write(descriptor_, bytes.data() + written, bytes.size() - written);
      if (count <= 0) throw std::runtime_error(path_ + ": " + std::strerror(errno));
      written += static_cast<std::size_t>(count);
    }
  }

 private:
  std::string path_;
  int descriptor_ = -1;
};

// Finite factors whose product is not are the one thing that is read and not written.
std::string BrokenOverflowLaw(const LcpProblem& problem, const std::string& path) {
  if (!problem.has_factors()) return "A is not finite";
  try {
    WriteFclibProblem(problem, path);
  } catch (const InputError&) {
    return "";
  }
  return "an overflow is written";
}

}  // namespace

std::string BrokenFclibLaw(const std::string& bytes) {
  const TemporaryFile given, written;
  given.Write(bytes);
  const auto broken = [&](const FclibOptions& options) {
    return BrokenReadingLaw(given.path() + ": ", [&](bool* is_read) -> std::string {
      const LcpProblem problem = ReadFclibProblem(given.path(), options).problem;
      *is_read = true;
      if (!problem.b().allFinite()) return "b is not finite";
      if (!problem.SparseA().coeffs().allFinite()) return BrokenOverflowLaw(problem, written.path());
      WriteFclibProblem(problem, written.path());
      const LcpProblem back = ReadFclibProblem(written.path()).problem;
      return back.id() == problem.id() ? DifferenceOfProblems(back, problem) : "another id";
    });
  };
  const std::string by_ranges = broken({});
  return by_ranges.empty() ? broken({FclibTriplets::kColumnsFirst, TangentRows::kNone}) : by_ranges;
}

}  // namespace lcpbench
