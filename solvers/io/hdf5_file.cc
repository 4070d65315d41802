#include "solvers/io/hdf5_file.h"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>

#include "support/clock.h"
#include "support/input_error.h"
#include "support/printable.h"
#include "support/subprocess.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

// Closes what libhdf5 opened. Negative numbers are its failures.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }

  explicit operator bool() const { return id_ >= 0; }
  hid_t id() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// What the child may use, of a file of so many bytes.
std::uint64_t MemoryLimit(std::uint64_t file_size) {  // bytes beyond what it is born with
  constexpr std::uint64_t kLeast = 64 << 20;
  constexpr std::uint64_t kPerByte = 4;
  return kLeast + kPerByte * file_size;
}
std::uint64_t TimeLimit(std::uint64_t file_size) {  // seconds of the processor
  constexpr std::uint64_t kLeast = 5;
  constexpr std::uint64_t kBytesPerSecond = 20 << 20;  // hardly any disk is slower
  return kLeast + file_size / kBytesPerSecond;
}

constexpr char kTooLarge[] = "expected a file that fits into memory, found a larger one";

// What the child has found wrong; the message without the file's name.
struct Refusal {
  std::string message;
};

// The child sends one before the values of each wanted dataset that is there, in their order, and a last one, of no
// dataset, before the message of a refusal or nothing.
struct Header {
  std::uint64_t index = 0;  // among the wanted datasets; their number for the last
  std::uint64_t size = 0;   // bytes that follow
};
constexpr std::size_t kLongestRefusal = 1000;

void Send(int socket, Header header, const char* bytes) {
  constexpr double kForever = std::numeric_limits<double>::infinity();
  if (WriteAll(socket, &header, sizeof header, kForever) != Transfer::kDone ||
      WriteAll(socket, bytes, header.size, kForever) != Transfer::kDone) {
    _exit(1);
  }
}

// By the index of Hdf5Dataset's alternatives.
constexpr const char* kTypeNames[] = {"32-bit integers", "64-bit IEEE numbers", "a text of fixed length"};
enum TypeIndex : std::size_t { kIntegers, kReals, kText };

bool IsOfType(hid_t type, std::size_t index) {
  if (index == kIntegers) return H5Tequal(type, H5T_STD_I32LE) > 0 || H5Tequal(type, H5T_STD_I32BE) > 0;
  if (index == kReals) return H5Tequal(type, H5T_IEEE_F64LE) > 0 || H5Tequal(type, H5T_IEEE_F64BE) > 0;
  return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
}

// Whether there is such an object; only hard links lead to it.
bool Exists(hid_t file, const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    const htri_t exists = H5Lexists(file, part.c_str(), H5P_DEFAULT);
    if (exists < 0) throw Refusal{part + ": expected a link that libhdf5 can read, found one that it refuses"};
    if (exists == 0) return false;
    H5L_info_t link{};
    if (H5Lget_info(file, part.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
      throw Refusal{part + ": expected a hard link, found another"};
    }
    if (end == std::string::npos) return true;
    H5O_info_t object{};
    if (H5Oget_info_by_name2(file, part.c_str(), &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
      throw Refusal{part + ": expected a group, found an object that libhdf5 cannot read"};
    }
    if (object.type != H5O_TYPE_GROUP) throw Refusal{part + ": expected a group, found another object"};
  }
}

// Before the dataspace is asked for: that of a virtual dataset opens other files.
void RequireStoredHere(hid_t dataset, const std::string& path) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (!properties) throw Refusal{path + ": expected properties that libhdf5 can read, found some that it refuses"};
  const H5D_layout_t layout = H5Pget_layout(properties.id());
  if ((layout != H5D_CONTIGUOUS && layout != H5D_COMPACT) || H5Pget_nfilters(properties.id()) != 0) {
    throw Refusal{path +
                  ": expected values in one piece as fclib writes them, found chunks, filters or other datasets"};
  }
  if (H5Pget_external_count(properties.id()) != 0) {
    throw Refusal{path + ": expected values in the file itself, found names of other files"};
  }
}

// The number of values, which the file really holds: 0 where they were promised and never written.
std::uint64_t CountOf(hid_t dataset, std::size_t value_size, std::uint64_t file_size, const std::string& path) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  constexpr int kMostRank = 1;
  const int rank = space ? H5Sget_simple_extent_ndims(space.id()) : -1;
  if (rank < 0 || rank > kMostRank || H5Sget_simple_extent_type(space.id()) == H5S_NULL) {
    throw Refusal{path + ": expected a list, found a dataset of rank " + std::to_string(rank)};
  }
  const hssize_t points = H5Sget_simple_extent_npoints(space.id());
  const std::uint64_t stored = H5Dget_storage_size(dataset);
  if (points > 0 && stored == 0) return 0;
  const auto count = static_cast<std::uint64_t>(std::max<hssize_t>(points, 0));
  if (points < 0 || count > file_size / value_size || stored != count * value_size) {
    throw Refusal{path + ": expected as many values as the file holds, " + std::to_string(stored) + " bytes of " +
                  std::to_string(file_size) + ", found " + std::to_string(points) + " promised"};
  }
  return count;
}

