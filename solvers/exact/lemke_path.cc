#include "solvers/exact/lemke_path.h"

#include <Eigen/Core>
#include <algorithm>
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <numeric>
#include <random>
#include <utility>

namespace lcpbench {
namespace {

constexpr int kPathDigits = 60;

using Float = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<kPathDigits, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

constexpr Index kMostPivotsPerRow = 30;

Float ToFloat(const fmpz* integer) { return Float(ToInteger(integer)); }
Float ToFloat(const Rational& value) { return Float(numerator(value)) / Float(denominator(value)); }

using Matrix = Eigen::Matrix<Float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// basic = T nonbasic + q, q the last column.
struct Dictionary {
  Matrix values;
  std::vector<int> basic, nonbasic;

  Index RowOf(int variable) const { return std::ranges::find(basic, variable) - basic.begin(); }
  Index ColumnOf(int variable) const { return std::ranges::find(nonbasic, variable) - nonbasic.begin(); }
  const Float& constant(Index row) const { return values(row, values.cols() - 1); }

  void Pivot(Index row, Index column) {
    const Float inverse = 1 / values(row, column);
    values.row(row) *= -inverse;
    values(row, column) = inverse;
    for (Index i = 0; i < values.rows(); ++i) {
      const Float factor = values(i, column);
      if (i == row || factor == 0) continue;
      values(i, column) = 0;
      values.row(i) += factor * values.row(row);
    }
    std::swap(basic[At(row)], nonbasic[At(column)]);
  }
};

// Eliminates the rows of S from n on, which are joints' with their right-hand sides in the last column, the largest
// diagonal first. False where that is not > 0, or the deadline has passed.
bool EliminateJoints(Index n, const Deadline& deadline, Matrix* S) {
  const Index all = S->rows();
  std::vector<char> done(At(all - n), 0);
  for (Index step = n; step < all; ++step) {
    Index p = -1;
    for (Index i = n; i < all; ++i) {
      if (done[At(i - n)] == 0 && (p < 0 || (*S)(i, i) > (*S)(p, p))) p = i;
    }
    done[At(p - n)] = 1;
    if (!((*S)(p, p) > 0) || deadline.Expired()) return false;
    for (Index i = 0; i < all; ++i) {
      if (i == p || (i >= n && done[At(i - n)] != 0)) continue;
      const Float factor = (*S)(i, p) / (*S)(p, p);
      if (factor == 0) continue;
      S->row(i) -= factor * S->row(p);
    }
  }
  return true;
}

// A unilateral row, and the friction row on it with mu > 0; numbered within the rows of the path.
struct Contact {
  Index normal;
  Index tangent = -1;  // none
  int side = -1;       // the variable mu f_n + f_t; the next one is mu f_n - f_t
  char mode = 'O';     // of the tangent in contact, C without one

  // The side of its cone that a slipping force lies on.
  int SlipSide() const { return mode == '-' ? side + 1 : side; }
};

// One FollowLemke.
class LemkePath {
 public:
  LemkePath(const ExactLcp& problem, unsigned seed, const Deadline& deadline)
      : problem_(problem), is_plain_(seed == 0), deadline_(deadline), random_(seed) {}

  LemkeEnd Follow(const IntegerMatrix& A, const IntegerMatrix& b) {
    end_.modes.assign(At(problem_.size), 'O');
    for (const Index i : Marked(problem_.bilateral)) end_.modes[At(i)] = 'B';
    for (const ExactFrictionRow& row : problem_.friction) end_.modes[At(row.row)] = 'o';
    ListRows(A);
    end_.kind = MakeDictionary(A, b) ? FollowPath() : LemkeEnd::Kind::kLimit;
    if (end_.kind != LemkeEnd::Kind::kSolved) return std::move(end_);
    for (const Contact& contact : contacts_) {
      if (contact.mode == 'O') continue;
      end_.modes[At(rows_[At(contact.normal)])] = 'C';
      if (contact.tangent >= 0) end_.modes[At(rows_[At(contact.tangent)])] = contact.mode;
    }
    return std::move(end_);
  }

