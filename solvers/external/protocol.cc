#include "solvers/external/protocol.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are written as memory holds them");

class ByteWriter {
 public:
  template <typename T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    PutArray(&value, 1);
  }
  template <typename T>
  void PutArray(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* begin = reinterpret_cast<const char*>(values);
    bytes_.insert(bytes_.end(), begin, begin + count * sizeof(T));
  }
  void PutString(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size()));
    PutArray(text.data(), text.size());
  }
  void PutVector(const Eigen::VectorXd& v) { PutArray(v.data(), static_cast<std::size_t>(v.size())); }
  void PutSparse(const SparseMatrix& matrix) {
    Put(static_cast<std::uint64_t>(matrix.nonZeros()));
    PutArray(matrix.outerIndexPtr(), static_cast<std::size_t>(matrix.outerSize()) + 1);
    PutArray(matrix.innerIndexPtr(), static_cast<std::size_t>(matrix.nonZeros()));
    PutArray(matrix.valuePtr(), static_cast<std::size_t>(matrix.nonZeros()));
  }
  Bytes Take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(const Bytes& bytes) : bytes_(bytes) {}

  template <typename T>
  T Get(const char* field) {
    T value;
    std::memcpy(&value, Advance(field, 1, sizeof(T)), sizeof(T));
    return value;
  }
  std::string GetString(const char* field) {
    const auto size = Get<std::uint32_t>(field);
    return std::string(Advance(field, size, 1), size);
  }
  template <typename T>
  std::vector<T> GetArray(const char* field, std::uint64_t count) {
    const char* begin = Advance(field, count, sizeof(T));
    std::vector<T> values(static_cast<std::size_t>(count));
    if (count > 0) std::memcpy(values.data(), begin, static_cast<std::size_t>(count) * sizeof(T));
    return values;
  }
  Eigen::VectorXd GetVector(const char* field, std::uint64_t count) {
    const std::vector<double> values = GetArray<double>(field, count);
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
  }
  SparseMatrix GetSparse(const char* field, std::uint64_t rows, std::uint64_t columns) {
    const auto entries = Get<std::uint64_t>(field);
    const auto starts = GetArray<std::int32_t>(field, rows + 1);
    const auto inner = GetArray<std::int32_t>(field, entries);
    const auto values = GetArray<double>(field, entries);
    bool valid = starts.front() == 0 && static_cast<std::uint64_t>(starts.back()) == entries;
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) valid = valid && starts[i] <= starts[i + 1];
    for (const std::int32_t column : inner)
      valid = valid && column >= 0 && static_cast<std::uint64_t>(column) < columns;
    for (std::size_t i = 0; valid && i + 1 < starts.size(); ++i) {
      const auto row = inner.begin() + starts[i];
      const auto end = inner.begin() + starts[i + 1];
      valid = std::adjacent_find(row, end, std::greater_equal<>()) == end;  // columns in order, each once
    }
    if (!valid) throw std::runtime_error(std::string("protocol: ") + field + " is not a compressed row matrix");
    return Eigen::Map<const SparseMatrix>(static_cast<Index>(rows), static_cast<Index>(columns),
                                          static_cast<Index>(entries), starts.data(), inner.data(), values.data());
  }
  /// What is to come must fit in what is left: no claim makes room for itself.
  void RequireRoom(const char* field, std::uint64_t count, std::size_t size) const {
    // By division, so that nothing can overflow.
    if (count > (bytes_.size() - at_) / size) {
      throw std::runtime_error(std::string("protocol: a message ends within its field '") + field + "'");
    }
  }
  void Finish() const {
    if (at_ != bytes_.size()) throw std::runtime_error("protocol: a message is longer than its fields");
  }

 private:
  const char* Advance(const char* field, std::uint64_t count, std::size_t size) {
    RequireRoom(field, count, size);
    const char* begin = bytes_.data() + at_;
    at_ += static_cast<std::size_t>(count) * size;
    return begin;
  }

  const Bytes& bytes_;
  std::size_t at_ = 0;
};

