// Libraries of PyPI whose wheels have no headers, by an interpreter of Python in the worker: peers.py, in the folder
// `python` beside the worker, has a class for each. The clock runs around the conversion of arrays into what the module
// takes and its call, as for every peer; of these some ten to a hundred microseconds are Python's.

#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solvers/friction/relaxed_rows.h"
#include "solvers/peers/qp/quadratic_program.h"
#include "support/input_error.h"
#include "support/program_folder.h"

namespace lcpbench {
namespace {

struct Release {
  void operator()(PyObject* object) const { Py_XDECREF(object); }
};
using Object = std::unique_ptr<PyObject, Release>;

// What Python says, as one line.
[[noreturn]] void ThrowPythonError() {
  PyObject* type = nullptr;
  PyObject* value = nullptr;
  PyObject* trace = nullptr;
  PyErr_Fetch(&type, &value, &trace);
  PyErr_NormalizeException(&type, &value, &trace);
  const Object owned_type(type), owned_value(value), owned_trace(trace);
  std::string what = type != nullptr ? reinterpret_cast<PyTypeObject*>(type)->tp_name : "unknown error";
  if (const Object text(value != nullptr ? PyObject_Str(value) : nullptr); text) {
    if (const char* words = PyUnicode_AsUTF8(text.get()); words != nullptr) what += ": " + std::string(words);
  }
  PyErr_Clear();
  throw std::runtime_error("Python: " + what);
}

Object Own(PyObject* object) {
  if (object == nullptr) ThrowPythonError();
  return Object(object);
}

// The interpreter of the environment, with peers.py loaded. Lives as long as the process.
PyObject* PeersModule() {
  static PyObject* const module = [] {
    // One thread, as every solver has.
    for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"}) {
      setenv(name, "1", 1);
    }
    PyConfig config;
    PyConfig_InitPythonConfig(&config);
    config.install_signal_handlers = 0;
    config.write_bytecode = 0;
    PyStatus status = PyConfig_SetBytesString(&config, &config.program_name, LCPBENCH_PYTHON);
    if (PyStatus_Exception(status) == 0) status = Py_InitializeFromConfig(&config);
    PyConfig_Clear(&config);
    if (PyStatus_Exception(status) != 0) {
      throw std::runtime_error(std::string("Python does not start: ") +
                               (status.err_msg != nullptr ? status.err_msg : ""));
    }
    const Object path = Own(PyUnicode_FromString((ProgramFolder() + "/python").c_str()));
    PyList_Insert(PySys_GetObject("path"), 0, path.get());
    return Own(PyImport_ImportModule("peers")).release();
  }();
  return module;
}

// Arrays that are this solve's own: some modules demand arrays that can be written to.
template <typename T>
Object View(T* data, Index count) {
  static char nothing = 0;
  auto* bytes = count > 0 ? reinterpret_cast<char*>(data) : &nothing;
  return Own(PyMemoryView_FromMemory(bytes, static_cast<Py_ssize_t>(count * Index{sizeof(T)}), PyBUF_WRITE));
}

void Set(PyObject* dictionary, const char* name, const Object& value) {
  if (PyDict_SetItemString(dictionary, name, value.get()) != 0) ThrowPythonError();
}

void SetSparse(PyObject* dictionary, const std::string& name, Eigen::SparseMatrix<double>& matrix) {
  Set(dictionary, (name + "_start").c_str(), View(matrix.outerIndexPtr(), matrix.outerSize() + 1));
  Set(dictionary, (name + "_index").c_str(), View(matrix.innerIndexPtr(), matrix.nonZeros()));
  Set(dictionary, (name + "_value").c_str(), View(matrix.valuePtr(), matrix.nonZeros()));
}

struct PythonSettings {
  std::vector<std::pair<const char*, std::vector<const char*>>> choices;  ///< the library's own choice first
  QpLayout layout;
};

PythonSettings SettingsOf(std::string_view key) {
  const QpLayout dense{.dense = true, .bounds_are_rows = false};
  const QpLayout sparse{.dense = false, .bounds_are_rows = false};
  const QpLayout rows{.dense = false, .bounds_are_rows = true};
  if (key.starts_with("piqp-primal"))
    return {{{"backend", {"sparse", "dense"}}, {"refinement", {"no", "yes"}}}, sparse};
  if (key.starts_with("piqp")) return {{{"backend", {"dense", "sparse"}}, {"refinement", {"no", "yes"}}}, sparse};
  if (key.starts_with("clarabel"))
    return {{{"equilibrate", {"yes", "no"}}, {"static_regularization", {"1e-8", "1e-10", "1e-12", "1e-7"}}}, rows};
  if (key.starts_with("qpalm")) return {{{"scaling", {"10", "0", "2"}}, {"gamma", {"1e7", "1e5", "1e9"}}}, rows};
  if (key.starts_with("scs")) {
    return {{{"acceleration_lookback", {"10", "0", "5", "20"}},
             {"scale", {"0.1", "1", "10", "1e-2"}},
             {"normalize", {"yes", "no"}}},
            rows};
  }
  if (key.starts_with("pinocchio-pgs")) return {{{"over_relaxation", {"1", "0.9", "1.2", "1.4", "1.6"}}}, dense};
  if (key.starts_with("pinocchio-admm")) {
    return {{{"update_rule", {"osqp", "spectral", "linear", "constant"}}, {"mu_prox", {"1e-6", "1e-8", "1e-10"}}},
            dense};
  }
  return {{}, dense};  // quadprog, drake, daqp-avi
}

class PythonPeer : public QpPeer {
 public:
  PythonPeer(std::string_view key, SettingsReader* reader) : QpPeer(key, reader), key_(key) {
    const PythonSettings settings = SettingsOf(key);
    const Object chosen = Own(PyDict_New());
    QpLayout layout = settings.layout;
    if (!tier().is_library_default()) {
      for (const auto& [name, values] : settings.choices) {
        const std::string value = ChooseWord(reader, name, values);
        Set(chosen.get(), name, Own(PyUnicode_FromString(value.c_str())));
        if (value == "dense") layout.dense = true;
        if (value == "sparse") layout.dense = false;
      }
    } else if (key.starts_with("piqp-dual")) {
      layout.dense = true;
    }
    set_layout(layout);
    solver_ = Own(PyObject_CallMethod(PeersModule(), "make", "sO", key_.c_str(), chosen.get()));
  }

