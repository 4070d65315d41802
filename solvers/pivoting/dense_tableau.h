#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/linear_algebra/vector_register.h"
#include "solvers/pivoting/tableau_work.h"

namespace lcpbench {
namespace {

/// The kernel of SmallPivoting.
///
/// The tableau T starts as A, and q as b. Exchanging f_r and w_r, with x column r, a = T_rr and y = x / a:
///     T_ij -= x_i y_j,   T_ir = x_i / |a|,   T_rr = -1 / a,   and q_i, q_r as if q were another column,
/// which is its own inverse and keeps T symmetric: q_i = w_i outside F and -f_i in F, -T_FF = A_FF^-1. The diagonal is
/// kept apart. Up to kUnrolled registers a row, all of T is kept and loops are unrolled; above, of each row the
/// registers up to its diagonal's, the others being gathered from the column, which costs more than it saves in short
/// rows.
///
/// Above kRowsAtOnce rows only q, the diagonal and row r are those after an exchange: the other rows wait for the next
/// one, because most of what it costs to change a row is to read and to write it.
class DenseTableau {
 public:
  explicit DenseTableau(TableauWork* work)
      : t_(*work),
        n_(work->n),
        stride_(work->stride),
        registers_(work->stride / kWidth),
        waiting_{-1, work->exchange[0], work->exchange[1]},
        latest_{-1, work->exchange[2], work->exchange[3]} {}

  /// False, with nothing written, unless all of the diagonal is positive.
  bool Solve() {
    t_.pivots = 0;
    if (!Scale()) return false;
    ScaleMatrix();
    SolveAndCheck();
    return true;
  }

 private:
  using L = Lanes;
  using V = L::V;
  using M = L::M;
  using Index = std::ptrdiff_t;
  static constexpr int kWidth = L::kWidth;
  static constexpr int kRowsAtOnce = 16;
  static constexpr int kUnrolled = 8;
  static constexpr int kColumns[kUnrolled] = {0, 1, 2, 3, 4, 5, 6, 7};
  // Above, so many registers of a row are worked on at once, of those that change.
  static constexpr int kTile = 4;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static constexpr double kLeastPivot = tableau::kLeastPivot;
  static constexpr double kNoise = tableau::kNoise;
  static constexpr double kRounding = tableau::kRounding;
  // Rates of change below this, of scaled numbers, are rounding.
  static constexpr double kLeastRate = 1e-12;
  // rho up to which a guess of the active set counts as right.
  static constexpr double kRightRho = 1e-13;
  // Active sets that are tried before the tableau: the guess, and what its violated rows make of it.
  static constexpr int kMaxGuesses = 2;
  // Some microseconds of them.
  static constexpr int kPivotsPerClockRead = 8;

  // x and y of an exchange of a row, x_r = 0 and y_r = -1 / |a|; row -1: none.
  struct Exchange {
    int row;
    double* x;
    double* y;
  };

  // Rows in ascending order, to be taken one by one: of a range, up to 64 by bits, or from a list, which is faster
  // where they are walked through more than once.
  struct RowRange {
    int begin;
    int end;
    bool any() const { return begin != end; }
    int first() const { return begin; }
    void Drop() { ++begin; }
  };
  struct RowBits {
    std::uint64_t bits;
    bool any() const { return bits != 0; }
    int first() const { return __builtin_ctzll(bits); }
    void Drop() { bits &= bits - 1; }
  };
  struct RowList {
    const int* begin;
    const int* end;
    bool any() const { return begin != end; }
    int first() const { return *begin; }
    void Drop() { ++begin; }
  };

  static double Abs(double x) { return __builtin_fabs(x); }
  static double Larger(double a, double b) { return a > b ? a : b; }
  static V Load(const double* from, int v) { return L::Load(from + Index{v} * kWidth); }
  static void Store(double* to, int v, V value) { L::Store(to + Index{v} * kWidth, value); }
  double* RowOf(double* matrix, int i) const { return matrix + Index{i} * stride_; }
  bool is_active(int i) const { return t_.side[i] < 0; }
  bool is_joint(int i) const { return t_.least_force[i] < 0; }
  bool is_violated(int i) const { return t_.q[i] * t_.weight[i] < -noise_; }
  bool HasClosedForm() const { return n_ <= 2 && t_.rule == TableauRule::kMostViolated; }
  void Fill(double* to, double value) const {
    for (int v = 0; v < registers_; ++v) Store(to, v, L::Set(value));
  }

