#include "solvers/first_order/sweeps/colouring.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

namespace lcpbench {
namespace {

constexpr size_t At(Index i) { return static_cast<size_t>(i); }

// As many colours as a block has rows always suffice.
class ColourSet {
 public:
  void Insert(Index colour) { words_[At(colour / kBits)] |= std::uint64_t{1} << (colour % kBits); }
  void Insert(const ColourSet& other) {
    for (size_t word = 0; word < words_.size(); ++word) words_[word] |= other.words_[word];
  }
  Index FirstAbsent() const {
    size_t word = 0;
    while (words_[word] == ~std::uint64_t{0}) ++word;
    return static_cast<Index>(word) * kBits + std::countr_one(words_[word]);
  }

 private:
  static constexpr Index kBits = 64;
  std::array<std::uint64_t, At(kColourBlock / kBits)> words_{};
};

class BodyColours {
 public:
  explicit BodyColours(const LcpProblem& problem) : problem_(problem), on_body_(At(problem.J().cols() / 3 + 1)) {}

  ColourSet Forbidden(Index row) const {
    ColourSet forbidden;
    ForBodies(row, [&](Index body) { forbidden.Insert(on_body_[At(body)]); });
    return forbidden;
  }
  void Give(Index row, Index colour) {
    ForBodies(row, [&](Index body) { on_body_[At(body)].Insert(colour); });
  }
  void Forget(Index row) {
    ForBodies(row, [&](Index body) { on_body_[At(body)] = {}; });
  }

 private:
  template <typename Do>
  void ForBodies(Index row, const Do& action) const {
    Index last = -1;
    for (SparseMatrix::InnerIterator it(problem_.J(), row); it; ++it) {
      if (it.col() / 3 == last || it.value() == 0 || problem_.inverse_mass()[it.col()] == 0) continue;
      last = it.col() / 3;
      action(last);
    }
  }

  const LcpProblem& problem_;
  std::vector<ColourSet> on_body_;
};

class EntryColours {
 public:
  explicit EntryColours(const LcpProblem& problem) : A_(problem.SparseA()), colour_(At(problem.size()), kNone) {}

  ColourSet Forbidden(Index row) const {
    ColourSet forbidden;
    for (SparseMatrix::InnerIterator it(A_, row); it; ++it) {
      if (it.value() != 0 && colour_[At(it.col())] != kNone) forbidden.Insert(colour_[At(it.col())]);
    }
    return forbidden;
  }
  void Give(Index row, Index colour) { colour_[At(row)] = colour; }
  void Forget(Index row) { colour_[At(row)] = kNone; }

 private:
  static constexpr Index kNone = -1;
  const SparseMatrix& A_;
  std::vector<Index> colour_;
};

template <typename Colours>
std::vector<Index> Order(Index n, Colours colours) {
  std::vector<Index> order(At(n));
  std::iota(order.begin(), order.end(), 0);
  std::vector<Index> colour(At(n));
  for (Index begin = 0; begin < n; begin += kColourBlock) {
    const Index end = std::min(n, begin + kColourBlock);
    for (Index row = begin; row < end; ++row) {
      colour[At(row)] = colours.Forbidden(row).FirstAbsent();
      colours.Give(row, colour[At(row)]);
    }
    for (Index row = begin; row < end; ++row) colours.Forget(row);
    std::sort(order.begin() + begin, order.begin() + end,
              [&](Index a, Index b) { return colour[At(a)] != colour[At(b)] ? colour[At(a)] < colour[At(b)] : a < b; });
  }
  return order;
}

}  // namespace

std::vector<Index> ColouredOrder(const LcpProblem& problem, bool by_bodies) {
  return by_bodies ? Order(problem.size(), BodyColours(problem)) : Order(problem.size(), EntryColours(problem));
}

}  // namespace lcpbench