// The names of what lies at the top of the file, in one line and cut off where it is long.
std::string TopNames(hid_t file) {
  constexpr std::size_t kLongest = 300;
  std::string names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
    auto* all = static_cast<std::string*>(to);
    *all += (all->empty() ? "" : ", ") + std::string(name);
    return all->size() > kLongest ? 1 : 0;
  };
  H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names);
  return names.empty() ? "nothing" : Excerpt(names, kLongest);
}

void RequireOneOf(hid_t file, const std::vector<std::string>& groups) {
  std::string expected;
  for (const std::string& group : groups) {
    if (Exists(file, group)) return;
    expected += (expected.empty() ? "a group " : " or ") + group.substr(1);
  }
  if (!groups.empty()) throw Refusal{"expected " + expected + ", found " + TopNames(file)};
}

// @param left  bytes of the file that no dataset before has had: all together are no more than it, or some are shared
std::optional<std::vector<char>> ReadDataset(hid_t file, const std::string& path, std::size_t type_index,
                                             std::uint64_t file_size, std::uint64_t* left) {
  if (!Exists(file, path)) return std::nullopt;
  const std::string expected = path + ": expected a dataset of " + kTypeNames[type_index];
  H5O_info_t object{};
  if (H5Oget_info_by_name2(file, path.c_str(), &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
    throw Refusal{expected + ", found an object that libhdf5 cannot read"};
  }
  if (object.type != H5O_TYPE_DATASET) throw Refusal{expected + ", found another object"};
  const Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset) throw Refusal{expected + ", found one that libhdf5 cannot open"};
  RequireStoredHere(dataset.id(), path);
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  if (!type || !IsOfType(type.id(), type_index)) throw Refusal{expected + ", found another type"};
  const std::size_t value_size = H5Tget_size(type.id());
  if (value_size == 0) throw Refusal{expected + ", found values of size 0"};
  const std::uint64_t count = CountOf(dataset.id(), value_size, file_size, path);
  if (type_index == kText && count != 1) throw Refusal{expected + ", found " + std::to_string(count) + " texts"};
  const hid_t memory_types[] = {H5T_NATIVE_INT, H5T_NATIVE_DOUBLE, type.id()};
  const std::uint64_t size = count * value_size;
  if (size > *left) throw Refusal{path + ": expected values that no other dataset shares, found shared ones"};
  *left -= size;
  std::vector<char> values(size);
  if (count > 0 && H5Dread(dataset.id(), memory_types[type_index], H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    throw Refusal{expected + ", found values that libhdf5 cannot read"};
  }
  return values;
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
void BecomeHarmless(int socket, std::uint64_t file_size) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (int number = 1; number < NSIG; ++number) std::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (stream != socket) dup2(nowhere, stream);
  }
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_FSIZE, 0);
  Limit(RLIMIT_CPU, TimeLimit(file_size));
  if (!SanitizerReservesMemory()) Limit(RLIMIT_AS, AddressSpaceInUse() + MemoryLimit(file_size));
}

// Reads and sends the wanted datasets of a file of `file_size` bytes.
void RunChild(int socket, const std::string& path, const Hdf5Datasets& wanted, const std::vector<std::string>& groups,
              std::uint64_t file_size) {
  BecomeHarmless(socket, file_size);
  std::string refusal;
  try {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) throw Refusal{"expected an HDF5 file that libhdf5 can read, found one that it refuses"};
    Limit(RLIMIT_NOFILE, 1);  // none but standard input, which is open; poll() takes as many descriptors as this
    RequireOneOf(file, groups);
    std::uint64_t left = file_size;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const auto values = ReadDataset(file, wanted[k].first, wanted[k].second.index(), file_size, &left);
      if (values) Send(socket, {k, values->size()}, values->data());
    }
  } catch (const Refusal& found) {
    refusal = found.message.substr(0, kLongestRefusal);
  } catch (const std::bad_alloc&) {
    refusal = kTooLarge;
  }
  Send(socket, {wanted.size(), refusal.size()}, refusal.data());
  _exit(0);  // closing a malformed file is one more chance to crash
}

std::uint64_t SizeOf(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) throw InputError(path + ": cannot be opened");
  if (!S_ISREG(status.st_mode)) throw InputError(path + ": not a regular file");
  if (access(path.c_str(), R_OK) != 0) throw InputError(path + ": cannot be opened");
  return static_cast<std::uint64_t>(status.st_size);
}