  bool Scale() {
    V largest = L::Set(0);
    V squares = L::Set(0);
    M is_right = L::FromBits(~0U);
    for (int v = 0; v < registers_; ++v) {
      const V d = Load(t_.diagonal, v);
      is_right &= L::Set(0) < d;
      const V scale = L::ScaleOfDiagonal(d);
      const V one = d * scale * scale;
      const V root = L::Sqrt(one);
      const V inverse = L::Set(1) / root;
      const V b = Load(t_.b, v) * scale;
      largest = L::Max(L::Abs(b), largest);
      squares = L::Fma(b * inverse, b * inverse, squares);
      Store(t_.scale, v, scale);
      Store(t_.diagonal, v, one);
      Store(t_.pivot, v, one);
      Store(t_.root, v, root);
      Store(t_.inverse_root, v, inverse);
      Store(t_.weight, v, inverse);
      Store(t_.side, v, L::Set(1));
      Store(t_.least_force, v, L::Set(0));
      Store(t_.blocked_weight, v, L::Set(0));
      Store(t_.b, v, b);
    }
    const V scale = L::ScaleOfLargest(L::Set(-L::Least(-largest)));
    for (int v = 0; v < registers_; ++v) {
      const V b = Load(t_.b, v) * scale;
      Store(t_.b, v, b);
      Store(t_.q, v, b);
    }
    t_.b_scale = scale[0];
    const double norm = L::Sum(squares);
    b_norm_ = norm == 0 ? 1 : __builtin_sqrt(norm) * t_.b_scale;
    for (int k = 0; k < t_.joint_count; ++k) {
      t_.weight[t_.joints[k]] = 0;
      t_.least_force[t_.joints[k]] = -kInfinity;
    }
    return !L::Any(~is_right);
  }

  // Also the tableau; where columns are gathered, they end with zeros.
  void ScaleMatrix() {
    for (int i = 0; i < n_; ++i) {
      const V scale = L::Set(t_.scale[i]);
      double* const row = RowOf(t_.matrix, i);
      double* const to = RowOf(t_.tableau, i);
      const int kept = registers_ <= kUnrolled ? registers_ : i / kWidth + 1;
      for (int v = 0; v < registers_; ++v) {
        const V a = Load(row, v) * scale * Load(t_.scale, v);
        Store(row, v, a);
        if (v < kept) Store(to, v, a);
      }
    }
    if (registers_ <= kUnrolled) return;
    for (int v = n_ * registers_; v < stride_ * registers_; ++v) Store(t_.tableau, v, L::Set(0));
  }

  // Entries of row r of the tableau, but for its diagonal.
  template <int count>
  V EntriesOf(int r, int v) const {
    if (count > 0 || v <= r / kWidth) return Load(RowOf(t_.tableau, r), v);
    return L::Gather(RowOf(t_.tableau, v * kWidth) + r, stride_);
  }

  // The same after the exchange that waits.
  template <int count>
  V CurrentEntriesOf(int r, int v, const V& at) const {
    const V x = EntriesOf<count>(r, v);
    if (waiting_.row < 0) return x;
    const V others = L::Without(L::Equal(at, L::Set(waiting_.row)), x);
    return L::Fnma(L::Set(waiting_.x[r]), Load(waiting_.y, v), others);
  }

  // Exchanges f_r and w_r. False if rounding is all that the pivot is made of.
  template <int count>
  bool Pivot(int r) {
    const double a = t_.pivot[r];
    const bool enters = !is_active(r);
    if (!((enters ? a : -a) > (enters ? kLeastPivot * t_.diagonal[r] : 0))) return false;
    ++t_.pivots;
    if (r == waiting_.row) CatchUp<count>();
    ExchangeRow<count>(r, 1 / a, enters);
    if (n_ <= kRowsAtOnce) {
      UpdateAllRows<count>(latest_);
    } else if (waiting_.row < 0) {
      const Exchange free = waiting_;
      waiting_ = latest_;
      latest_ = free;
    } else {
      Update<count, true>(waiting_, latest_);
      waiting_.row = -1;
    }
    return true;
  }

  // Row r, q and the diagonal after the exchange.
  template <int count>
  void ExchangeRow(int r, double inverse, bool enters) {
    latest_.row = r;
    const double size = Abs(inverse);
    const double q_r = t_.q[r];
    const bool any_waits = waiting_.row >= 0;
    const V row_r = L::Set(r);
    V at = L::Indices();
    for (int v = 0; v < Registers<count>(); ++v) {
      const V x = CurrentEntriesOf<count>(r, v, at);
      const V y = x * L::Set(inverse);
      Store(latest_.x, v, x);
      Store(latest_.y, v, y);
      if (count > 0 || v <= r / kWidth) Store(RowOf(t_.tableau, r), v, x * L::Set(size));
      const V q = L::Fnma(x, L::Set(q_r * inverse), Load(t_.q, v));
      Store(t_.q, v, L::Select(L::Equal(at, row_r), L::Set(q_r * size), q));
      Store(t_.pivot, v, L::Fnma(x, y, Load(t_.pivot, v)));
      at = at + L::Set(kWidth);
    }
    SetEntry(t_.weight, r, is_joint(r) ? 0 : enters ? -t_.root[r] : t_.inverse_root[r]);
    SetEntry(t_.pivot, r, -inverse);
    latest_.x[r] = 0;
    SetEntry(latest_.y, r, -size);
    // Column r will be all that the second exchange makes it, and row r is so already.
    if (any_waits) {
      waiting_.x[r] = 0;
      SetEntry(waiting_.y, r, 0);
    }
    t_.side[r] = enters ? -1 : 1;
    if (t_.rule == TableauRule::kAlongPath) ExchangeCover(r, inverse);
  }

