#include "solvers/peers/protocol/protocol.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "support/input_error.h"

namespace lcpbench {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are written as memory holds them");

constexpr int kNotKnown = -1;

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
  template <typename T>
  void PutArray(const std::vector<T>& values) {
    PutArray(values.data(), values.size());
  }
  template <typename T>
  void PutCounted(const std::vector<T>& values) {
    Put(static_cast<std::uint32_t>(values.size()));
    PutArray(values);
  }
  void PutProblem(const ProblemArrays& problem, std::uint32_t version) {
    Put(static_cast<std::uint64_t>(problem.rows));
    Put(static_cast<std::uint8_t>(problem.form));
    Put(static_cast<std::uint8_t>(problem.facts.symmetric));
    Put(static_cast<std::uint8_t>(problem.facts.positive_semidefinite));
    if (version > 1) {
      Put(static_cast<std::int64_t>(problem.facts.rank.value_or(kNotKnown)));
      const std::optional<bool> unique = problem.facts.f_unique;
      Put(static_cast<std::int8_t>(unique.has_value() ? static_cast<int>(*unique) : kNotKnown));
    }
    PutArray(problem.b);
    PutArray(problem.bilateral.empty() ? std::vector<unsigned char>(problem.b.size(), 0) : problem.bilateral);
    if (problem.form == MatrixForm::kFactors) Put(static_cast<std::uint64_t>(problem.columns));
    if (problem.form != MatrixForm::kDense) {
      Put(static_cast<std::uint64_t>(problem.value.size()));
      PutArray(problem.row_start);
      PutArray(problem.column);
    }
    PutArray(problem.value);
    if (problem.form == MatrixForm::kFactors) PutArray(problem.inverse_mass);
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
  template <typename T>
  std::vector<T> GetCounted(const char* field) {
    return GetArray<T>(field, Get<std::uint32_t>(field));
  }
  ProblemArrays GetProblem(std::uint32_t version) {
    ProblemArrays problem;
    const auto n = Get<std::uint64_t>("n");
    // What follows has 9 n bytes at least, so that n is no claim but a fact from here on.
    RequireRoom("b", n, sizeof(double) + 1);
    problem.rows = problem.columns = static_cast<Index>(n);
    const auto form = Get<std::uint8_t>("form");
    if (form > static_cast<std::uint8_t>(MatrixForm::kFactors)) throw std::runtime_error("protocol: unknown form of A");
    problem.form = static_cast<MatrixForm>(form);
    problem.facts.symmetric = Get<std::uint8_t>("symmetric") != 0;
    problem.facts.positive_semidefinite = Get<std::uint8_t>("positive semidefinite") != 0;
    if (version > 1) {
      const auto rank = Get<std::int64_t>("rank");
      if (rank >= 0) problem.facts.rank = static_cast<Index>(rank);
      const auto unique = Get<std::int8_t>("unique");
      if (unique >= 0) problem.facts.f_unique = unique != 0;
    }
    problem.b = GetArray<double>("b", n);
    problem.bilateral = GetArray<unsigned char>("bilateral", n);
    const auto is_set = [](unsigned char flag) { return flag != 0; };
    if (std::none_of(problem.bilateral.begin(), problem.bilateral.end(), is_set)) problem.bilateral.clear();
    switch (problem.form) {
      case MatrixForm::kDense:
        if (n > 0xFFFFFFFFU) throw std::runtime_error("protocol: n is too large for a dense matrix");
        problem.value = GetArray<double>("A", n * n);
        break;
      case MatrixForm::kSparse:
        GetRows("A", &problem);
        break;
      case MatrixForm::kFactors: {
        const auto columns = Get<std::uint64_t>("columns");
        RequireRoom("inverse mass", columns, sizeof(double));
        problem.columns = static_cast<Index>(columns);
        GetRows("J", &problem);
        problem.inverse_mass = GetArray<double>("inverse mass", columns);
        break;
      }
    }
    return problem;
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
  void GetRows(const char* field, ProblemArrays* problem) {
    const auto entries = Get<std::uint64_t>(field);
    problem->row_start = GetArray<std::int32_t>(field, static_cast<std::uint64_t>(problem->rows) + 1);
    problem->column = GetArray<std::int32_t>(field, entries);
    problem->value = GetArray<double>(field, entries);
    const std::vector<int>& starts = problem->row_start;
    const std::vector<int>& inner = problem->column;
    bool valid = starts.front() == 0 && static_cast<std::uint64_t>(starts.back()) == entries;
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) valid = valid && starts[i] <= starts[i + 1];
    for (const int column : inner) valid = valid && column >= 0 && column < problem->columns;
    for (std::size_t i = 0; valid && i + 1 < starts.size(); ++i) {
      const auto row = inner.begin() + starts[i];
      const auto end = inner.begin() + starts[i + 1];
      valid = std::adjacent_find(row, end, std::greater_equal<>()) == end;  // columns in order, each once
    }
    if (!valid) throw std::runtime_error(std::string("protocol: ") + field + " is not a compressed row matrix");
  }

  const char* Advance(const char* field, std::uint64_t count, std::size_t size) {
    RequireRoom(field, count, size);
    const char* begin = bytes_.data() + at_;
    at_ += static_cast<std::size_t>(count) * size;
    return begin;
  }

  const Bytes& bytes_;
  std::size_t at_ = 0;
};

LcpStatus GetStatus(ByteReader* in) {
  const std::string status = in->GetString("status");
  try {
    return LcpStatusFromString(status);
  } catch (const InputError&) {
    throw std::runtime_error("protocol: unknown status '" + status + "'");
  }
}

}  // namespace

