#include "solvers/io/hdf5_reader.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "solvers/io/hdf5_child.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// What the child may use.
constexpr std::uint64_t kLeastMemory = 64 << 20;  // bytes
constexpr std::uint64_t kMemoryPerByte = 4;
constexpr std::uint64_t kLeastTime = 5;              // s
constexpr std::uint64_t kBytesPerSecond = 20 << 20;  // and slower is hardly any disk
constexpr std::uint64_t kWaitPerTime = 4;            // the machine may have other things to do

using Clock = std::chrono::steady_clock;

// Reads from the child until it has ended, or its time is up.
class Pipe {
 public:
  Pipe(int end, Clock::time_point deadline) : end_(end), deadline_(deadline) {}

  /// `size` bytes, or nothing. Memory grows with what comes.
  template <typename T>
  std::optional<std::vector<T>> Values(std::uint64_t size) {
    std::vector<T> values;
    constexpr std::uint64_t kChunk = std::uint64_t{1} << 20;
    if (size % sizeof(T) != 0) return std::nullopt;
    for (std::uint64_t read = 0; read < size;) {
      const std::uint64_t more = std::min(kChunk, size - read);
      values.resize((read + more) / sizeof(T));
      if (!Fill(reinterpret_cast<char*>(values.data()) + read, more)) return std::nullopt;
      read += more;
    }
    return values;
  }

  bool Fill(char* data, std::uint64_t size) {
    while (size > 0) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline_ - Clock::now());
      pollfd waiting{end_, POLLIN, 0};
      const int ready = poll(&waiting, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, kLongestWait)));
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0 && left.count() > kLongestWait) continue;
      if (ready <= 0) {
        timed_out_ = true;
        return false;
      }
      const ssize_t count = read(end_, data, size);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      data += count;
      size -= static_cast<std::uint64_t>(count);
    }
    return true;
  }

  bool timed_out() const { return timed_out_; }

 private:
  static constexpr std::int64_t kLongestWait = 1'000'000;  // ms

  int end_;
  Clock::time_point deadline_;
  bool timed_out_ = false;
};

std::uint64_t SizeOf(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) throw InputError(path + ": cannot be opened");
  if (!S_ISREG(status.st_mode)) throw InputError(path + ": expected an HDF5 file, found what is no file");
  if (access(path.c_str(), R_OK) != 0) throw InputError(path + ": cannot be opened");
  return static_cast<std::uint64_t>(status.st_size);
}

// The child is not believed either.
bool Receive(Pipe* pipe, const std::string& path, const std::vector<Hdf5Request>& requests, std::uint64_t file_size,
             std::map<std::string, Hdf5Dataset>* datasets) {
  std::uint64_t total = 0;
  for (std::size_t k = 0;; ++k) {
    Hdf5Answer answer{};
    if (!pipe->Fill(reinterpret_cast<char*>(&answer), 1)) return false;
    if (answer == Hdf5Answer::kEnd) return k == requests.size();
    if (k == requests.size() && answer != Hdf5Answer::kRefused) return false;
    if (answer == Hdf5Answer::kAbsent) continue;
    std::uint64_t size = 0;
    if (!pipe->Fill(reinterpret_cast<char*>(&size), sizeof size)) return false;
    constexpr std::uint64_t kLongestMessage = 1000;
    if (size > (answer == Hdf5Answer::kRefused ? kLongestMessage : file_size)) return false;
    if (answer == Hdf5Answer::kRefused) {
      const auto text = pipe->Values<char>(size);
      if (!text) return false;
      throw InputError(path + ": " + std::string(text->begin(), text->end()));
    }
    if (answer != Hdf5Answer::kPresent) return false;
    total += size;
    if (total > file_size) {
      throw InputError(path + ": " + requests[k].path +
                       ": expected values of its own, found some that are others' too");
    }
    Hdf5Dataset dataset;
    bool complete = false;
    if (requests[k].kind == Hdf5Kind::kIntegers) {
      auto values = pipe->Values<int>(size);
      complete = values.has_value();
      if (complete) dataset.integers = std::move(*values);
    } else if (requests[k].kind == Hdf5Kind::kReals) {
      auto values = pipe->Values<double>(size);
      complete = values.has_value();
      if (complete) dataset.reals = std::move(*values);
    } else {
      const auto values = pipe->Values<char>(size);
      complete = values.has_value();
      if (complete) dataset.text.assign(values->begin(), std::find(values->begin(), values->end(), '\0'));
    }
    if (!complete) return false;
    datasets->emplace(requests[k].path, std::move(dataset));
  }
}

std::string HowItEnded(bool timed_out, int status) {
  if (timed_out) return "did not end in time";
  if (WIFSIGNALED(status)) {
    return "ended by signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
  }
  return "ended early";
}

// Closes the pipe and buries the child, also where an error passes.
class Child {
 public:
  Child(pid_t pid, int pipe) : pid_(pid), pipe_(pipe) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { End(); }

  /// @return as waitpid gives it; 0 where the program leaves its children to the system
  int End() {
    if (pid_ < 0) return 0;
    close(pipe_);
    kill(pid_, SIGKILL);
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_;
  int pipe_;
};

}  // namespace

std::map<std::string, Hdf5Dataset> ReadHdf5(const std::string& path, const std::vector<Hdf5Request>& requests) {
  const std::uint64_t file_size = SizeOf(path);
  const Hdf5ChildLimits limits{kLeastMemory + kMemoryPerByte * file_size, kLeastTime + file_size / kBytesPerSecond};
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw InputError(path + ": no pipe for a child: " + std::strerror(errno));
  const pid_t pid = fork();
  if (pid < 0) {
    const std::string why = std::strerror(errno);
    close(ends[0]);
    close(ends[1]);
    throw InputError(path + ": no child process to read it: " + why);
  }
  if (pid == 0) {
    close(ends[0]);
    RunHdf5Child(ends[1], path, requests, file_size, limits);
  }
  close(ends[1]);
  Child child(pid, ends[0]);
  Pipe pipe(ends[0], Clock::now() + std::chrono::seconds(kWaitPerTime * limits.time_s));
  std::map<std::string, Hdf5Dataset> datasets;
  if (Receive(&pipe, path, requests, file_size, &datasets)) return datasets;
  throw InputError(path + ": expected an HDF5 file that libhdf5 can read, found one on which it " +
                   HowItEnded(pipe.timed_out(), child.End()));
}

}  // namespace lcpbench
