#include "solvers/lcp/hdf5_reader.h"

#include <fcntl.h>
#include <hdf5.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "solvers/lcp/hdf5_handle.h"
#include "solvers/lcp/input_error.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define LCPBENCH_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LCPBENCH_SANITIZED
#endif

namespace lcpbench {
namespace {

// Sanitizers reserve more address space than any limit.
#ifdef LCPBENCH_SANITIZED
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

// What the child may use beyond what it is born with.
constexpr std::uint64_t kLeastMemory = 64 << 20;  // bytes
constexpr std::uint64_t kMemoryPerByte = 4;
constexpr std::uint64_t kLeastTime = 5;              // s
constexpr std::uint64_t kBytesPerSecond = 20 << 20;  // and slower is hardly any disk
constexpr std::uint64_t kWaitPerTime = 4;            // the machine may have other things to do

// What the child sends for every request, in their order; then kEnd.
enum class Answer : unsigned char { kAbsent, kPresent, kRefused, kEnd };

// ---- the child ----

// What the child found wrong; the message without the file's name.
struct Refusal {
  std::string message;
};

void Send(int pipe, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  while (size > 0) {
    const ssize_t written = write(pipe, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(1);
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

void SendAnswer(int pipe, Answer answer) { Send(pipe, &answer, 1); }

void SendBytes(int pipe, Answer answer, const void* data, std::uint64_t size) {
  SendAnswer(pipe, answer);
  Send(pipe, &size, sizeof size);
  Send(pipe, data, size);
}

const char* NameOf(Hdf5Kind kind) {
  switch (kind) {
    case Hdf5Kind::kIntegers:
      return "32-bit integers";
    case Hdf5Kind::kReals:
      return "64-bit IEEE numbers";
    default:
      return "a text of fixed length";
  }
}

bool IsOfKind(hid_t type, Hdf5Kind kind) {
  switch (kind) {
    case Hdf5Kind::kIntegers:
      return H5Tequal(type, H5T_STD_I32LE) > 0 || H5Tequal(type, H5T_STD_I32BE) > 0;
    case Hdf5Kind::kReals:
      return H5Tequal(type, H5T_IEEE_F64LE) > 0 || H5Tequal(type, H5T_IEEE_F64BE) > 0;
    default:
      return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
  }
}

// Whether there is such an object; only hard links lead to it.
bool Exists(hid_t file, const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    const htri_t exists = H5Lexists(file, part.c_str(), H5P_DEFAULT);
    if (exists < 0) throw Refusal{part + ": expected a link that libhdf5 can read, found what it cannot"};
    if (exists == 0) return false;
    H5L_info_t link{};
    if (H5Lget_info(file, part.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
      throw Refusal{part + ": expected a hard link, found another"};
    }
    if (end == std::string::npos) return true;
    H5O_info_t object{};
    if (H5Oget_info_by_name2(file, part.c_str(), &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
      throw Refusal{part + ": expected a group, found what libhdf5 cannot read"};
    }
    if (object.type != H5O_TYPE_GROUP) throw Refusal{part + ": expected a group, found another object"};
  }
}

// Before the dataspace is asked for: that of a virtual dataset opens other files.
void RequireStoredHere(hid_t dataset, const std::string& path) {
  const Hdf5Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (!properties) throw Refusal{path + ": expected properties that libhdf5 can read, found others"};
  const H5D_layout_t layout = H5Pget_layout(properties.id());
  if ((layout != H5D_CONTIGUOUS && layout != H5D_COMPACT) || H5Pget_nfilters(properties.id()) != 0) {
    throw Refusal{path +
                  ": expected values in one piece as fclib writes them, found chunks, filters or other datasets"};
  }
  if (H5Pget_external_count(properties.id()) != 0) {
    throw Refusal{path + ": expected values in the file itself, found names of other files"};
  }
}

// The number of values, which the file really holds.
std::uint64_t CountOf(hid_t dataset, std::size_t value_size, std::uint64_t file_size, const std::string& path) {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  constexpr int kMostRank = 1;
  const int rank = space ? H5Sget_simple_extent_ndims(space.id()) : -1;
  if (rank < 0 || rank > kMostRank || H5Sget_simple_extent_type(space.id()) == H5S_NULL) {
    throw Refusal{path + ": expected a list, found a dataset of rank " + std::to_string(rank)};
  }
  const hssize_t points = H5Sget_simple_extent_npoints(space.id());
  const std::uint64_t stored = H5Dget_storage_size(dataset);
  const auto count = static_cast<std::uint64_t>(std::max<hssize_t>(points, 0));
  if (points < 0 || count > file_size / value_size || stored != count * value_size) {
    throw Refusal{path + ": expected as many values as the file holds, " + std::to_string(stored) + " bytes of " +
                  std::to_string(file_size) + ", found " + std::to_string(points) + " promised"};
  }
  return count;
}

void SendDataset(int pipe, hid_t file, const Hdf5Request& request, std::uint64_t file_size) {
  const std::string& path = request.path;
  if (!Exists(file, path)) {
    SendAnswer(pipe, Answer::kAbsent);
    return;
  }
  const std::string expected = path + ": expected a dataset of " + NameOf(request.kind);
  H5O_info_t object{};
  if (H5Oget_info_by_name2(file, path.c_str(), &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
    throw Refusal{expected + ", found what libhdf5 cannot read"};
  }
  if (object.type != H5O_TYPE_DATASET) throw Refusal{expected + ", found another object"};
  const Hdf5Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset) throw Refusal{expected + ", found one that libhdf5 cannot open"};
  RequireStoredHere(dataset.id(), path);
  const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
  if (!type || !IsOfKind(type.id(), request.kind)) throw Refusal{expected + ", found another type"};
  const std::size_t value_size = H5Tget_size(type.id());
  if (value_size == 0) throw Refusal{expected + ", found values of no size"};
  const std::uint64_t count = CountOf(dataset.id(), value_size, file_size, path);
  if (request.kind == Hdf5Kind::kText && count != 1) {
    throw Refusal{expected + ", found " + std::to_string(count) + " texts"};
  }
  const bool integers = request.kind == Hdf5Kind::kIntegers;
  const hid_t memory_type = request.kind == Hdf5Kind::kText ? type.id() : integers ? H5T_NATIVE_INT : H5T_NATIVE_DOUBLE;
  std::vector<unsigned char> values(count * value_size);
  if (count > 0 && H5Dread(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw Refusal{expected + ", found values that libhdf5 cannot read"};
  }
  SendBytes(pipe, Answer::kPresent, values.data(), values.size());
}

void Limit(decltype(RLIMIT_AS) resource, std::uint64_t value) {
  const rlimit limit{value, value};
  setrlimit(resource, &limit);
}

// The child's own: libraries' fork handlers may have changed it.
std::uint64_t AddressSpaceInUse() {
  std::array<char, 32> text{};
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t count = read(file, text.data(), text.size() - 1);
  close(file);
  if (count <= 0) _exit(1);
  return std::strtoull(text.data(), nullptr, 10) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

// A crash is to be the child's alone: no handlers, no core file, nothing on standard error.
void BecomeHarmless(int pipe, std::uint64_t memory, std::uint64_t time_s) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (int number = 1; number < NSIG; ++number) std::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (stream != pipe) dup2(nowhere, stream);
  }
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_FSIZE, 0);
  Limit(RLIMIT_CPU, time_s);
  if (kLimitsMemory) Limit(RLIMIT_AS, AddressSpaceInUse() + memory);
}

[[noreturn]] void RunChild(int pipe, const std::string& path, const std::vector<Hdf5Request>& requests,
                           std::uint64_t file_size) {
  try {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
    // The handle outlives this function's end: closing a malformed file is one more chance to crash.
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) throw Refusal{"expected an HDF5 file that libhdf5 can read, found one that it refuses"};
    Limit(RLIMIT_NOFILE, 0);
    for (const Hdf5Request& request : requests) SendDataset(pipe, file, request, file_size);
    SendAnswer(pipe, Answer::kEnd);
  } catch (const Refusal& refusal) {
    SendBytes(pipe, Answer::kRefused, refusal.message.data(), refusal.message.size());
  } catch (const std::bad_alloc&) {
    const std::string_view message = "expected a file for which there is memory, found a larger one";
    SendBytes(pipe, Answer::kRefused, message.data(), message.size());
  }
  _exit(0);
}

// ---- the parent ----

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
    Answer answer{};
    if (!pipe->Fill(reinterpret_cast<char*>(&answer), 1)) return false;
    if (answer == Answer::kEnd) return k == requests.size();
    if (k == requests.size() && answer != Answer::kRefused) return false;
    if (answer == Answer::kAbsent) continue;
    std::uint64_t size = 0;
    if (!pipe->Fill(reinterpret_cast<char*>(&size), sizeof size)) return false;
    constexpr std::uint64_t kLongestMessage = 1000;
    if (size > (answer == Answer::kRefused ? kLongestMessage : file_size)) return false;
    if (answer == Answer::kRefused) {
      const auto text = pipe->Values<char>(size);
      if (!text) return false;
      throw InputError(path + ": " + std::string(text->begin(), text->end()));
    }
    if (answer != Answer::kPresent) return false;
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
  const std::uint64_t memory = kLeastMemory + kMemoryPerByte * file_size;
  const std::uint64_t time_s = kLeastTime + file_size / kBytesPerSecond;
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
    BecomeHarmless(ends[1], memory, time_s);
    RunChild(ends[1], path, requests, file_size);
  }
  close(ends[1]);
  Child child(pid, ends[0]);
  Pipe pipe(ends[0], Clock::now() + std::chrono::seconds(kWaitPerTime * time_s));
  std::map<std::string, Hdf5Dataset> datasets;
  if (Receive(&pipe, path, requests, file_size, &datasets)) return datasets;
  throw InputError(path + ": expected an HDF5 file that libhdf5 can read, found one on which it " +
                   HowItEnded(pipe.timed_out(), child.End()));
}

}  // namespace lcpbench