 private:
  // Variables: w of row i, f of row i, the artificial one, and two of each tangent, which is the number behind.
  int gap(Index i) const { return static_cast<int>(i); }
  int force(Index i) const { return static_cast<int>(n_ + i); }
  int artificial() const { return static_cast<int>(2 * n_); }

  // Contacts, then joints as far as they are independent. Without friction nothing depends on a row of A_ii = 0.
  void ListRows(const IntegerMatrix& A) {
    std::vector<const ExactFrictionRow*> friction(At(problem_.size), nullptr);  // by its row
    for (const ExactFrictionRow& row : problem_.friction) friction[At(row.row)] = &row;
    std::vector<Index> place(At(problem_.size), -1);
    for (Index i = 0; i < problem_.size; ++i) {
      const ExactFrictionRow* const row = friction[At(i)];
      if (problem_.bilateral[At(i)] != 0 || (row != nullptr && row->mu == 0)) continue;
      if (is_plain_ && fmpz_sgn(A.at(i, i)) <= 0) continue;
      place[At(i)] = static_cast<Index>(rows_.size());
      rows_.push_back(i);
    }
    n_ = static_cast<Index>(rows_.size());
    contact_of_.assign(At(n_), -1);
    for (Index r = 0; r < n_; ++r) {
      if (friction[At(rows_[At(r)])] != nullptr) continue;
      contact_of_[At(r)] = static_cast<Index>(contacts_.size());
      contacts_.push_back({r});
    }
    for (const ExactFrictionRow& row : problem_.friction) {
      if (row.mu == 0) continue;
      const Index r = place[At(row.row)], k = contact_of_[At(place[At(row.normal)])];
      contact_of_[At(r)] = k;
      contacts_[At(k)].tangent = r;
      contacts_[At(k)].side = artificial() + 1 + static_cast<int>(2 * tangents_.size());
      tangents_.push_back({k, &row});
    }
    joints_ = IndependentRows(A, Marked(problem_.bilateral));
    rows_.insert(rows_.end(), joints_.begin(), joints_.end());
  }

  // Without the units of the problem: rows and columns by the root of the diagonal, b by its largest entry; joints
  // eliminated. False where those are dependent, or the deadline has passed.
  bool MakeDictionary(const IntegerMatrix& A, const IntegerMatrix& b) {
    const auto all = static_cast<Index>(rows_.size()), sides = static_cast<Index>(2 * tangents_.size());
    std::vector<Float> root;
    for (const Index i : rows_) root.push_back(fmpz_sgn(A.at(i, i)) > 0 ? sqrt(ToFloat(A.at(i, i))) : Float(1));
    Matrix S(all, all + 1);
    Float largest = 0;
    for (Index i = 0; i < all; ++i) {
      for (Index j = 0; j < all; ++j) S(i, j) = ToFloat(A.at(rows_[At(i)], rows_[At(j)])) / (root[At(i)] * root[At(j)]);
      S(i, all) = ToFloat(b.at(rows_[At(i)], 0)) / root[At(i)];
      largest = std::max(largest, Float(abs(S(i, all))));
    }
    if (largest > 0 && !EliminateJoints(n_, deadline_, &S)) return false;

    dictionary_ = {Matrix::Zero(n_ + sides, n_ + 2), std::vector<int>(At(n_ + sides)), std::vector<int>(At(n_ + 1))};
    Matrix& T = dictionary_.values;
    T.topLeftCorner(n_, n_) = S.topLeftCorner(n_, n_);
    if (is_plain_) {
      T.col(n_).setOnes();
    } else {
      DrawDirection(root);
    }
    for (Index i = 0; i < n_ && largest > 0; ++i) T(i, n_ + 1) = S(i, all) / largest;
    std::iota(dictionary_.basic.begin(), dictionary_.basic.begin() + n_, 0);
    std::iota(dictionary_.basic.begin() + n_, dictionary_.basic.end(), artificial() + 1);
    std::iota(dictionary_.nonbasic.begin(), dictionary_.nonbasic.end(), static_cast<int>(n_));
    for (const auto& [k, row] : tangents_) {
      const Index normal = contacts_[At(k)].normal, tangent = contacts_[At(k)].tangent;
      const Index up = dictionary_.RowOf(contacts_[At(k)].side), down = up + 1;
      T(up, normal) = T(down, normal) = ToFloat(row->mu) * root[At(tangent)] / root[At(normal)];
      T(up, tangent) = 1;
      T(down, tangent) = -1;
    }
    limit_.assign(At(2 * n_ + 1 + sides), 0);
    limit_[At(artificial())] = 1;
    for (const Contact& contact : contacts_) SetLimits(contact);
    return true;
  }

