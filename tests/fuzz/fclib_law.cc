#include "tests/fuzz/fclib_law.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "solvers/lcp/fclib_file.h"
#include "solvers/lcp/input_error.h"
#include "tests/fuzz/error_law.h"
#include "tests/lcp/same_problem.h"

namespace lcpbench {
namespace {

// A file in memory, also for child processes.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("fclib", 0)) {
    if (descriptor_ < 0) throw std::runtime_error(std::string("memfd_create: ") + std::strerror(errno));
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor_); }

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  void Write(const std::string& bytes) const {
    for (std::size_t written = 0; written < bytes.size();) {
      const ssize_t count = write(descriptor_, bytes.data() + written, bytes.size() - written);
      if (count <= 0) throw std::runtime_error(std::string("write: ") + std::strerror(errno));
      written += static_cast<std::size_t>(count);
    }
  }

 private:
  int descriptor_;
};

}  // namespace

std::string BrokenFclibLaw(const std::string& bytes) {
  const MemoryFile given, written;
  given.Write(bytes);
  bool is_read = false;
  try {
    const LcpProblem problem = ReadFclibProblem(given.path()).problem;
    is_read = true;
    if (!problem.b().allFinite()) return "b is not finite";
    WriteFclibProblem(problem, written.path());
    const LcpProblem back = ReadFclibProblem(written.path()).problem;
    return back.id() == problem.id() ? DifferenceOfProblems(back, problem) : "another id";
  } catch (const InputError& error) {
    if (is_read) return std::string("what was read is not written, or refused: ") + error.what();
    return BrokenErrorLaw(error.what(), given.path() + ": ");
  }
}

}  // namespace lcpbench