  bool TakesFriction() const override { return key_.starts_with("pinocchio"); }

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    if (const std::string why = WhyNotPlanar(problem); !why.empty()) return why;
    if (key_.starts_with("daqp-avi")) return "";
    if (key_ == "drake-moby") {
      return problem.bilateral_rows().empty() ? "" : "takes unilateral rows only";
    }
    return QpPeer::WhyUnsupported(problem);
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    QpPeer::DoPrepare(problem);
    tangents_.clear();
    normals_.clear();
    mu_.clear();
    for (const FrictionRow& tangent : problem.friction_rows()) {
      tangents_.push_back(static_cast<int>(tangent.row));
      normals_.push_back(static_cast<int>(tangent.normal));
      mu_.push_back(tangent.mu);
    }
  }

  void Run(QuadraticProgram& qp, QpStart* start, const LcpOptions& options, const Deadline& deadline,
           LcpResult* result) override {
    const Object problem = Own(PyDict_New());
    PyObject* p = problem.get();
    Set(p, "variables", Own(PyLong_FromSsize_t(qp.variables())));
    Set(p, "rows", Own(PyLong_FromSsize_t(qp.rows())));
    Set(p, "primal", Own(PyBool_FromLong(qp.is_primal ? 1 : 0)));
    Set(p, "bilateral", View(qp.bilateral.data(), static_cast<Index>(qp.bilateral.size())));
    Set(p, "friction_row", View(tangents_.data(), static_cast<Index>(tangents_.size())));
    Set(p, "friction_normal", View(normals_.data(), static_cast<Index>(normals_.size())));
    Set(p, "friction_mu", View(mu_.data(), static_cast<Index>(mu_.size())));
    Set(p, "g", View(qp.g.data(), qp.g.size()));
    Set(p, "x_lower", View(qp.x_lower.data(), qp.x_lower.size()));
    Set(p, "lower", View(qp.lower.data(), qp.lower.size()));
    Set(p, "upper", View(qp.upper.data(), qp.upper.size()));
    Set(p, "dense", Own(PyBool_FromLong(qp.dense_H.size() > 0 ? 1 : 0)));
    if (qp.dense_H.size() > 0) {
      Set(p, "H", View(qp.dense_H.data(), qp.dense_H.size()));
      Set(p, "C", View(qp.dense_C.data(), qp.dense_C.size()));
    } else {
      if (qp.C.cols() == 0) qp.C = Eigen::SparseMatrix<double>(0, qp.variables());
      qp.C.makeCompressed();
      qp.H.makeCompressed();
      SetSparse(p, "H", qp.H);
      SetSparse(p, "C", qp.C);
    }
    if (start != nullptr) {
      Set(p, "start_x", View(start->x.data(), start->x.size()));
      Set(p, "start_y", View(start->y.data(), start->y.size()));
    }
    const double tolerance = has_tiers() ? tier().Tolerance(options) : 0;
    const double most = has_tiers() ? tier().Iterations(options) : static_cast<double>(options.max_iterations);
    // Conversion and call are not told apart: Python's part of both is what it is.
    Object answer;
    TimeLibraryCall(options, result, [&] {
      answer = Own(PyObject_CallMethod(solver_.get(), "solve", "Oddd", p, tolerance, deadline.Remaining(), most));
    });
    const char* status = nullptr;
    const char* detail = nullptr;
    long long iterations = 0;
    PyObject* f = nullptr;
    if (PyArg_ParseTuple(answer.get(), "sLsO", &status, &iterations, &detail, &f) == 0) ThrowPythonError();
    result->status = LcpStatusFromString(status);
    result->iterations = iterations;
    result->detail = detail;
    if (f == Py_None) return;
    Py_buffer buffer;
    if (PyObject_GetBuffer(f, &buffer, PyBUF_C_CONTIGUOUS) != 0) ThrowPythonError();
    const bool fits = buffer.len == static_cast<Py_ssize_t>(result->f.size() * Index{sizeof(double)});
    if (fits) result->f = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(buffer.buf), result->f.size());
    PyBuffer_Release(&buffer);
    if (!fits) throw std::runtime_error("Python: an answer of the wrong size");
  }

 private:
  // SettingsReader takes its choices as a list that is written out.
  static std::string ChooseWord(SettingsReader* reader, const char* name, const std::vector<const char*>& values) {
    const auto at = [&](std::size_t i) { return std::string_view(values[std::min(i, values.size() - 1)]); };
    return reader->Choice(name, at(0), {at(0), at(1), at(2), at(3), at(4)});
  }

  std::string key_;
  Object solver_;
  std::vector<int> tangents_, normals_;  // of the friction rows
  std::vector<double> mu_;
};

}  // namespace

PeerLibrary ThisPeerLibrary() {
  const Object version = Own(PyObject_CallMethod(PeersModule(), "version", "s", LCPBENCH_PEER));
  const char* text = PyUnicode_AsUTF8(version.get());
  if (text == nullptr) ThrowPythonError();
  return {text, &MakePeer<PythonPeer>};
}

}  // namespace lcpbench
