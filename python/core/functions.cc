#include "python/core/functions.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/peers/protocol/worker.h"
#include "support/input_error.h"

namespace lcpbench::python {
namespace {

/// What a call costs whatever the function does: a problem's rows, and the median time of calls of an empty function.
struct CallCost {
  Index rows = 0;
  double seconds = 0;
};

constexpr std::size_t kCalls = 21;

/// What all solver objects of one connection share.
struct Functions {
  nb::object solve;  ///< (problem, tolerance) -> f, or what has f, status, iterations and detail
  nb::object empty;  ///< the same that does nothing
  std::vector<CallCost> costs;
};

/// A function of Python's. Its exceptions are numerical failures with their text, NotImplementedError a problem that it
/// does not take. The GIL is taken within, on the caller's clock.
class FunctionSolver : public LcpSolver {
 public:
  explicit FunctionSolver(Functions* functions) : functions_(functions) {}
  /// Measures, off every clock, what calls cost on the last problem.
  ~FunctionSolver() override {
    if (!last_) return;
    std::array<double, kCalls> seconds{};
    LcpResult result;
    result.f.resize(last_->size());
    for (double& one : seconds) {
      const double start = SteadyNow();
      Call(functions_->empty, *last_, LcpOptions(), &result);
      one = SteadyNow() - start;
    }
    std::nth_element(seconds.begin(), seconds.begin() + kCalls / 2, seconds.end());
    functions_->costs.push_back({last_->size(), seconds[kCalls / 2]});
  }
  FunctionSolver(const FunctionSolver&) = delete;
  FunctionSolver& operator=(const FunctionSolver&) = delete;

  bool TakesFriction() const override { return true; }  ///< the function says whether it does
  bool TakesBounded() const override { return true; }   ///< the function says whether it does

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    Call(functions_->solve, problem, options, result);
    last_ = problem;
  }

 private:
  static void Call(const nb::object& function, const LcpProblem& problem, const LcpOptions& options,
                   LcpResult* result) {
    const nb::gil_scoped_acquire gil;
    try {
      Read(function(nb::cast(problem), options.tolerance), result);
    } catch (const nb::python_error& error) {
      Fail(error, result);
    } catch (const std::exception& error) {
      result->status = LcpStatus::kNumericalFailure;
      result->detail = error.what();
    }
  }

  static void Fail(const nb::python_error& error, LcpResult* result) {
    const bool refuses = error.matches(PyExc_NotImplementedError);
    result->status = refuses ? LcpStatus::kUnsupported : LcpStatus::kNumericalFailure;
    const std::string text = nb::str(error.value()).c_str();
    result->detail = nb::cast<std::string>(error.type().attr("__name__")) + (text.empty() ? "" : ": " + text);
  }

  static void Read(const nb::object& answer, LcpResult* result) {
    if (answer.is_none()) throw InputError("the function returned None, expected f");
    const bool is_result = nb::hasattr(answer, "f") && nb::hasattr(answer, "status");
    const Vector<double> f = ReadVector<double>(is_result ? nb::object(answer.attr("f")) : answer, "the function's f",
                                                result->f.size(), "n");
    std::copy_n(f.data, f.size, result->f.data());
    result->status = LcpStatus::kSolved;
    if (!is_result) return;
    result->status = LcpStatusFromString(nb::str(answer.attr("status")).c_str());
    result->iterations = nb::cast<std::int64_t>(nb::getattr(answer, "iterations", nb::int_(0)));
    result->detail = nb::str(nb::getattr(answer, "detail", nb::str(""))).c_str();
  }

  Functions* functions_;
  std::optional<LcpProblem> last_;
};

// Serves the host at `socket` until it goes.
nb::list Serve(int socket, const std::string& name, const std::string& version, nb::object function, nb::object empty) {
  Functions functions{std::move(function), std::move(empty), {}};
  {
    const nb::gil_scoped_release release;
    const Hello hello{.name = name, .library_version = version, .licence = "unknown"};
    ServeFrames(socket, socket, hello, [&functions] { return std::make_unique<FunctionSolver>(&functions); });
  }
  nb::list costs;
  for (const CallCost& cost : functions.costs) costs.append(nb::make_tuple(cost.rows, cost.seconds));
  return costs;
}

}  // namespace

void BindFunctions(nb::module_& module) {
  module.def(
      "serve", &Serve, nb::arg("socket"), nb::arg("name"), nb::arg("version"), nb::arg("function"), nb::arg("empty"),
      R"(Serves function(problem, tolerance) to the campaign at the other end of a socket's descriptor, until it closes.

Returns (rows, seconds) of calls of `empty`, measured after every pass and single solves. The GIL is taken for calls only.)");
}

}  // namespace lcpbench::python