  // d of integers: normal ones from kUnit to 2 kUnit, and |d_t| < d_n / max(mu, 1).
  void DrawDirection(const std::vector<Float>& root) {
    constexpr std::uint64_t kUnit = std::uint64_t{1} << 30U;
    std::vector<const ExactFrictionRow*> friction(contacts_.size(), nullptr);
    for (const auto& [k, row] : tangents_) friction[At(k)] = row;
    for (size_t k = 0; k < contacts_.size(); ++k) {
      const Index normal = contacts_[k].normal, tangent = contacts_[k].tangent;
      const Rational d(kUnit + random_() % kUnit);
      dictionary_.values(normal, n_) = ToFloat(d) / root[At(normal)];
      if (tangent < 0) continue;
      const Rational part = Rational(random_() % kUnit) / Rational(kUnit) * Rational(9, 10);
      const Rational most = friction[k]->mu > 1 ? Rational(d / friction[k]->mu) : d;
      const Rational signed_part = random_() % 2 == 0 ? part : Rational(-part);
      dictionary_.values(tangent, n_) = ToFloat(Rational(signed_part * most)) / root[At(tangent)];
    }
  }

  // What must not change its sign in the mode of a contact.
  void SetLimits(const Contact& contact) {
    const char mode = contact.mode;
    limit_[At(gap(contact.normal))] = mode == 'O' ? 1 : 0;
    limit_[At(force(contact.normal))] = mode == 'O' || mode == 'S' ? 0 : 1;
    if (contact.tangent < 0) return;
    limit_[At(gap(contact.tangent))] = mode == '+' ? 1 : mode == '-' ? -1 : 0;
    limit_[At(contact.side)] = limit_[At(contact.side + 1)] = mode == 'S' ? 1 : 0;
  }

  LemkeEnd::Kind FollowPath() {
    ++end_.steps;
    const Float tiny = pow(Float(10), -2 * kPathDigits / 3);
    const auto d = [this](Index i) -> const Float& { return dictionary_.values(i, n_); };
    const auto constant = [this](Index i) -> const Float& { return dictionary_.constant(i); };
    Index row = -1;
    for (const Contact& contact : contacts_) {
      const Index i = contact.normal;
      if (constant(i) < 0 && (row < 0 || constant(i) * d(row) < constant(row) * d(i))) row = i;
    }
    if (row < 0) return LemkeEnd::Kind::kSolved;
    int entering = artificial(), direction = 1;
    for (Index pivots = 0; pivots < kMostPivotsPerRow * (n_ + 1); ++pivots) {
      if (deadline_.Expired()) return LemkeEnd::Kind::kLimit;
      const int left = dictionary_.basic[At(row)];
      dictionary_.Pivot(row, dictionary_.ColumnOf(entering));
      if (left == artificial()) return LemkeEnd::Kind::kSolved;
      entering = Cross(left, &direction);
      ++end_.steps;
      bool is_tie = false;
      row = LeavingRow(dictionary_.ColumnOf(entering), direction, tiny, &is_tie);
      if (row < 0) {
        SetSupport(entering, tiny);
        return LemkeEnd::Kind::kRay;
      }
      if (is_tie) return LemkeEnd::Kind::kTie;
    }
    return LemkeEnd::Kind::kLimit;
  }