// Errors are ours to tell.
class Silence {
 public:
  Silence() {
    H5Eget_auto2(H5E_DEFAULT, &handler_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, handler_, data_); }

 private:
  H5E_auto2_t handler_ = nullptr;
  void* data_ = nullptr;
};

}  // namespace

Hdf5Datasets ReadHdf5(const std::string& path, const Hdf5Datasets& wanted, const std::vector<std::string>& groups) {
  constexpr double kWaitPerTime = 4;  // the machine may have other things to do
  const std::uint64_t file_size = SizeOf(path);
  std::optional<Subprocess> child;
  try {
    child.emplace([&](int socket) { RunChild(socket, path, wanted, groups, file_size); });
  } catch (const std::runtime_error& error) {
    throw InputError(path + ": " + error.what());
  }
  const double until = SteadyNow() + kWaitPerTime * static_cast<double>(TimeLimit(file_size));
  Transfer last = Transfer::kDone;
  const auto receive = [&](void* to, std::uint64_t size) {
    last = ReadAll(child->socket(), to, size, until);
    return last == Transfer::kDone;
  };
  // What the child sends is checked, as a file may have taken it over.
  Hdf5Datasets found;
  std::uint64_t left = file_size;
  std::size_t least = 0;
  for (Header next; receive(&next, sizeof next) && next.index >= least;) {
    if (next.index == wanted.size() && next.size <= kLongestRefusal) {
      std::string refusal(next.size, '\0');
      if (!receive(refusal.data(), next.size)) break;
      if (!refusal.empty()) throw InputError(path + ": " + refusal);
      return found;
    }
    if (next.index >= wanted.size() || next.size > left) break;
    left -= next.size;
    least = next.index + 1;
    Hdf5Dataset& values = found.emplace_back(wanted[next.index]).second;
    const bool is_whole = std::visit(
        [&](auto& list) {
          list.resize(next.size / sizeof list[0]);
          return receive(list.data(), list.size() * sizeof list[0]);
        },
        values);
    if (!is_whole) break;
    if (auto* text = std::get_if<std::string>(&values)) text->resize(std::min(text->size(), text->find('\0')));
  }
  const std::string how = last == Transfer::kTimeout ? "did not end in time" : DescribeEnd(child->WaitOrKill(1));
  throw InputError(path + ": expected an HDF5 file that libhdf5 can read, found one on which it " + how);
}

void WriteHdf5(const std::string& path, const Hdf5Datasets& datasets) {
  const Silence silence;
  const auto require = [&path](bool done) {
    if (!done) throw InputError(path + ": cannot be written");
  };
  // In memory: libhdf5 does not say why a disk did not take it.
  constexpr std::size_t kIncrement = 1 << 16;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  require(access && H5Pset_fapl_core(access.id(), kIncrement, false) >= 0);
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose);
  require(static_cast<bool>(file));
  std::set<std::string> groups;
  for (const auto& [name, dataset] : datasets) {
    for (std::size_t end = name.find('/', 1); end != std::string::npos; end = name.find('/', end + 1)) {
      const std::string group = name.substr(0, end);
      if (!groups.insert(group).second) continue;
      require(static_cast<bool>(
          Handle(H5Gcreate2(file.id(), group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose)));
    }
    const auto* const text = std::get_if<std::string>(&dataset);
    const Handle text_type(H5Tcopy(H5T_C_S1), H5Tclose);
    require(text_type && (text == nullptr || H5Tset_size(text_type.id(), text->size() + 1) >= 0));
    const hid_t file_types[] = {H5T_STD_I32LE, H5T_IEEE_F64LE, text_type.id()};
    const hid_t memory_types[] = {H5T_NATIVE_INT, H5T_NATIVE_DOUBLE, text_type.id()};
    const hsize_t size = std::visit([](const auto& list) { return list.size(); }, dataset);
    const void* const values = std::visit([](const auto& list) -> const void* { return list.data(); }, dataset);
    const Handle space(text != nullptr ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    // No times in the file.
    require(space && properties && H5Pset_obj_track_times(properties.id(), false) >= 0);
    const Handle created(H5Dcreate2(file.id(), name.c_str(), file_types[dataset.index()], space.id(), H5P_DEFAULT,
                                    properties.id(), H5P_DEFAULT),
                         H5Dclose);
    require(created &&
            H5Dwrite(created.id(), memory_types[dataset.index()], H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  }
  require(H5Fflush(file.id(), H5F_SCOPE_GLOBAL) >= 0);
  const ssize_t size = H5Fget_file_image(file.id(), nullptr, 0);
  std::string image(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
  require(size > 0 && H5Fget_file_image(file.id(), image.data(), image.size()) == size);
  WriteTextFile(path, image);
}

}  // namespace lcpbench
