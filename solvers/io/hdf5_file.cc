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
#include <string_view>
#include <utility>

#include "support/clock.h"
#include "support/input_error.h"
#include "support/subprocess.h"

namespace lcpbench {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

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

// What the child may use.
struct Limits {
  std::uint64_t memory = 0;  // bytes beyond what it is born with
  std::uint64_t time_s = 0;  // of the processor

  explicit Limits(std::uint64_t file_size)
      : memory(kLeastMemory + kMemoryPerByte * file_size), time_s(kLeastTime + file_size / kBytesPerSecond) {}

 private:
  static constexpr std::uint64_t kLeastMemory = 64 << 20;
  static constexpr std::uint64_t kMemoryPerByte = 4;
  static constexpr std::uint64_t kLeastTime = 5;
  static constexpr std::uint64_t kBytesPerSecond = 20 << 20;  // hardly any disk is slower
};

// What the child sends for every request, in their order, as one byte each; then kEnd. After kPresent and kRefused
// come the number of bytes (std::uint64_t) and the bytes: values as int or double, a text, or a message without the
// file's name, after which nothing comes.
enum class Answer : unsigned char { kAbsent, kPresent, kRefused, kEnd };

// What the child found wrong; the message without the file's name.
struct Refusal {
  std::string message;
};

void Send(int pipe, const void* data, std::size_t size) {
  if (WriteAll(pipe, data, size, kForever) != Transfer::kDone) _exit(1);
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
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
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
  const Handle space(H5Dget_space(dataset), H5Sclose);
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
  const Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset) throw Refusal{expected + ", found one that libhdf5 cannot open"};
  RequireStoredHere(dataset.id(), path);
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
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
void BecomeHarmless(int pipe, const Limits& limits) {
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
  if (!SanitizerReservesMemory()) Limit(RLIMIT_AS, AddressSpaceInUse() + limits.memory);
}

// Reads the datasets of a file of `file_size` bytes and writes them to `pipe`.
void RunChild(int pipe, const std::string& path, const std::vector<Hdf5Request>& requests, std::uint64_t file_size,
              const Limits& limits) {
  BecomeHarmless(pipe, limits);
  try {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
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
  _exit(0);  // closing a malformed file is one more chance to crash
}

// Reads from the child until it has ended, or its time is up.
class Pipe {
 public:
  Pipe(int end, double deadline) : end_(end), deadline_(deadline) {}

  /// `size` bytes, or false. Memory grows with what comes.
  template <typename List>
  bool Fill(List* values, std::uint64_t size) {
    using Value = typename List::value_type;
    constexpr std::uint64_t kChunk = std::uint64_t{1} << 20;
    if (size % sizeof(Value) != 0) return false;
    for (std::uint64_t read = 0; read < size;) {
      const std::uint64_t more = std::min(kChunk, size - read);
      values->resize((read + more) / sizeof(Value));
      if (!Fill(reinterpret_cast<char*>(values->data()) + read, more)) return false;
      read += more;
    }
    return true;
  }

  bool Fill(char* data, std::uint64_t size) {
    const Transfer outcome = ReadAll(end_, data, size, deadline_);
    timed_out_ = outcome == Transfer::kTimeout;
    return outcome == Transfer::kDone;
  }

  bool timed_out() const { return timed_out_; }

 private:
  int end_;
  double deadline_;
  bool timed_out_ = false;
};

std::uint64_t SizeOf(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) throw InputError(path + ": cannot be opened");
  if (!S_ISREG(status.st_mode)) throw InputError(path + ": not a regular file");
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
      std::string text;
      if (!pipe->Fill(&text, size)) return false;
      throw InputError(path + ": " + text);
    }
    if (answer != Answer::kPresent) return false;
    total += size;
    if (total > file_size) {
      throw InputError(path + ": " + requests[k].path +
                       ": expected values of its own, found some that are others' too");
    }
    Hdf5Dataset dataset;
    const Hdf5Kind kind = requests[k].kind;
    const bool complete = kind == Hdf5Kind::kIntegers ? pipe->Fill(&dataset.integers, size)
                          : kind == Hdf5Kind::kReals  ? pipe->Fill(&dataset.reals, size)
                                                      : pipe->Fill(&dataset.text, size);
    if (!complete) return false;
    dataset.text.resize(std::min(dataset.text.size(), dataset.text.find('\0')));
    datasets->emplace(requests[k].path, std::move(dataset));
  }
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

std::map<std::string, Hdf5Dataset> ReadHdf5(const std::string& path, const std::vector<Hdf5Request>& requests) {
  constexpr double kWaitPerTime = 4;  // the machine may have other things to do
  const std::uint64_t file_size = SizeOf(path);
  const Limits limits(file_size);
  std::optional<Subprocess> child;
  try {
    child.emplace([&](int pipe) { RunChild(pipe, path, requests, file_size, limits); });
  } catch (const std::runtime_error& error) {
    throw InputError(path + ": " + error.what());
  }
  Pipe pipe(child->socket(), SteadyNow() + kWaitPerTime * static_cast<double>(limits.time_s));
  std::map<std::string, Hdf5Dataset> datasets;
  if (Receive(&pipe, path, requests, file_size, &datasets)) return datasets;
  const std::string how = pipe.timed_out() ? "did not end in time" : DescribeEnd(child->Kill());
  throw InputError(path + ": expected an HDF5 file that libhdf5 can read, found one on which it " + how);
}

struct Hdf5Writer::State {
  std::string path;
  Silence silence;
  hid_t file = -1;

  explicit State(std::string path_of_file) : path(std::move(path_of_file)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (file >= 0) H5Fclose(file);
  }

  void Require(bool done) const {
    if (!done) throw InputError(path + ": cannot be written");
  }

  void Add(const std::string& dataset, hid_t file_type, hid_t memory_type, hid_t space_id, const void* values) const {
    const Handle space(space_id, H5Sclose);
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    Require(space && properties);
    // No times in the file.
    Require(H5Pset_obj_track_times(properties.id(), false) >= 0);
    const Handle created(
        H5Dcreate2(file, dataset.c_str(), file_type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT), H5Dclose);
    Require(static_cast<bool>(created));
    Require(H5Dwrite(created.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
  }

  static hid_t List(std::size_t count) {
    const hsize_t size = count;
    return H5Screate_simple(1, &size, nullptr);
  }
};

Hdf5Writer::Hdf5Writer(const std::string& path) : state_(std::make_unique<State>(path)) {
  state_->file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  state_->Require(state_->file >= 0);
}

Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::AddGroup(const std::string& group) {
  const Handle created(H5Gcreate2(state_->file, group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  state_->Require(static_cast<bool>(created));
}

void Hdf5Writer::AddIntegers(const std::string& dataset, const std::vector<int>& values) {
  state_->Add(dataset, H5T_STD_I32LE, H5T_NATIVE_INT, State::List(values.size()), values.data());
}

void Hdf5Writer::AddReals(const std::string& dataset, const double* values, std::size_t count) {
  state_->Add(dataset, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, State::List(count), values);
}

void Hdf5Writer::AddText(const std::string& dataset, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  state_->Require(type && H5Tset_size(type.id(), text.size() + 1) >= 0);
  state_->Add(dataset, type.id(), type.id(), H5Screate(H5S_SCALAR), text.c_str());
}

void Hdf5Writer::Close() {
  const hid_t file = std::exchange(state_->file, -1);
  state_->Require(H5Fclose(file) >= 0);
}

}  // namespace lcpbench
