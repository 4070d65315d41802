#include "solvers/peers/protocol/protocol.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "solvers/lcp/compressed_rows.h"
#include "support/input_error.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are written as memory holds them");

constexpr int kNotKnown = -1;

[[noreturn]] void Fail(const std::string& what) { throw std::runtime_error("protocol: " + what); }

// Writes what Fields tells.
class Writer {
 public:
  static constexpr bool kReads = false;

  // As a T on the wire.
  template <typename T>
  void As(const char* /*field*/, T value) {
    static_assert(std::is_trivially_copyable_v<T>);
    Array(&value, 1);
  }
  template <typename T>
  void Value(const char* field, const T& value) {
    As(field, value);
  }
  void Flag(const char* field, bool value) { As(field, static_cast<std::uint8_t>(value)); }
  template <typename Enum>
  void Choice(const char* field, Enum value, Enum /*last*/) {
    As(field, static_cast<std::uint8_t>(value));
  }
  void Text(const char* field, std::string_view text) {
    As(field, static_cast<std::uint32_t>(text.size()));
    Array(text.data(), text.size());
  }
  void Status(LcpStatus status) { Text("status", ToString(status)); }
  // A number of rows or columns, each of so many bytes at least in the fields that follow.
  void Size(const char* field, Index size, std::size_t /*bytes*/) { As(field, static_cast<std::uint64_t>(size)); }
  // So many numbers.
  template <typename List>
  void Numbers(const char* /*field*/, const List& values, std::uint64_t /*count*/) {
    Array(values.data(), static_cast<std::size_t>(values.size()));
  }
  void Counted(const char* field, const std::vector<std::uint32_t>& values) {
    As(field, static_cast<std::uint32_t>(values.size()));
    Numbers(field, values, 0);
  }
  void Optional(const char* field, const std::optional<Eigen::VectorXd>& values, Index /*count*/) {
    Flag(field, values.has_value());
    if (values) Numbers(field, *values, 0);
  }
  Bytes Take() { return std::move(bytes_); }

 private:
  template <typename T>
  void Array(const T* values, std::size_t count) {
    const auto* begin = reinterpret_cast<const char*>(values);
    bytes_.insert(bytes_.end(), begin, begin + count * sizeof(T));
  }

  Bytes bytes_;
};

// Reads the same.
class Reader {
 public:
  static constexpr bool kReads = true;

  explicit Reader(const Bytes& bytes) : bytes_(bytes) {}

  template <typename T>
  T Get(const char* field) {
    T value;
    std::memcpy(&value, Advance(field, 1, sizeof(T)), sizeof(T));
    return value;
  }
  template <typename T>
  void As(const char* field, T /*value*/) {
    Get<T>(field);
  }
  template <typename T>
  void Value(const char* field, T& value) {
    value = Get<T>(field);
  }
  void Flag(const char* field, bool& value) { value = Get<std::uint8_t>(field) != 0; }
  template <typename Enum>
  void Choice(const char* field, Enum& value, Enum last) {
    const auto code = Get<std::uint8_t>(field);
    if (code > static_cast<std::uint8_t>(last)) Fail(std::string("unknown ") + field);
    value = static_cast<Enum>(code);
  }
  void Text(const char* field, std::string& text) {
    const auto size = Get<std::uint32_t>(field);
    text.assign(Advance(field, size, 1), size);
  }
  void Status(LcpStatus& status) {
    std::string text;
    Text("status", text);
    try {
      status = LcpStatusFromString(text);
    } catch (const InputError&) {
      constexpr std::size_t kLongest = 60;
      Fail("unknown status '" + Excerpt(text, kLongest) + "'");
    }
  }
  void Size(const char* field, Index& size, std::size_t bytes) {
    const auto count = Get<std::uint64_t>(field);
    RequireRoom(field, count, bytes);
    size = static_cast<Index>(count);
  }
  template <typename List>
  void Numbers(const char* field, List& values, std::uint64_t count) {
    const std::size_t size = sizeof(*values.data());
    const char* begin = Advance(field, count, size);
    values.resize(static_cast<decltype(values.size())>(count));
    if (count > 0) std::memcpy(values.data(), begin, static_cast<std::size_t>(count) * size);
  }
  void Counted(const char* field, std::vector<std::uint32_t>& values) {
    Numbers(field, values, Get<std::uint32_t>(field));
  }
  void Optional(const char* field, std::optional<Eigen::VectorXd>& values, Index count) {
    if (Get<std::uint8_t>(field) != 0) Numbers(field, values.emplace(), static_cast<std::uint64_t>(count));
  }
  void Finish() const {
    if (at_ != bytes_.size()) Fail("a message is longer than its fields");
  }

