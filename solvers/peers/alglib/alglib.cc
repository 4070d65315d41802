// ALGLIB: four of its solvers of quadratic programs on min 1/2 f'A f + b'f, f_C >= 0: QuickQP (constrained conjugate
// gradients and Newton steps), a dense and a sparse interior point method, and BLEIC (an active set with L-BFGS).
//
// Variables have the scale 1 / sqrt A_ii, as the library asks for. For keys that follow the tier b is scaled by a power
// of two so that the largest scaled gradient at zero is about 1, since the library's tolerances bound that gradient.
// Nothing reads a clock: the host's time limit ends a solve. Iterations are inner ones. Code 7, "no further improvement
// possible", is not taken for success, and "unbounded" not for a proof that there is no solution.

#include <libalglib/linalg.h>
#include <libalglib/optimization.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

enum class Method { kQuickQp, kDenseIpm, kSparseIpm, kBleic };

Method MethodOf(std::string_view key) {
  if (key.starts_with("alglib-quickqp")) return Method::kQuickQp;
  if (key.starts_with("alglib-dense-ipm")) return Method::kDenseIpm;
  return key.starts_with("alglib-sparse-ipm") ? Method::kSparseIpm : Method::kBleic;
}

/// The library's exceptions are not std::exception's.
template <typename Work>
void CallAlglib(Work work) {
  try {
    work();
  } catch (const alglib::ap_error& error) {
    throw std::runtime_error("ALGLIB: " + error.msg);
  }
}

class Alglib : public LcpSolver {
 public:
  Alglib(std::string_view key, SettingsReader* reader)
      : method_(MethodOf(key)), is_sparse_(method_ == Method::kSparseIpm), tier_(key, reader) {
    if (tier_.is_library_default()) return;
    if (method_ == Method::kQuickQp || method_ == Method::kBleic) {
      is_sparse_ = Choose<bool>(reader, "form", {{"dense", false}, {"sparse", true}});
    }
    if (method_ == Method::kQuickQp) has_newton_ = Choose<bool>(reader, "newton", {{"yes", true}, {"no", false}});
  }