  // Changes the cover as an exchange changes q.
  void ExchangeCover(int r, double inverse) {
    const double cover = t_.cover[r];
    for (int v = 0; v < registers_; ++v) {
      Store(t_.cover, v, L::Fnma(Load(latest_.x, v), L::Set(cover * inverse), Load(t_.cover, v)));
    }
    SetEntry(t_.cover, r, cover * Abs(inverse));
  }

  // By its register: one that is read soon after one of its doubles was written has to wait.
  static void SetEntry(double* of, int i, double value) {
    const int v = i / kWidth;
    Store(of, v, L::Select(L::Equal(L::Indices(), L::Set(i % kWidth)), L::Set(value), Load(of, v)));
  }

  // The tableau after one exchange, or after two, one after the other, whose own row is so already.
  template <int count, bool two>
  void Update(const Exchange& first, const Exchange& second) {
    const int without = two ? second.row : -1;
    if constexpr (count > 0) {
      UpdateColumns<count, two>(first, second, kColumns, RowBits{BitsOfRows<count>(first.y, second.y, without)});
    } else {
      const Places places = ListNonzero(first.y, second.y, without);
      UpdateFrom<kTile, two>(first, second, places.column, places.last_column, places.rows);
    }
  }

  // The tableau after one exchange. Where rows are this short, it takes longer to ask which of them change.
  template <int count>
  void UpdateAllRows(const Exchange& exchange) {
    static_assert(kRowsAtOnce <= kUnrolled * kWidth);
    if constexpr (count > 0) UpdateColumns<count, false>(exchange, exchange, kColumns, RowRange{0, n_});
  }

  // The tableau after all exchanges.
  template <int count = 0>
  void CatchUp() {
    if (waiting_.row >= 0) Update<count, false>(waiting_, waiting_);
    waiting_.row = -1;
  }

  static constexpr int kBits = 64;
  static std::uint64_t BitOf(int row) { return std::uint64_t{1} << (row % kBits); }

  // Rows of 64 where a or b is not 0, but for one.
  template <int count>
  std::uint64_t BitsOfRows(const double* a, const double* b, int without) const {
    static_assert(count * kWidth <= kBits);
    std::uint64_t bits = 0;
    for (int v = 0; v < count; ++v) bits |= std::uint64_t{NonzeroOf(a, b, v)} << (v * kWidth);
    return without < 0 ? bits : bits & ~BitOf(without);
  }
  static unsigned NonzeroOf(const double* a, const double* b, int v) {
    return L::Bits((Load(a, v) != L::Set(0)) | (Load(b, v) != L::Set(0)));
  }

  // Places of rows, and the registers that they are in.
  struct Places {
    const int* column;
    const int* last_column;
    RowList rows;
  };
  Places ListNonzero(const double* a, const double* b, int without) const {
    int* column = t_.columns;
    int* row = t_.rows;
    for (int begin = 0; begin < registers_; begin += kBits / kWidth) {
      std::uint64_t bits = 0;
      for (int v = begin; v < registers_ && v < begin + kBits / kWidth; ++v) {
        const std::uint64_t nonzero = NonzeroOf(a, b, v);
        *column = v;
        column += nonzero != 0 ? 1 : 0;
        bits |= nonzero << ((v - begin) * kWidth);
      }
      if (without >= 0 && without / kBits == begin * kWidth / kBits) bits &= ~BitOf(without);
      for (; bits != 0; bits &= bits - 1) *row++ = begin * kWidth + __builtin_ctzll(bits);
    }
    return {t_.columns, column, {t_.rows, row}};
  }

  // So many registers of the listed ones at a time, of the rows that reach them.
  template <int registers, bool two>
  void UpdateFrom(const Exchange& first, const Exchange& second, const int* column, const int* end, RowList rows) {
    for (; end - column >= registers; column += registers) {
      while (rows.any() && rows.first() < *column * kWidth) rows.Drop();
      UpdateColumns<registers, two>(first, second, column, rows);
    }
    if constexpr (registers > 1) UpdateFrom<registers - 1, two>(first, second, column, end, rows);
  }
  template <int registers, bool two, typename SetOfRows>
  void UpdateColumns(const Exchange& first, const Exchange& second, const int* column, SetOfRows rows) {
    V y[registers];
    V y2[registers];
    L::Choice is_column[registers];
    Index offset[registers];
    for (int k = 0; k < registers; ++k) {
      const int v = column[k];
      y[k] = Load(first.y, v);
      y2[k] = Load(second.y, v);
      offset[k] = Index{v} * kWidth;
      const V at = L::Indices() + L::Set(v * kWidth);
      is_column[k] = L::Either(L::Equal(at, L::Set(first.row)), L::Equal(at, L::Set(second.row)));
    }
    for (; rows.any(); rows.Drop()) {
      const int i = rows.first();
      double* const row = RowOf(t_.tableau, i);
      const V x = L::Set(first.x[i]);
      const V x2 = L::Set(second.x[i]);
      for (int k = 0; k < registers; ++k) {
        V entries = L::Fnma(x, y[k], L::Without(is_column[k], L::Load(row + offset[k])));
        if constexpr (two) entries = L::Fnma(x2, y2[k], entries);
        L::Store(row + offset[k], entries);
      }
    }
  }