MatrixForm FormFor(const LcpProblem& problem, WantedForm form) {
  switch (form) {
    case WantedForm::kDense:
      return MatrixForm::kDense;
    case WantedForm::kSparse:
      return MatrixForm::kSparse;
    case WantedForm::kAsGiven:
      break;
  }
  return problem.given_form();
}

}  // namespace

Bytes Encode(const Hello& hello) {
  ByteWriter out;
  out.Put(hello.version);
  out.Put(hello.form);
  out.PutString(hello.name);
  out.PutString(hello.library_version);
  out.PutString(hello.licence);
  return out.Take();
}

Hello DecodeHello(const Bytes& payload) {
  ByteReader in(payload);
  Hello hello;
  hello.version = in.Get<std::uint32_t>("version");
  if (hello.version != kProtocolVersion) {
    throw std::runtime_error("protocol: expected version " + std::to_string(kProtocolVersion) + ", found " +
                             std::to_string(hello.version));
  }
  const auto form = in.Get<std::uint8_t>("form");
  if (form > static_cast<std::uint8_t>(WantedForm::kAsGiven)) throw std::runtime_error("protocol: unknown form");
  hello.form = static_cast<WantedForm>(form);
  hello.name = in.GetString("name");
  hello.library_version = in.GetString("version");
  hello.licence = in.GetString("licence");
  in.Finish();
  return hello;
}

Bytes Encode(const LcpProblem& problem, WantedForm wanted) {
  const auto n = static_cast<std::size_t>(problem.size());
  const MatrixForm form = FormFor(problem, wanted);
  ByteWriter out;
  out.Put(static_cast<std::uint64_t>(n));
  out.Put(static_cast<std::uint8_t>(form));
  out.Put(static_cast<std::uint8_t>(problem.facts().symmetric));
  out.Put(static_cast<std::uint8_t>(problem.facts().positive_semidefinite));
  out.PutVector(problem.b());
  for (std::size_t i = 0; i < n; ++i) {
    out.Put(static_cast<std::uint8_t>(problem.is_bilateral(static_cast<Index>(i))));
  }
  switch (form) {
    case MatrixForm::kDense:
      for (Index i = 0; i < problem.size(); ++i) out.PutVector(problem.DenseA().row(i).transpose());
      break;
    case MatrixForm::kSparse:
      out.PutSparse(problem.SparseA());
      break;
    case MatrixForm::kFactors:
      out.Put(static_cast<std::uint64_t>(problem.J().cols()));
      out.PutSparse(problem.J());
      out.PutVector(problem.inverse_mass());
      break;
  }
  return out.Take();
}

LcpProblem DecodeProblem(const Bytes& payload) {
  ByteReader in(payload);
  const auto n = in.Get<std::uint64_t>("n");
  const auto form = in.Get<std::uint8_t>("form");
  MatrixFacts facts;
  facts.symmetric = in.Get<std::uint8_t>("symmetric") != 0;
  facts.positive_semidefinite = in.Get<std::uint8_t>("positive semidefinite") != 0;
  Eigen::VectorXd b = in.GetVector("b", n);
  const auto bilateral = in.GetArray<std::uint8_t>("bilateral", n);
  std::vector<Index> rows;
  for (std::size_t i = 0; i < bilateral.size(); ++i) {
    if (bilateral[i] != 0) rows.push_back(static_cast<Index>(i));
  }
  const auto size = static_cast<Index>(n);
  RowBounds bounds = rows.empty() ? RowBounds{} : RowBounds::WithBilateralRows(size, rows);
  switch (form) {
    case static_cast<std::uint8_t>(MatrixForm::kDense): {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      if (n > 0xFFFFFFFFU) throw std::runtime_error("protocol: n is too large for a dense matrix");
      const std::vector<double> values = in.GetArray<double>("A", n * n);
      in.Finish();
      return LcpProblem::FromDense("", Eigen::Map<const RowMajor>(values.data(), size, size), std::move(b),
                                   std::move(bounds), facts);
    }
    case static_cast<std::uint8_t>(MatrixForm::kSparse): {
      SparseMatrix A = in.GetSparse("A", n, n);
      in.Finish();
      return LcpProblem::FromSparse("", A, std::move(b), std::move(bounds), facts);
    }
    case static_cast<std::uint8_t>(MatrixForm::kFactors): {
      const auto columns = in.Get<std::uint64_t>("columns");
      in.RequireRoom("inverse mass", columns, sizeof(double));
      SparseMatrix J = in.GetSparse("J", n, columns);
      Eigen::VectorXd inverse_mass = in.GetVector("inverse mass", columns);
      in.Finish();
      return LcpProblem::FromFactors("", J, std::move(inverse_mass), std::move(b), std::move(bounds), facts);
    }
    default:
      throw std::runtime_error("protocol: unknown form of A");
  }
}

