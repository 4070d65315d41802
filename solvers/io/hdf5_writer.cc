#include "solvers/io/hdf5_writer.h"

#include <hdf5.h>

#include <utility>

#include "solvers/io/hdf5_handle.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

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
    const Hdf5Handle space(space_id, H5Sclose);
    const Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    Require(space && properties);
    // No times in the file.
    Require(H5Pset_obj_track_times(properties.id(), false) >= 0);
    const Hdf5Handle created(
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
  const Hdf5Handle created(H5Gcreate2(state_->file, group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  state_->Require(static_cast<bool>(created));
}

void Hdf5Writer::AddIntegers(const std::string& dataset, const std::vector<int>& values) {
  state_->Add(dataset, H5T_STD_I32LE, H5T_NATIVE_INT, State::List(values.size()), values.data());
}

void Hdf5Writer::AddReals(const std::string& dataset, const double* values, std::size_t count) {
  state_->Add(dataset, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, State::List(count), values);
}

void Hdf5Writer::AddText(const std::string& dataset, const std::string& text) {
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  state_->Require(type && H5Tset_size(type.id(), text.size() + 1) >= 0);
  state_->Add(dataset, type.id(), type.id(), H5Screate(H5S_SCALAR), text.c_str());
}

void Hdf5Writer::Close() {
  const hid_t file = std::exchange(state_->file, -1);
  state_->Require(H5Fclose(file) >= 0);
}

}  // namespace lcpbench