Bytes Encode(const Hello& hello) {
  ByteWriter out;
  out.Put(hello.version);
  if (hello.version == 1) out.Put(hello.form);
  out.PutString(hello.name);
  out.PutString(hello.library_version);
  out.PutString(hello.licence);
  return out.Take();
}

Hello DecodeHello(const Bytes& payload) {
  ByteReader in(payload);
  Hello hello;
  hello.version = in.Get<std::uint32_t>("version");
  if (hello.version < 1 || hello.version > kProtocolVersion) {
    throw std::runtime_error("protocol: expected version 1 to " + std::to_string(kProtocolVersion) + ", found " +
                             std::to_string(hello.version));
  }
  if (hello.version == 1) {
    const auto form = in.Get<std::uint8_t>("form");
    if (form > static_cast<std::uint8_t>(WantedForm::kAsGiven)) throw std::runtime_error("protocol: unknown form");
    hello.form = static_cast<WantedForm>(form);
  }
  hello.name = in.GetString("name");
  hello.library_version = in.GetString("version");
  hello.licence = in.GetString("licence");
  in.Finish();
  return hello;
}

Bytes Encode(const ProblemArrays& problem, std::uint32_t version) {
  ByteWriter out;
  out.PutProblem(problem, version);
  return out.Take();
}

ProblemArrays DecodeProblem(const Bytes& payload, std::uint32_t version) {
  ByteReader in(payload);
  ProblemArrays problem = in.GetProblem(version);
  in.Finish();
  return problem;
}

Bytes Encode(const Eigen::VectorXd& b) {
  ByteWriter out;
  out.PutVector(b);
  return out.Take();
}