  // -1 if there is none.
  template <int count>
  int MostViolated() const {
    // The last bits of a double carry the row, so that one minimum finds both; a violation is not needed to 1e-13. Of
    // equal ones, which negative numbers order by larger bits, the least row wins.
    constexpr long long kRowBits = 127;
    M row = kRowBits - reinterpret_cast<M>(L::Indices() + L::Set(0x1p52)) + reinterpret_cast<M>(L::Set(0x1p52));
    V least = L::Set(0);
    for (int v = 0; v < Registers<count>(); ++v) {
      const V violation = Load(t_.q, v) * Load(t_.weight, v);
      least = L::Min(reinterpret_cast<V>((reinterpret_cast<M>(violation) & ~kRowBits) | row), least);
      row -= kWidth;
    }
    const double worst = L::Least(least);
    if (!(worst < -noise_)) return -1;
    long long bits;
    __builtin_memcpy(&bits, &worst, sizeof bits);
    return static_cast<int>(kRowBits - (bits & kRowBits));
  }

  int FirstViolated() const {
    for (int i = 0; i < n_; ++i) {
      if (is_violated(i)) return i;
    }
    return -1;
  }

  // False if the limit of pivots or the deadline came first, or the rule of the method does not get ahead.
  template <int count>
  bool DrivePivots() {
    noise_ = kNoise;
    for (int k = 0; k < t_.joint_count; ++k) Pivot<count>(t_.joints[k]);
    for (int k = 0; k < t_.guess_count; ++k) {
      if (!is_active(t_.guess[k])) Pivot<count>(t_.guess[k]);
    }
    // The loop below mends what rounding leaves violated.
    if (t_.rule == TableauRule::kDriven && !DriveRows<count>()) return false;
    if (t_.rule == TableauRule::kAlongPath && !FollowPath<count>()) return false;
    const int greedy = 2 * n_;
    for (bool any_blocked = false;;) {
      const int r = t_.pivots > greedy ? FirstViolated() : MostViolated<count>();
      if (r < 0 && (!any_blocked || !TakePlace<count>())) return true;
      if (IsOver()) return false;
      if (r >= 0 && !Pivot<count>(r)) {
        Block(r);
        any_blocked = true;
        continue;
      }
      if (any_blocked) {  // F has changed, and what depends on it
        for (int v = 0; v < registers_; ++v) Store(t_.weight, v, Load(t_.weight, v) + Load(t_.blocked_weight, v));
        Fill(t_.blocked_weight, 0);
        any_blocked = false;
      }
      if (r >= 0) noise_ = Larger(noise_, kNoise * Abs(t_.q[r]));
    }
  }

  // What takes more is degenerate: profile pivoting ends sooner. A method that is asked for by name goes on.
  int MostPivots() const { return t_.rule == TableauRule::kMostViolated ? 2 * n_ + 40 : 6 * n_ + 20; }

  // Whether the limit of pivots or the deadline has come.
  bool IsOver() const {
    const bool is_late = t_.clock != nullptr && t_.pivots % kPivotsPerClockRead == 0 && t_.is_late(t_.clock);
    return is_late || t_.pivots >= MostPivots();
  }

  // Makes rows right one after the other; those not reached yet have weight 0 and may be as they are. False where a
  // row depends on F so that nothing blocks it, or rounding is in the way.
  template <int count>
  bool DriveRows() {
    Fill(t_.weight, 0);
    bool is_first = true;
    for (int r = 0; r < n_; ++r) {
      if (is_joint(r)) continue;
      if (!(t_.q[r] * t_.inverse_root[r] < -noise_)) {
        SetEntry(t_.weight, r, t_.inverse_root[r]);
      } else if (!DriveRow<count>(r, is_first)) {
        return false;
      }
      is_first = false;
    }
    return true;
  }

  // Raises the force of row r until its gap is 0. A row that reaches 0 on the way changes sides; no row is in the way
  // of the first one.
  template <int count>
  bool DriveRow(int r, bool is_first) {
    double force = 0;
    for (;;) {
      const double a = t_.pivot[r];
      Blocking blocking{r, a > kLeastPivot * t_.diagonal[r] ? -t_.q[r] / a : kInfinity};
      if (!is_first) {
        CopyRow<count>(r);
        blocking = FindBlocking(r, blocking.step);
      }
      if (IsOver() || blocking.step == kInfinity) return false;
      if (blocking.row == r) {
        if (!Pivot<count>(r)) return false;
        if (force > 0) SetEntry(t_.q, r, t_.q[r] - force);
        noise_ = Larger(noise_, kNoise * Abs(t_.q[r]));
        return true;
      }
      force += blocking.step;
      for (int v = 0; v < registers_; ++v) {
        Store(t_.q, v, L::Fma(L::Set(blocking.step), Load(t_.correction, v), Load(t_.q, v)));
      }
      SetEntry(t_.q, r, t_.q[r] + blocking.step * a);
      SetEntry(t_.q, blocking.row, 0);
      if (!Pivot<count>(blocking.row)) return false;
    }
  }

