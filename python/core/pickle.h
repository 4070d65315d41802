#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "solvers/exact/rational.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/protocol/protocol.h"
#include "support/input_error.h"

namespace lcpbench::python {

/// An object as bytes, for pickle and copy: its parts one after another, numbers bit for bit. They are for the version
/// that wrote them. A struct's parts are told by an overload of Parts(io, value), for both directions.
class StateWriter {
 public:
  static constexpr bool kReads = false;
  void Move(void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  nanobind::bytes Take() const { return nanobind::bytes(bytes_.data(), bytes_.size()); }

 private:
  std::string bytes_;
};

/// The opposite. @throws InputError where bytes are missing
class StateReader {
 public:
  static constexpr bool kReads = true;
  explicit StateReader(const nanobind::bytes& state) : next_(state.c_str()), left_(state.size()) {}
  void Move(void* data, std::size_t size) {
    Require(size);
    std::memcpy(data, next_, size);
    next_ += size;
    left_ -= size;
  }
  void Require(std::size_t size) const {
    if (size > left_) throw InputError("state: ends too early");
  }

 private:
  const char* next_;
  std::size_t left_;
};

template <typename Io, typename... T>
void State(Io& io, T&... parts);

template <typename Io>
void Parts(Io& io, Rational& value) {
  std::string text = Io::kReads ? "" : value.str();
  State(io, text);
  if constexpr (Io::kReads) value = Rational(text);
}

template <typename Io>
void Parts(Io& io, LcpProblem& problem) {
  ProblemArrays arrays;
  Bytes bytes;
  if constexpr (!Io::kReads) {
    arrays = ProblemArrays::Of(problem);
    bytes = Encode(arrays);
  }
  State(io, arrays.id, arrays.facts.columns_per_body, bytes);
  if constexpr (Io::kReads) {
    ProblemArrays read = DecodeProblem(bytes);
    read.id = std::move(arrays.id);
    read.facts.columns_per_body = arrays.facts.columns_per_body;
    problem = LcpProblem::FromArrays(read);
  }
}

template <typename Io>
void Parts(Io& io, FarkasVerdict& v) {
  State(io, v.accepted, v.proved, v.b_dot_y, v.force_min, v.null_residual, v.reason);
}

template <typename Io>
void Parts(Io& io, Verdict& v) {
  State(io, v.requested, v.passes, v.at_floor, v.best_tier, v.false_success, v.model_rho, v.false_infeasible, v.farkas,
        v.reason, v.metrics.w);
  for (const MetricEntry& entry : AllMetrics()) State(io, v.metrics.*entry.value);
}

template <typename Io>
void Parts(Io& io, LcpResult& r) {
  State(io, r.status, r.f, r.model, r.friction_bounds, r.iterations, r.detail, r.own_solve_s, r.own_convert_s,
        r.own_fresh_s, r.factor_s, r.farkas_ray);
}

template <typename Io, typename T>
void OnePart(Io& io, T& part) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    io.Move(&part, sizeof part);
  } else if constexpr (requires { part.has_value(); }) {
    bool is_there = part.has_value();
    State(io, is_there);
    if constexpr (Io::kReads) {
      if (is_there) part.emplace();
    }
    if (is_there) State(io, *part);
  } else if constexpr (requires { part.resize(part.size()), part.data(); }) {
    auto size = static_cast<std::uint64_t>(part.size());
    State(io, size);
    if constexpr (Io::kReads) {
      io.Require(size);  // every entry has at least a byte
      part.resize(static_cast<decltype(part.size())>(size));
    }
    for (auto& item : part) State(io, item);
  } else {
    Parts(io, part);
  }
}

template <typename Io, typename... T>
void State(Io& io, T&... parts) {
  (OnePart(io, parts), ...);
}

/// What a problem is read into.
inline LcpProblem EmptyProblem() { return LcpProblem::FromDense("", {}, {}); }

/// Lets pickle and copy take a class.
/// @param blank  makes an object whose parts are read next
template <typename T, typename Blank>
void MakePicklable(nanobind::handle type, Blank blank) {
  auto of = nanobind::borrow<nanobind::class_<T>>(type);
  of.def("__getstate__", [](T& self) {
    StateWriter writer;
    State(writer, self);
    return writer.Take();
  });
  of.def("__setstate__", [blank](T& self, const nanobind::bytes& state) {
    StateReader reader(state);
    T read = blank();
    State(reader, read);
    new (&self) T(std::move(read));
  });
}

}  // namespace lcpbench::python