Eigen::VectorXd DecodeOtherB(const Bytes& payload, Index rows) {
  ByteReader in(payload);
  Eigen::VectorXd b = in.GetVector("b", static_cast<std::uint64_t>(rows));
  in.Finish();
  return b;
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

Bytes Encode(const SolveRequest& request, std::uint32_t version) {
  ByteWriter out;
  out.Put(request.tolerance);
  out.Put(request.time_limit_s);
  out.Put(request.max_iterations);
  if (version == 1) {
    out.Put(std::uint64_t{1});
  } else {
    out.Put(static_cast<std::uint8_t>(request.time_parts));
  }
  out.Put(static_cast<std::uint8_t>(request.start.has_value()));
  if (request.start) out.PutVector(*request.start);
  return out.Take();
}

SolveRequest DecodeSolve(const Bytes& payload, Index rows, std::uint32_t version) {
  ByteReader in(payload);
  SolveRequest request;
  request.tolerance = in.Get<double>("tolerance");
  request.time_limit_s = in.Get<double>("time limit");
  request.max_iterations = in.Get<std::int64_t>("iteration limit");
  if (version == 1) {
    in.Get<std::uint64_t>("one");
  } else {
    request.time_parts = in.Get<std::uint8_t>("parts wanted") != 0;
  }
  if (in.Get<std::uint8_t>("has start") != 0) request.start = in.GetVector("start", static_cast<std::uint64_t>(rows));
  in.Finish();
  return request;
}

Bytes Encode(const LcpResult& result, std::uint32_t version) {
  ByteWriter out;
  out.PutString(std::string(ToString(result.status)));
  out.Put(result.iterations);
  out.Put(result.own_solve_s);
  out.Put(result.own_convert_s);
  if (version > 1) out.Put(result.own_fresh_s);
  out.PutString(result.detail);
  out.PutVector(result.f);
  out.Put(static_cast<std::uint8_t>(result.farkas_ray.has_value()));
  if (result.farkas_ray) out.PutVector(*result.farkas_ray);
  return out.Take();
}

LcpResult DecodeResult(const Bytes& payload, Index rows, std::uint32_t version) {
  ByteReader in(payload);
  LcpResult result;
  result.status = GetStatus(&in);
  result.iterations = in.Get<std::int64_t>("iterations");
  result.own_solve_s = in.Get<double>("seconds of the call");
  result.own_convert_s = in.Get<double>("seconds of conversion");
  if (version > 1) result.own_fresh_s = in.Get<double>("seconds from the arrays to f");
  result.detail = in.GetString("detail");
  result.f = in.GetVector("f", static_cast<std::uint64_t>(rows));
  if (in.Get<std::uint8_t>("has ray") != 0) {
    result.farkas_ray = in.GetVector("ray", static_cast<std::uint64_t>(rows));
  }
  in.Finish();
  return result;
}

Bytes Encode(std::span<const ProblemArrays> stream) {
  ByteWriter out;
  out.Put(static_cast<std::uint64_t>(stream.size()));
  for (const ProblemArrays& problem : stream) out.PutProblem(problem, kProtocolVersion);
  return out.Take();
}

std::vector<ProblemArrays> DecodeStream(const Bytes& payload) {
  ByteReader in(payload);
  const auto count = in.Get<std::uint64_t>("count");
  std::vector<ProblemArrays> stream;
  for (std::uint64_t k = 0; k < count; ++k) stream.push_back(in.GetProblem(kProtocolVersion));
  in.Finish();
  return stream;
}

Bytes Encode(const PassRequest& request) {
  ByteWriter out;
  out.Put(request.kind);
  out.Put(request.tolerance);
  out.Put(request.time_limit_s);
  out.Put(request.budget_s);
  out.Put(request.group);
  out.PutCounted(request.warm_up);
  out.PutCounted(request.order);
  if (request.kind == PassKind::kAgain) {
    for (const Eigen::VectorXd& b : request.other_b) out.PutVector(b);
  }
  return out.Take();
}

PassRequest DecodePass(const Bytes& payload, std::span<const ProblemArrays> stream) {
  ByteReader in(payload);
  PassRequest request;
  const auto kind = in.Get<std::uint8_t>("kind");
  if (kind > static_cast<std::uint8_t>(PassKind::kAgain)) throw std::runtime_error("protocol: unknown kind of pass");
  request.kind = static_cast<PassKind>(kind);
  request.tolerance = in.Get<double>("tolerance");
  request.time_limit_s = in.Get<double>("time limit");
  request.budget_s = in.Get<double>("budget");
  request.group = in.Get<std::uint32_t>("group");
  request.warm_up = in.GetCounted<std::uint32_t>("warm-up");
  request.order = in.GetCounted<std::uint32_t>("order");
  for (const std::vector<std::uint32_t>* list : {&request.warm_up, &request.order}) {
    for (const std::uint32_t index : *list) {
      if (index >= stream.size()) throw std::runtime_error("protocol: a pass names a problem that is not there");
    }
  }
  if (request.kind == PassKind::kAgain) {
    for (const std::uint32_t index : request.order) {
      request.other_b.push_back(in.GetVector("b", static_cast<std::uint64_t>(stream[index].rows)));
    }
  }
  in.Finish();
  return request;
}

Bytes Encode(const PassReply& reply) {
  ByteWriter out;
  out.Put(static_cast<std::uint32_t>(reply.size()));
  for (const PassEntry& entry : reply) {
    for (const double seconds : {entry.seconds, entry.problem_s, entry.prepare_s, entry.convert_s, entry.solve_s}) {
      out.Put(seconds);
    }
    out.PutString(std::string(ToString(entry.status)));
    out.PutVector(entry.f);
  }
  return out.Take();
}

PassReply DecodePassReply(const Bytes& payload, const PassRequest& request, std::span<const ProblemArrays> stream) {
  ByteReader in(payload);
  const auto count = in.Get<std::uint32_t>("count");
  if (count > request.order.size()) throw std::runtime_error("protocol: more answers than problems");
  PassReply reply(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    PassEntry& entry = reply[k];
    for (double* seconds : {&entry.seconds, &entry.problem_s, &entry.prepare_s, &entry.convert_s, &entry.solve_s}) {
      *seconds = in.Get<double>("seconds");
    }
    entry.status = GetStatus(&in);
    entry.f = in.GetVector("f", static_cast<std::uint64_t>(stream[request.order[k]].rows));
  }
  in.Finish();
  return reply;
}

}  // namespace lcpbench