  // Row r of the tableau after all exchanges, with 0 on its diagonal, to t_.correction.
  template <int count>
  void CopyRow(int r) {
    if (r == waiting_.row) CatchUp<count>();
    V at = L::Indices();
    for (int v = 0; v < Registers<count>(); ++v) {
      Store(t_.correction, v, CurrentEntriesOf<count>(r, v, at));
      at = at + L::Set(kWidth);
    }
    SetEntry(t_.correction, r, 0);
  }

  struct Blocking {
    int row;
    double step;
  };
  // What reaches 0 first while the force of row r grows by `full` and q by t_.correction times that: of the rows that
  // have a weight, else row r itself.
  Blocking FindBlocking(int r, double full) const {
    V least = L::Set(full);
    V row = L::Set(r);
    V at = L::Indices();
    for (int v = 0; v < registers_; ++v) {
      const V side = Load(t_.side, v);
      const V fall = -(side * Load(t_.correction, v));
      const V step = L::Max(side * Load(t_.q, v), L::Set(0)) / fall;
      const M blocks = (L::Set(kLeastRate) < fall) & (Load(t_.weight, v) != L::Set(0)) & (step < least);
      least = L::Select(blocks, step, least);
      row = L::Select(blocks, at, row);
      at = at + L::Set(kWidth);
    }
    const double step = L::Least(least);
    const unsigned first = L::Bits(least == L::Set(step));
    return {static_cast<int>(row[__builtin_ctz(first)]), step};
  }

  // z from 1 to 0: the point for z is q + z cover, all signs right. False where rounding is in the way.
  template <int count>
  bool FollowPath() {
    double worst = 0;
    for (int i = 0; i < n_; ++i) worst = Larger(worst, is_active(i) ? 0 : -t_.q[i] * t_.weight[i]);
    if (!(worst > noise_)) return true;
    for (int v = 0; v < registers_; ++v) {
      const M is_covered = Load(t_.weight, v) != L::Set(0);
      Store(t_.cover, v, L::Masked(is_covered, L::Set(worst) * Load(t_.root, v)));
    }
    for (double z = 1;;) {
      const Blocking next = FindNext(z, kLeastRate * worst);
      if (next.row < 0) return true;
      z = next.step;
      if (IsOver()) return false;
      if (!Pivot<count>(next.row) && !TakePlaceAt<count>(next.row, z)) return false;
    }
  }

  // The row that reaches 0 next, and at which z; row -1: none before z = 0.
  Blocking FindNext(double z, double least_rate) const {
    V largest = L::Set(0);
    V row = L::Set(-1);
    V at = L::Indices();
    for (int v = 0; v < registers_; ++v) {
      const V cover = Load(t_.cover, v);
      const V zero = L::Min(-Load(t_.q, v) / cover, L::Set(z));
      const M falls = (L::Set(least_rate) < Load(t_.side, v) * cover) & (Load(t_.weight, v) != L::Set(0));
      const M is_next = falls & (largest < zero);
      largest = L::Select(is_next, zero, largest);
      row = L::Select(is_next, at, row);
      at = at + L::Set(kWidth);
    }
    const double found = -L::Least(-largest);
    const unsigned first = L::Bits(largest == L::Set(found));
    return {static_cast<int>(row[__builtin_ctz(first)]), found};
  }

  // Row r depends on F: it takes the place of the row whose force it drives to 0 first, at this z.
  template <int count>
  bool TakePlaceAt(int r, double z) {
    CopyRow<count>(r);
    int leaving = -1;
    double least = kInfinity;
    for (int i = 0; i < n_; ++i) {
      if (!is_active(i) || is_joint(i) || !(t_.correction[i] > kLeastRate)) continue;
      const double step = -(t_.q[i] + z * t_.cover[i]) / t_.correction[i];
      if (!(step < least)) continue;
      least = step;
      leaving = i;
    }
    return leaving >= 0 && Pivot<count>(leaving) && Pivot<count>(r);
  }

  // Row r may not be moved, or may be again.
  void Block(int r) {
    const double weight = t_.weight[r];
    t_.weight[r] = t_.blocked_weight[r];
    t_.blocked_weight[r] = weight;
  }