  // Changes the mode of the contact that a variable has become 0 of. What moves next, and which way.
  int Cross(int left, int* direction) {
    *direction = 1;
    const bool is_side = left > artificial();
    Contact& contact = contacts_[At(is_side ? tangents_[At((left - artificial() - 1) / 2)].contact
                                            : contact_of_[At(left < n_ ? left : left - n_)])];
    int next = 0;
    if (left == gap(contact.normal)) {
      contact.mode = 'C';
      if (contact.tangent >= 0) {
        contact.mode = dictionary_.constant(dictionary_.RowOf(gap(contact.tangent))) >= 0 ? '+' : '-';
        Exchange(contact.SlipSide(), force(contact.tangent));
      }
      next = force(contact.normal);
    } else if (left == force(contact.normal)) {
      if (contact.tangent >= 0) Exchange(force(contact.tangent), contact.SlipSide());
      contact.mode = 'O';
      next = gap(contact.normal);
    } else if (is_side) {
      contact.mode = left == contact.side ? '+' : '-';
      *direction = contact.mode == '+' ? 1 : -1;
      next = gap(contact.tangent);
    } else {
      next = contact.SlipSide();
      contact.mode = 'S';
    }
    SetLimits(contact);
    return next;
  }

  void Exchange(int leaving, int entering) {
    dictionary_.Pivot(dictionary_.RowOf(leaving), dictionary_.ColumnOf(entering));
  }

  // The row that leaves where that column moves, -1 where none does. Of ratios height / -slope the smallest, and of
  // equal ones the artificial variable's. Slopes above -tiny are none.
  Index LeavingRow(Index column, int direction, const Float& tiny, bool* is_tie) const {
    const Matrix& T = dictionary_.values;
    Index row = -1;
    Float row_height = 0, row_slope = 0;
    for (Index i = 0; i < T.rows(); ++i) {
      const int limit = limit_[At(dictionary_.basic[At(i)])];
      if (limit == 0) continue;
      const Float slope = limit * direction * T(i, column), height = limit * dictionary_.constant(i);
      if (!(slope < -tiny)) continue;
      const Float difference = row_height * slope - height * row_slope;
      const Float near = is_plain_ ? Float(0) : Float(tiny * abs(row_height * slope));
      const bool is_before = row < 0 || difference < -near, is_equal = !is_before && difference <= near;
      *is_tie = is_equal || (*is_tie && !is_before);
      if (!is_before && !(is_equal && dictionary_.basic[At(i)] == artificial())) continue;
      row = i;
      row_height = height;
      row_slope = slope;
    }
    const bool is_last = row >= 0 && dictionary_.basic[At(row)] == artificial();
    // The path enters its cell: what is behind was crossed already.
    *is_tie = !is_plain_ && !is_last && (*is_tie || row_height <= tiny);
    return row;
  }

  void SetSupport(int entering, const Float& tiny) {
    end_.support.assign(At(problem_.size), 0);
    const auto add = [this](int variable) {
      if (variable >= n_ && variable < artificial()) end_.support[At(rows_[At(variable - n_)])] = 1;
    };
    add(entering);
    for (Index i = 0; i < dictionary_.values.rows(); ++i) {
      if (dictionary_.values(i, dictionary_.ColumnOf(entering)) > tiny) add(dictionary_.basic[At(i)]);
    }
    for (const Index joint : joints_) end_.support[At(joint)] = 1;
  }

  struct Tangent {
    Index contact;
    const ExactFrictionRow* row;
  };

  const ExactLcp& problem_;
  const bool is_plain_;
  const Deadline& deadline_;
  std::mt19937_64 random_;
  Index n_ = 0;              // rows of contacts
  std::vector<Index> rows_;  // of the problem: those of contacts, then joints
  std::vector<Index> joints_;
  std::vector<Contact> contacts_;
  std::vector<Index> contact_of_;  // by row
  std::vector<Tangent> tangents_;
  Dictionary dictionary_;
  std::vector<int> limit_;  // by variable: 1 where it must stay >= 0, -1 where <= 0
  LemkeEnd end_;
};

}  // namespace

LemkeEnd FollowLemke(const ExactLcp& problem, const IntegerMatrix& A, const IntegerMatrix& b, unsigned seed,
                     const Deadline& deadline) {
  return LemkePath(problem, seed, deadline).Follow(A, b);
}

}  // namespace lcpbench