Bytes Encode(const Prepared& prepared) {
  ByteWriter out;
  out.Put(prepared.convert_s);
  out.PutString(prepared.why_unsupported);
  return out.Take();
}

Prepared DecodePrepared(const Bytes& payload) {
  ByteReader in(payload);
  Prepared prepared;
  prepared.convert_s = in.Get<double>("seconds");
  prepared.why_unsupported = in.GetString("why");
  in.Finish();
  return prepared;
}

Bytes Encode(const SolveRequest& request) {
  ByteWriter out;
  out.Put(request.tolerance);
  out.Put(request.time_limit_s);
  out.Put(request.max_iterations);
  out.Put(request.repetitions);
  out.Put(static_cast<std::uint8_t>(request.start.has_value()));
  if (request.start) out.PutVector(*request.start);
  return out.Take();
}

SolveRequest DecodeSolve(const Bytes& payload, Index rows) {
  ByteReader in(payload);
  SolveRequest request;
  request.tolerance = in.Get<double>("tolerance");
  request.time_limit_s = in.Get<double>("time limit");
  request.max_iterations = in.Get<std::int64_t>("iteration limit");
  request.repetitions = in.Get<std::uint64_t>("repetitions");
  if (in.Get<std::uint8_t>("has start") != 0) request.start = in.GetVector("start", static_cast<std::uint64_t>(rows));
  in.Finish();
  return request;
}

Bytes Encode(const LcpResult& result) {
  ByteWriter out;
  out.PutString(std::string(ToString(result.status)));
  out.Put(result.iterations);
  out.Put(result.own_solve_s);
  out.Put(result.own_convert_s);
  out.PutString(result.detail);
  out.PutVector(result.f);
  out.Put(static_cast<std::uint8_t>(result.farkas_ray.has_value()));
  if (result.farkas_ray) out.PutVector(*result.farkas_ray);
  return out.Take();
}

LcpResult DecodeResult(const Bytes& payload, Index rows) {
  ByteReader in(payload);
  LcpResult result;
  const std::string status = in.GetString("status");
  try {
    result.status = LcpStatusFromString(status);
  } catch (const InputError&) {
    throw std::runtime_error("protocol: unknown status '" + status + "'");
  }
  result.iterations = in.Get<std::int64_t>("iterations");
  result.own_solve_s = in.Get<double>("seconds per solve");
  result.own_convert_s = in.Get<double>("seconds of conversion");
  result.detail = in.GetString("detail");
  result.f = in.GetVector("f", static_cast<std::uint64_t>(rows));
  if (in.Get<std::uint8_t>("has ray") != 0) {
    result.farkas_ray = in.GetVector("ray", static_cast<std::uint64_t>(rows));
  }
  in.Finish();
  return result;
}

}  // namespace lcpbench