  // Lets the most violated of the rows that depend on F take the place of the row whose force it drives to 0 first; all
  // forces have their signs. False if none is violated by more than rounding, or none is in its way.
  template <int count>
  bool TakePlace() {
    int r = -1;
    double worst = -tableau::kMargin * tableau::kMostRho * b_norm_;
    for (int i = 0; i < n_; ++i) {
      const double violation = t_.q[i] * t_.blocked_weight[i];
      if (!(violation < worst)) continue;
      worst = violation;
      r = i;
    }
    if (r < 0) return false;
    CatchUp<count>();
    // On the rows of F, row r of the tableau says by how much a unit of force at r lowers each force.
    const double* const change = t_.correction;
    for (int v = 0; v < registers_; ++v) Store(t_.correction, v, EntriesOf<count>(r, v));
    int leaving = -1;
    double least = kInfinity;
    for (int i = 0; i < n_; ++i) {
      if (!(is_active(i) && !is_joint(i) && change[i] > 0)) continue;
      // Without row i, row r no longer depends on F: its pivot is that.
      const double pivot = change[i] * change[i] / -t_.pivot[i];
      if (!(pivot > kLeastPivot * t_.diagonal[r]) || !(-t_.q[i] / change[i] < least)) continue;
      least = -t_.q[i] / change[i];
      leaving = i;
    }
    if (leaving < 0 || !Pivot<count>(leaving)) return false;
    Block(r);
    Pivot<count>(r);
    noise_ = Larger(noise_, kNoise * Abs(t_.q[r]));
    return true;
  }

  // Loops over so many registers a row are unrolled; above, any number.
  template <int count = kUnrolled>
  bool Drive() {
    if constexpr (count == 0) {
      return DrivePivots<0>();
    } else {
      return registers_ == count ? DrivePivots<count>() : Drive<count - 1>();
    }
  }
  template <int count>
  int Registers() const {
    return count > 0 ? count : registers_;
  }

  bool FindActiveSet() {
    const bool found = Drive();
    FindForces();
    return found;
  }

  void FindForces() {
    for (int v = 0; v < registers_; ++v) {
      const V f = L::Masked(L::SignOf(Load(t_.side, v)), -Load(t_.q, v));
      Store(t_.force, v, L::Max(f, Load(t_.least_force, v)));
    }
  }

  // rho of the forces. Leaves w and size_.
  double Rho() {
    AddProductsFrom<4>(0, ListNonzero(t_.force, t_.force, -1).rows);
    V squares = L::Set(0);
    V sizes = L::Set(0);
    for (int v = 0; v < registers_; ++v) {
      const V root = Load(t_.root, v);
      const V f = Load(t_.force, v);
      const V residual = L::Min(Load(t_.w, v) * Load(t_.inverse_root, v), (f - Load(t_.least_force, v)) * root);
      squares = L::Fma(residual, residual, squares);
      sizes = L::Fma(L::Abs(f), root, sizes);
    }
    size_ = L::Sum(sizes);
    return __builtin_sqrt(L::Sum(squares)) / b_norm_;
  }

  // w = b + A f, so many registers of w at a time over the listed forces: w stays where it is computed.
  template <int registers>
  void AddProductsFrom(int begin, const RowList& forces) {
    for (; begin + registers <= registers_; begin += registers) {
      V sum[registers] = {};
      for (RowList left = forces; left.any(); left.Drop()) {
        const double* const row = RowOf(t_.matrix, left.first()) + Index{begin} * kWidth;
        const V f = L::Set(t_.force[left.first()]);
        for (int v = 0; v < registers; ++v) sum[v] = L::Fma(f, Load(row, v), sum[v]);
      }
      for (int v = 0; v < registers; ++v) Store(t_.w, begin + v, Load(t_.b, begin + v) + sum[v]);
    }
    if constexpr (registers > 1) AddProductsFrom<registers - 1>(begin, forces);
  }

  // q_F += A_FF^-1 w_F, also in t_.correction.
  void Refine() {
    CatchUp();
    for (int v = 0; v < registers_; ++v) {
      const V w = L::Masked(L::SignOf(Load(t_.side, v)), Load(t_.w, v));
      Store(t_.w, v, w);
      Store(t_.correction, v, -(Load(t_.pivot, v) * w));
    }
    for (int i = 0; i < n_; ++i) {
      if (!is_active(i)) continue;
      const double* const row = RowOf(t_.tableau, i);
      const int own = i / kWidth;
      V sum = L::Set(0);
      for (int v = 0; v < own; ++v) {
        sum = L::Fma(Load(row, v), Load(t_.w, v), sum);
        Store(t_.correction, v, L::Fnma(L::Set(t_.w[i]), Load(row, v), Load(t_.correction, v)));
      }
      const auto is_diagonal = L::Equal(L::Indices(), L::Set(i % kWidth));
      sum = L::Fma(L::Without(is_diagonal, Load(row, own)), Load(t_.w, own), sum);
      t_.correction[i] -= L::Sum(sum);
    }
    for (int v = 0; v < registers_; ++v) {
      const V change = L::Masked(L::SignOf(Load(t_.side, v)), Load(t_.correction, v));
      Store(t_.correction, v, change);
      Store(t_.q, v, Load(t_.q, v) + change);
    }
  }