  std::string WhyUnsupported(const LcpProblem& problem) const override { return WhyNotQuadraticProgram(problem); }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    CallAlglib([&] { MakeState(problem); });
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    CallAlglib([&] { Run(problem, options, result); });
  }

 private:
  void MakeState(const LcpProblem& problem) {
    const auto n = static_cast<alglib::ae_int_t>(problem.size());
    UseStateOf(n);
    if (is_sparse_) {
      SetSparse(problem);
    } else {
      RequireDenseMatrices(n, 4);  // ours, the state's, the method's, its factor
      A_.resize(static_cast<std::size_t>(n * n));
      AssembleDenseA(problem, A_.data(), n);
      alglib::real_2d_array A;
      A.attach_to_ptr(n, n, A_.data());
      alglib::minqpsetquadraticterm(*state_, A, true);
    }
    alglib::real_1d_array lower;
    alglib::real_1d_array upper;
    lower.setlength(n);
    upper.setlength(n);
    scale_.setlength(n);
    for (alglib::ae_int_t i = 0; i < n; ++i) {
      lower[i] = problem.is_bilateral(i) ? -std::numeric_limits<double>::infinity() : 0;
      upper[i] = std::numeric_limits<double>::infinity();
      const double diagonal = problem.DiagonalA()[i];
      scale_[i] = diagonal > 0 ? 1 / std::sqrt(diagonal) : 1;
    }
    alglib::minqpsetbc(*state_, lower, upper);
    alglib::minqpsetscale(*state_, scale_);
  }

  // Making one takes some 40 us: kept for the next problem of as many rows, for which all that is in it is set anew.
  void UseStateOf(alglib::ae_int_t n) {
    constexpr alglib::ae_int_t kMostRows = 100;  // of larger problems it is a small part
    if (n > kMostRows) states_.erase(kMostRows + 1);
    std::unique_ptr<alglib::minqpstate>& kept = states_[std::min(n, kMostRows + 1)];
    if (kept == nullptr) {
      kept = std::make_unique<alglib::minqpstate>();
      alglib::minqpcreate(n, *kept);
    }
    state_ = kept.get();
  }

  // The upper triangle.
  void SetSparse(const LcpProblem& problem) {
    const SparseMatrix& A = problem.SparseA();
    const auto n = static_cast<alglib::ae_int_t>(problem.size());
    RequireSparseMatrices(n, static_cast<double>(A.nonZeros()), 4);
    alglib::integer_1d_array counts;
    counts.setlength(n);
    for (alglib::ae_int_t row = 0; row < n; ++row) {
      counts[row] = 0;
      for (SparseMatrix::InnerIterator entry(A, row); entry; ++entry) counts[row] += entry.col() >= row ? 1 : 0;
    }
    alglib::sparsematrix upper;
    alglib::sparsecreatecrs(n, n, counts, upper);
    for (alglib::ae_int_t row = 0; row < n; ++row) {
      for (SparseMatrix::InnerIterator entry(A, row); entry; ++entry) {
        if (entry.col() >= row) alglib::sparseset(upper, row, entry.col(), entry.value());
      }
    }
    alglib::minqpsetquadratictermsparse(*state_, upper, true);
  }

  void SetMethod(double tolerance, const LcpOptions& options) {
    // Zeros everywhere: the library's own choice. Its limits of iterations are none.
    switch (method_) {
      case Method::kQuickQp:
        alglib::minqpsetalgoquickqp(*state_, tolerance, 0, 0, IterationLimit(options, 0), has_newton_);
        return;
      case Method::kDenseIpm:
        alglib::minqpsetalgodenseipm(*state_, tolerance);
        return;
      case Method::kSparseIpm:
        alglib::minqpsetalgosparseipm(*state_, tolerance);
        return;
      case Method::kBleic:
        alglib::minqpsetalgobleic(*state_, tolerance, 0, 0, IterationLimit(options, 0));
        return;
    }
  }

  void Run(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    const auto n = static_cast<alglib::ae_int_t>(problem.size());
    double unit = 1;
    TimeConversion(options, result, [&] {
      double largest = 0;
      for (alglib::ae_int_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(problem.b()[i] * scale_[i]));
      if (!tier_.is_library_default() && largest > 0) unit = std::exp2(std::round(std::log2(largest)));
      alglib::real_1d_array b;
      alglib::real_1d_array start;
      b.setlength(n);
      start.setlength(n);
      for (alglib::ae_int_t i = 0; i < n; ++i) {
        b[i] = problem.b()[i] / unit;
        start[i] = options.initial_f != nullptr ? (*options.initial_f)[i] / unit : 0;
        if (!problem.is_bilateral(i)) start[i] = std::max(0.0, start[i]);
      }
      alglib::minqpsetlinearterm(*state_, b);
      alglib::minqpsetstartingpoint(*state_, start);
      SetMethod(tier_.is_library_default() ? 0 : tier_.Tolerance(options), options);
    });
    alglib::real_1d_array f;
    alglib::minqpreport report;
    TimeLibraryCall(options, result, [&] {
      alglib::minqpoptimize(*state_);
      alglib::minqpresults(*state_, f, report);
    });
    TimeConversion(options, result, [&] {
      for (alglib::ae_int_t i = 0; i < std::min<alglib::ae_int_t>(n, f.length()); ++i) result->f[i] = f[i] * unit;
    });
    result->iterations = report.inneriterationscount;
    const alglib::ae_int_t code = report.terminationtype;
    constexpr alglib::ae_int_t kLastSuccess = 4;
    constexpr alglib::ae_int_t kIterations = 5;
    if (code >= 1 && code <= kLastSuccess) {
      result->status = LcpStatus::kSolved;
    } else if (code == kIterations) {
      result->status = LcpStatus::kIterationLimit;
    } else {
      result->detail = "ALGLIB: termination code " + std::to_string(code);
    }
  }

  Method method_;
  bool is_sparse_;
  PeerTier tier_;
  bool has_newton_ = true;
  std::vector<double> A_;
  alglib::real_1d_array scale_;
  std::map<alglib::ae_int_t, std::unique_ptr<alglib::minqpstate>> states_;  // by rows
  alglib::minqpstate* state_ = nullptr;
};

}  // namespace

PeerLibrary ThisPeerLibrary() { return {LCPBENCH_ALGLIB_VERSION, &MakePeer<Alglib>}; }

}  // namespace lcpbench