 private:
  // What is to come must fit in what is left: no claim makes room for itself.
  void RequireRoom(const char* field, std::uint64_t count, std::size_t size) const {
    // By division, so that nothing can overflow.
    if (count > (bytes_.size() - at_) / size) Fail(std::string("a message ends within its field '") + field + "'");
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

// What follows describes every message once, for both directions: a message is const where it is written.
template <typename T, typename Message>
concept Like = std::same_as<std::remove_const_t<T>, Message>;

template <typename Io>
void Fields(Io& io, Like<Hello> auto& hello) {
  io.Value("version", hello.version);
  if (Io::kReads && (hello.version < 1 || hello.version > kProtocolVersion)) {
    Fail("expected version 1 to " + std::to_string(kProtocolVersion) + ", found " + std::to_string(hello.version));
  }
  if (hello.version == 1) io.Choice("form", hello.form, WantedForm::kAsGiven);
  io.Text("name", hello.name);
  io.Text("version", hello.library_version);
  io.Text("licence", hello.licence);
}

template <typename Io>
void Fields(Io& io, Like<FrictionRow> auto& row) {
  io.Value("row", row.row);
  io.Value("normal row", row.normal);
  io.Value("mu", row.mu);
  io.Value("slip", row.slip);
}

template <typename Io>
void Fields(Io& io, Like<BoundedRow> auto& row) {
  io.Value("row", row.row);
  io.Value("lower", row.lower);
  io.Value("upper", row.upper);
}

// @param bytes  of one row
template <typename Io, typename Rows>
void LawRows(Io& io, const char* field, Rows& rows, std::size_t bytes) {
  auto count = static_cast<Index>(rows.size());
  io.Size(field, count, bytes);
  if constexpr (Io::kReads) rows.resize(static_cast<std::size_t>(count));
  for (auto& row : rows) Fields(io, row);
}

template <typename Io, Like<ProblemArrays> Problem>
void Fields(Io& io, Problem& problem, std::uint32_t version) {
  io.Size("n", problem.rows, sizeof(double) + 1);
  const auto n = static_cast<std::uint64_t>(problem.rows);
  io.Choice("form of A", problem.form, MatrixForm::kFactors);
  io.Flag("symmetric", problem.facts.symmetric);
  io.Flag("positive semidefinite", problem.facts.positive_semidefinite);
  if (version > 1) {
    auto rank = static_cast<std::int64_t>(problem.facts.rank.value_or(kNotKnown));
    auto unique = static_cast<std::int8_t>(problem.facts.f_unique ? int{*problem.facts.f_unique} : kNotKnown);
    io.Value("rank", rank);
    io.Value("unique", unique);
    if constexpr (Io::kReads) {
      if (rank >= 0) problem.facts.rank = static_cast<Index>(rank);
      if (unique >= 0) problem.facts.f_unique = unique != 0;
    }
  }
  io.Numbers("b", problem.b, n);
  if constexpr (Io::kReads) {
    problem.columns = problem.rows;
    io.Numbers("bilateral", problem.bilateral, n);
    const auto is_set = [](unsigned char flag) { return flag != 0; };
    if (std::none_of(problem.bilateral.begin(), problem.bilateral.end(), is_set)) problem.bilateral.clear();
  } else {
    io.Numbers("bilateral", problem.bilateral.empty() ? std::vector<unsigned char>(n, 0) : problem.bilateral, n);
  }
  if (version >= kFirstWithLaws) {
    LawRows(io, "friction rows", problem.friction, sizeof(std::int64_t) * 2 + sizeof(double) + 1);
    LawRows(io, "bounded rows", problem.bounded, sizeof(std::int64_t) + 2 * sizeof(double));
  } else if (!problem.friction.empty() || !problem.bounded.empty()) {
    Fail("workers of versions before " + std::to_string(kFirstWithLaws) + " take no friction and no bounded rows");
  }
  if (problem.form == MatrixForm::kDense) {
    if (n > 0xFFFFFFFFU) Fail("n is too large for a dense matrix");
    io.Numbers("A", problem.value, n * n);
    return;
  }
  const bool factors = problem.form == MatrixForm::kFactors;
  if (factors) io.Size("columns", problem.columns, sizeof(double));
  if (factors && version > 2) io.Value("columns per body", problem.facts.columns_per_body);
  auto entries = static_cast<std::uint64_t>(problem.value.size());
  io.Value("entries", entries);
  io.Numbers("row starts", problem.row_start, n + 1);
  io.Numbers("columns", problem.column, entries);
  io.Numbers("values", problem.value, entries);
  if (Io::kReads) {
    std::string why = WhyNotStarts(problem.row_start, static_cast<Index>(entries), "row starts", "entries");
    if (why.empty()) why = WhyNotColumns(problem.row_start, problem.column, problem.columns, "columns");
    if (!why.empty()) Fail((factors ? "J: " : "A: ") + why);
  }
  if (factors) io.Numbers("inverse mass", problem.inverse_mass, static_cast<std::uint64_t>(problem.columns));
}

template <typename Io>
void Fields(Io& io, Like<Eigen::VectorXd> auto& b, Index rows) {
  io.Numbers("b", b, static_cast<std::uint64_t>(rows));
}

template <typename Io>
void Fields(Io& io, Like<Prepared> auto& prepared) {
  io.Value("seconds", prepared.convert_s);
  io.Text("why", prepared.why_unsupported);
}

template <typename Io>
void Fields(Io& io, Like<SolveRequest> auto& request, Index rows, std::uint32_t version) {
  io.Value("tolerance", request.tolerance);
  io.Value("time limit", request.time_limit_s);
  io.Value("iteration limit", request.max_iterations);
  if (version == 1) {
    io.As("one", std::uint64_t{1});
  } else {
    io.Flag("parts wanted", request.time_parts);
  }
  io.Optional("start", request.start, rows);
}

template <typename Io>
void Fields(Io& io, Like<LcpResult> auto& result, Index rows, std::uint32_t version) {
  io.Status(result.status);
  io.Value("iterations", result.iterations);
  io.Value("seconds of the call", result.own_solve_s);
  io.Value("seconds of conversion", result.own_convert_s);
  if (version > 1) io.Value("seconds from the arrays to f", result.own_fresh_s);
  io.Text("detail", result.detail);
  io.Numbers("f", result.f, static_cast<std::uint64_t>(rows));
  io.Optional("ray", result.farkas_ray, rows);
  if (version < kFirstWithLaws) return;
  io.Choice("model", result.model, FrictionModel::kFrozenBounds);
  if (result.model != FrictionModel::kFrozenBounds) return;
  io.Numbers("friction bounds", result.friction_bounds, static_cast<std::uint64_t>(rows));
}

template <typename Io>
void Fields(Io& io, Like<PassRequest> auto& request, std::span<const ProblemArrays> stream) {
  io.Choice("kind of pass", request.kind, PassKind::kAgain);
  io.Value("tolerance", request.tolerance);
  io.Value("time limit", request.time_limit_s);
  io.Value("time to settle", request.settle_s);
  io.Counted("warm-up", request.warm_up);
  io.Counted("order", request.order);
  if constexpr (Io::kReads) {
    for (const std::vector<std::uint32_t>* list : {&request.warm_up, &request.order}) {
      for (const std::uint32_t index : *list) {
        if (index >= stream.size()) Fail("a pass names a problem that is not there");
      }
    }
    if (request.kind == PassKind::kAgain) request.other_b.resize(request.order.size());
  }
  if (request.kind != PassKind::kAgain) return;
  for (std::size_t k = 0; k < request.other_b.size(); ++k) {
    io.Numbers("b", request.other_b[k], Io::kReads ? static_cast<std::uint64_t>(stream[request.order[k]].rows) : 0);
  }
}

template <typename Io>
void Fields(Io& io, Like<PassEntry> auto& entry, Index rows) {
  for (auto* seconds : {&entry.seconds, &entry.problem_s, &entry.prepare_s, &entry.convert_s, &entry.solve_s}) {
    io.Value("seconds", *seconds);
  }
  io.Status(entry.status);
  io.Numbers("f", entry.f, static_cast<std::uint64_t>(rows));
}

template <typename Io>
void Fields(Io& io, Like<Disturbance> auto& found) {
  io.Value("seconds of the probe", found.probe_s);
  io.Value("share of the processor", found.cpu_share);
  io.Value("switches", found.switches);
}

template <typename Message, typename... Context>
Bytes Written(const Message& message, const Context&... context) {
  Writer out;
  Fields(out, message, context...);
  return out.Take();
}

template <typename Message, typename... Context>
Message Read(const Bytes& payload, const Context&... context) {
  Reader in(payload);
  Message message;
  Fields(in, message, context...);
  in.Finish();
  return message;
}

}  // namespace

Bytes EncodeRefusal(const std::string& why) { return {why.begin(), why.end()}; }
std::string DecodeRefusal(const Bytes& payload) { return {payload.begin(), payload.end()}; }
Bytes Encode(const Hello& hello) { return Written(hello); }
Bytes Encode(const ProblemArrays& problem, std::uint32_t version) { return Written(problem, version); }
Bytes Encode(const Eigen::VectorXd& b) { return Written(b, b.size()); }
Bytes Encode(const Prepared& prepared) { return Written(prepared); }
Bytes Encode(const SolveRequest& request, std::uint32_t version) { return Written(request, Index{0}, version); }
Bytes Encode(const LcpResult& result, std::uint32_t version) { return Written(result, result.f.size(), version); }
Bytes Encode(const PassRequest& request) { return Written(request, std::span<const ProblemArrays>()); }

Bytes Encode(std::span<const ProblemArrays> stream, std::uint32_t version) {
  Writer out;
  out.As("count", static_cast<std::uint64_t>(stream.size()));
  for (const ProblemArrays& problem : stream) Fields(out, problem, version);
  return out.Take();
}

Bytes Encode(const PassReply& reply) {
  Writer out;
  out.As("count", static_cast<std::uint32_t>(reply.entries.size()));
  for (const PassEntry& entry : reply.entries) Fields(out, entry, entry.f.size());
  const Disturbance disturbance = reply.disturbance.value_or(Disturbance());
  Fields(out, disturbance);
  return out.Take();
}

Hello DecodeHello(const Bytes& payload) { return Read<Hello>(payload); }
ProblemArrays DecodeProblem(const Bytes& payload, std::uint32_t version) {
  return Read<ProblemArrays>(payload, version);
}
Eigen::VectorXd DecodeOtherB(const Bytes& payload, Index rows) { return Read<Eigen::VectorXd>(payload, rows); }
Prepared DecodePrepared(const Bytes& payload) { return Read<Prepared>(payload); }
SolveRequest DecodeSolve(const Bytes& payload, Index rows, std::uint32_t version) {
  return Read<SolveRequest>(payload, rows, version);
}
LcpResult DecodeResult(const Bytes& payload, Index rows, std::uint32_t version) {
  return Read<LcpResult>(payload, rows, version);
}
PassRequest DecodePass(const Bytes& payload, std::span<const ProblemArrays> stream) {
  return Read<PassRequest>(payload, stream);
}

std::vector<ProblemArrays> DecodeStream(const Bytes& payload, std::uint32_t version) {
  Reader in(payload);
  const auto count = in.Get<std::uint64_t>("count");
  std::vector<ProblemArrays> stream;
  for (std::uint64_t k = 0; k < count; ++k) Fields(in, stream.emplace_back(), version);
  in.Finish();
  return stream;
}

PassReply DecodePassReply(const Bytes& payload, const PassRequest& request, std::span<const ProblemArrays> stream) {
  Reader in(payload);
  const auto count = in.Get<std::uint32_t>("count");
  if (count != request.order.size()) Fail("expected an answer to each problem of the pass");
  PassReply reply;
  reply.entries.resize(count);
  for (std::uint32_t k = 0; k < count; ++k) Fields(in, reply.entries[k], stream[request.order[k]].rows);
  const Disturbance& found = reply.disturbance.emplace();
  Fields(in, *reply.disturbance);
  in.Finish();
  const bool is_known =
      std::isfinite(found.probe_s) && found.probe_s > 0 && found.cpu_share >= 0 && found.cpu_share <= 1;
  if (!is_known) reply.disturbance.reset();
  return reply;
}

namespace {

constexpr std::size_t kHeaderSize = sizeof(std::uint32_t) + sizeof(std::uint64_t);
// Payloads grow by this much, later by their own size at a time, so that a promise alone allocates little.
constexpr std::size_t kChunk = std::size_t{1} << 16U;

}  // namespace

Transfer WriteFrame(int fd, MessageType type, const Bytes& payload, double until) {
  char header[kHeaderSize] = {};
  const auto length = static_cast<std::uint64_t>(payload.size());
  std::memcpy(header, &type, sizeof type);
  std::memcpy(header + sizeof type, &length, sizeof length);
  const Transfer outcome = WriteAll(fd, header, kHeaderSize, until);
  return outcome == Transfer::kDone ? WriteAll(fd, payload.data(), payload.size(), until) : outcome;
}

Transfer ReadFrame(int fd, MessageType* type, Bytes* payload, double until) {
  char header[kHeaderSize] = {};
  Transfer outcome = ReadAll(fd, header, kHeaderSize, until);
  std::uint32_t code = 0;
  std::uint64_t length = 0;
  std::memcpy(&code, header, sizeof code);
  std::memcpy(&length, header + sizeof code, sizeof length);
  const bool known = code <= static_cast<std::uint32_t>(MessageType::kRefusal) && length <= kLargestPayload;
  *type = known ? static_cast<MessageType>(code) : MessageType::kNone;
  payload->clear();
  while (outcome == Transfer::kDone && *type != MessageType::kNone && payload->size() < length) {
    const std::size_t begin = payload->size();
    const std::size_t size = std::min(std::max(kChunk, begin), static_cast<std::size_t>(length) - begin);
    payload->resize(begin + size);
    outcome = ReadAll(fd, payload->data() + begin, size, until);
  }
  return outcome;
}

}  // namespace lcpbench