  bool RowsMeet() const {
    const V limit = L::Set(t_.row_limit);
    for (int v = 0; v < registers_; ++v) {
      const V force = Load(t_.diagonal, v) * Load(t_.force, v);
      const V w = Load(t_.w, v);
      const V b = Load(t_.b, v);
      const V defect = L::Abs(L::Select(Load(t_.least_force, v) < L::Set(0), w, L::Min(force, w)));
      // (|A| |f|)_i is at least both |A f|_i and A_ii f_i: most rows pass by that alone.
      const V size = L::Max(L::Abs(w - b), L::Abs(force)) + L::Abs(b);
      for (unsigned missed = L::Bits(~(defect <= limit * size)); missed != 0; missed &= missed - 1) {
        if (!RowMeets(v * kWidth + __builtin_ctz(missed), defect)) return false;
      }
    }
    return true;
  }
  // As RowsMeet, with the whole of (|A| |f| + |b|)_i.
  bool RowMeets(int i, const V& defects) const {
    V size = L::Set(0);
    for (int v = 0; v < registers_; ++v) {
      size = L::Fma(L::Abs(Load(RowOf(t_.matrix, i), v)), L::Abs(Load(t_.force, v)), size);
    }
    return defects[i % kWidth] <= t_.row_limit * (Abs(t_.b[i]) + L::Sum(size));
  }

  // Whether rounding of the entries of A, as t_.rounding has it, cannot hide that a row's backward error is too large.
  bool RowsAreClear() const {
    if (!t_.is_assembled) return true;
    const V hidden = L::Set(kRounding * (n_ + tableau::kTermsBesideRows) * size_);
    const V limit = L::Set(tableau::kHiddenInRow * t_.row_limit);
    M is_clear = L::FromBits(~0U);
    for (int v = 0; v < registers_; ++v) {
      const V b = Load(t_.b, v);
      const V force = L::Abs(Load(t_.diagonal, v) * Load(t_.force, v));
      const V size = L::Max(L::Abs(Load(t_.w, v) - b), force) + L::Abs(b);
      is_clear &= (hidden * Load(t_.root, v) <= limit * size) | (L::Indices() + L::Set(v * kWidth) >= L::Set(n_));
    }
    return !L::Any(~is_clear);
  }

  void SolveAndCheck() {
    t_.rho = SolveRows();
    t_.rounding = kInfinity;
    t_.rows_meet = t_.rows_are_clear = false;
    if (t_.rho == kInfinity) return;
    t_.rounding = kRounding * (n_ + tableau::kTermsBesideRows) * __builtin_sqrt(n_) * size_ / b_norm_;
    t_.rows_meet = RowsMeet();
    t_.rows_are_clear = RowsAreClear();
    if (t_.rows_meet) return;
    // Where all forces around a row should be 0, its backward error is rounding over rounding.
    double largest = 0;
    for (int i = 0; i < n_; ++i) largest = Larger(Abs(t_.force[i]) * t_.root[i], largest);
    for (int i = 0; i < n_; ++i) {
      if (Abs(t_.force[i]) * t_.root[i] <= kNoise * largest) t_.force[i] = 0;
    }
    t_.rho = Rho();
    t_.rows_meet = RowsMeet();
    if (t_.rows_meet) return;
    // A joint among them still has a small force to carry: that which its rounded b asks for.
    Refine();
    for (int k = 0; k < t_.joint_count; ++k) t_.force[t_.joints[k]] -= t_.correction[t_.joints[k]];
    t_.rho = Rho();
    t_.rows_meet = RowsMeet();
  }

  // rho of the forces that it finds; infinity if it gave up.
  double SolveRows() {
    if (HasClosedForm() && SolveInClosedForm()) {
      const double rho = Rho();
      if (rho <= tableau::kGoodEnough) return rho;
    }
    if (t_.guess_count > 0) {
      const double rho = TryGuess();
      if (rho <= kRightRho) return rho;
      for (int v = 0; v < registers_; ++v) Store(t_.q, v, Load(t_.b, v));
      for (int v = 0; v < n_ * registers_; ++v) Store(t_.tableau, v, Load(t_.matrix, v));
    }
    if (!FindActiveSet()) return kInfinity;
    double rho = Rho();
    if (rho <= tableau::kGoodEnough) return rho;
    const double before = rho;
    Refine();
    FindForces();
    rho = Rho();
    if (rho <= before) return rho;
    // Refinement in the same precision may lose the last digit.
    for (int v = 0; v < registers_; ++v) Store(t_.q, v, Load(t_.q, v) - Load(t_.correction, v));
    FindForces();
    return Rho();
  }

  // Forces for one or two rows: the first active set, of none, one or both rows, whose forces and gaps have their
  // signs. False if rounding leaves none.
  bool SolveInClosedForm() {
    Fill(t_.force, 0);
    const double* const A = t_.matrix;
    const double* const b = t_.b;
    double* const f = t_.force;
    const auto may_rest = [&](int i, double gap) { return !is_joint(i) && gap >= 0; };
    const auto may_push = [&](int i, double force) { return force >= t_.least_force[i]; };
    const double f0 = -b[0] / A[0];
    if (n_ == 1) {
      f[0] = may_rest(0, b[0]) ? 0.0 : f0;
      return true;
    }
    const double a11 = A[stride_ + 1];
    const double f1 = -b[1] / a11;
    if (may_rest(0, b[0]) && may_rest(1, b[1])) return true;
    if (may_push(0, f0) && may_rest(1, b[1] + A[1] * f0)) {
      f[0] = f0;
      return true;
    }
    if (may_push(1, f1) && may_rest(0, b[0] + A[1] * f1)) {
      f[1] = f1;
      return true;
    }
    const double determinant = A[0] * a11 - A[1] * A[1];
    if (!(determinant > kLeastPivot * A[0] * a11)) return false;
    f[0] = (A[1] * b[1] - a11 * b[0]) / determinant;
    f[1] = (A[1] * b[0] - A[0] * b[1]) / determinant;
    return may_push(0, f[0]) && may_push(1, f[1]);
  }

