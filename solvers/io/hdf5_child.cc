#include "solvers/io/hdf5_child.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <string_view>

#include "solvers/io/hdf5_handle.h"

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

void SendAnswer(int pipe, Hdf5Answer answer) { Send(pipe, &answer, 1); }

void SendBytes(int pipe, Hdf5Answer answer, const void* data, std::uint64_t size) {
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
    SendAnswer(pipe, Hdf5Answer::kAbsent);
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
  SendBytes(pipe, Hdf5Answer::kPresent, values.data(), values.size());
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
void BecomeHarmless(int pipe, const Hdf5ChildLimits& limits) {
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
  Limit(RLIMIT_CPU, limits.time_s);
  if (kLimitsMemory) Limit(RLIMIT_AS, AddressSpaceInUse() + limits.memory);
}

}  // namespace

void RunHdf5Child(int pipe, const std::string& path, const std::vector<Hdf5Request>& requests, std::uint64_t file_size,
                  const Hdf5ChildLimits& limits) {
  BecomeHarmless(pipe, limits);
  try {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
    // The handle outlives this function's end: closing a malformed file is one more chance to crash.
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) throw Refusal{"expected an HDF5 file that libhdf5 can read, found one that it refuses"};
    Limit(RLIMIT_NOFILE, 0);
    for (const Hdf5Request& request : requests) SendDataset(pipe, file, request, file_size);
    SendAnswer(pipe, Hdf5Answer::kEnd);
  } catch (const Refusal& refusal) {
    SendBytes(pipe, Hdf5Answer::kRefused, refusal.message.data(), refusal.message.size());
  } catch (const std::bad_alloc&) {
    const std::string_view message = "expected a file for which there is memory, found a larger one";
    SendBytes(pipe, Hdf5Answer::kRefused, message.data(), message.size());
  }
  _exit(0);
}

}  // namespace lcpbench