  // Block principal pivoting from the guess, a few steps of it. Returns the last rho, with force and w of it. Spoils q
  // and the tableau.
  double TryGuess() {
    const double limit = kRightRho * b_norm_;
    for (int round = 1;; ++round) {
      ++t_.pivots;
      SolveGuess();
      const double rho = Rho();
      // Forces that are rounding only may be all that a row has: its gap is then another without them.
      if (rho <= kRightRho || round == kMaxGuesses) return ClipForces() ? Rho() : rho;
      t_.guess_count = 0;
      for (int i = 0; i < n_; ++i) {
        const double f = t_.force[i] * t_.root[i];
        const bool enters = f != 0 ? f >= -limit : t_.w[i] * t_.inverse_root[i] < -limit;
        if (is_joint(i) || enters) t_.guess[t_.guess_count++] = i;
      }
    }
  }

  // Whether there was a force below the least one.
  bool ClipForces() {
    M is_below = L::FromBits(0);
    for (int v = 0; v < registers_; ++v) {
      const V f = Load(t_.force, v);
      const V least = Load(t_.least_force, v);
      is_below |= f < least;
      Store(t_.force, v, L::Max(f, least));
    }
    return L::Any(is_below);
  }

  // force := -A_FF^-1 b_F by L D L^T, the tableau serving as workspace. Rows that depend on others leave F.
  void SolveGuess() {
    double* const y = t_.q;
    for (int v = 0; v < registers_; ++v) Store(y, v, -Load(t_.b, v));
    Fill(t_.force, 0);
    for (int k = 0; k < t_.guess_count; ++k) {
      double* const to = RowOf(t_.tableau, t_.guess[k]);
      const double* const from = RowOf(t_.matrix, t_.guess[k]);
      for (int v = 0; v < registers_; ++v) Store(to, v, Load(from, v));
    }
    // Forward. Row i > r ends up with L_ir left of its diagonal and D_i L_ji from there on; what the whole-register
    // steps do to y left of r is never read again.
    int kept = 0;
    for (int k = 0; k < t_.guess_count; ++k) {
      const int r = t_.guess[k];
      const double* const row = RowOf(t_.tableau, r);
      const double pivot = row[r];
      if (!(pivot > kLeastPivot * t_.diagonal[r])) continue;
      t_.guess[kept++] = r;
      const double inverse = 1 / pivot;
      t_.correction[r] = y[r] * inverse;
      const V y_r = L::Set(t_.correction[r]);
      for (int v = r / kWidth; v < registers_; ++v) Store(y, v, L::Fnma(y_r, Load(row, v), Load(y, v)));
      for (int m = k + 1; m < t_.guess_count; ++m) {
        const double factor = row[t_.guess[m]] * inverse;
        // Row i has zeros left of its diagonal where it had no L_ir yet.
        if (factor != 0) SubtractRow(r, factor, RowOf(t_.tableau, t_.guess[m]));
      }
    }
    t_.guess_count = kept;
    // Backward, each force subtracted from all rows before it at once.
    for (int k = kept; k-- > 0;) {
      const int r = t_.guess[k];
      t_.force[r] = t_.correction[r];
      const double* const row = RowOf(t_.tableau, r);
      const V f = L::Set(t_.force[r]);
      for (int v = 0; v <= r / kWidth; ++v) {
        Store(t_.correction, v, L::Fnma(f, Load(row, v), Load(t_.correction, v)));
      }
    }
  }
  // Right of column r, `factor` times row r from another one, whose entry r becomes `factor`.
  void SubtractRow(int r, double factor, double* to) const {
    const double* const row = RowOf(t_.tableau, r);
    const int first = r / kWidth;
    const V at = L::Set(r % kWidth);
    const V before = L::Select(L::Equal(L::Indices(), at), L::Set(factor), Load(to, first));
    const V after = L::Fnma(L::Set(factor), Load(row, first), before);
    Store(to, first, L::Select(L::Less(at, L::Indices()), after, before));
    for (int v = first + 1; v < registers_; ++v) Store(to, v, L::Fnma(L::Set(factor), Load(row, v), Load(to, v)));
  }

  TableauWork& t_;
  const int n_;
  const Index stride_;
  const int registers_;
  Exchange waiting_, latest_;
  double b_norm_ = 1;
  double noise_ = 0;  // violations below this are rounding
  double size_ = 0;   // |D^1/2 f|_1
};

}  // namespace

bool LCPBENCH_KERNEL(SolveTableau)(TableauWork* work) { return DenseTableau(work).Solve(); }

}  // namespace lcpbench
