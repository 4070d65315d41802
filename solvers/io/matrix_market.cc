#include "solvers/io/matrix_market.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "solvers/io/file_ending.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/same_bits.h"
#include "support/input_error.h"
#include "support/number_text.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

// The words of a file and their lines. Every refusal is an InputError `name:line: expected ..., found ...`. Memory: one
// line.
class TextWords {
 public:
  TextWords(std::istream& input, std::string name) : input_(input), name_(std::move(name)) {}

  // Goes to the next line; false at the end of the file.
  bool NextLine() {
    const bool is_there = static_cast<bool>(std::getline(input_, line_));
    if (is_there) {
      ++number_;
    } else {
      line_.clear();
    }
    rest_ = line_;
    return is_there;
  }

  // The next line that is neither blank nor a comment.
  bool NextData() {
    while (NextLine()) {
      const auto first = line_.find_first_not_of(kSpace);
      if (first != std::string::npos && line_[first] != '%') return true;
    }
    return false;
  }

  // The next word of this line, "" at its end.
  std::string_view Word() {
    const auto begin = std::min(rest_.find_first_not_of(kSpace), rest_.size());
    const auto end = std::min(rest_.find_first_of(kSpace, begin), rest_.size());
    const std::string_view word = rest_.substr(begin, end - begin);
    rest_ = rest_.substr(end);
    return word;
  }

  std::int64_t Integer(std::int64_t least, std::int64_t most, const std::string& what) {
    const std::string_view word = Word();
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_whole = error == std::errc() && end == word.data() + word.size();
    if (is_whole && least <= value && value <= most) return value;
    Reject(what + " from " + std::to_string(least) + " to " + std::to_string(most), word);
  }

  double Number() {
    const std::string_view word = Word();
    const std::optional<double> value = lcpbench::ParseNumber(word);
    if (!value) Reject("a finite number", word);
    return *value;
  }

  void ExpectEndOfLine() {
    if (const std::string_view word = Word(); !word.empty()) Reject("the end of the line", word);
  }

  const std::string& Line() const { return line_; }
  [[noreturn]] void Reject(const std::string& expected, std::string_view found) const {
    constexpr std::size_t kLongest = 40;
    throw InputError(Place() + "expected " + expected + ", found " +
                     (found.empty() ? "nothing" : "'" + Excerpt(found, kLongest) + "'"));
  }
  // The file ends where `expected` should be.
  [[noreturn]] void RejectEnd(const std::string& expected) const {
    throw InputError(Place() + "expected " + expected + ", found the end of the file");
  }

 private:
  static constexpr std::string_view kSpace = " \t\r\v\f";

  // An empty file ends on its first line.
  std::string Place() const { return name_ + ":" + std::to_string(std::max<std::size_t>(number_, 1)) + ": "; }

  std::istream& input_;
  std::string name_;
  std::string line_;
  std::string_view rest_;
  std::size_t number_ = 0;
};

// 17 significant digits: reading gives the same bits.
std::string RoundTripDigits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string Lower(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

void ReadHeader(TextWords* lines, MarketMatrix* matrix) {
  if (!lines->NextLine()) lines->RejectEnd("'%%MatrixMarket matrix ...'");
  const auto require = [lines](std::initializer_list<std::string_view> allowed) {
    const std::string_view word = lines->Word();
    std::string lower = Lower(word);
    std::string names;
    for (const std::string_view name : allowed) {
      if (lower == Lower(name)) return lower;
      names += (names.empty() ? "'" : " or '") + std::string(name) + "'";
    }
    lines->Reject(names, word);
  };
  require({"%%MatrixMarket"});
  require({"matrix"});
  matrix->is_array = require({"coordinate", "array"}) == "array";
  require({"real", "integer"});
  matrix->is_symmetric = require({"general", "symmetric"}) == "symmetric";
  lines->ExpectEndOfLine();
}

void ReadEntries(TextWords* lines, std::int64_t count, MarketMatrix* matrix) {
  Index i = -1;
  Index j = 0;
  for (std::int64_t k = 0; k < count; ++k) {
    if (!lines->NextData()) lines->RejectEnd("entry " + std::to_string(k + 1) + " of " + std::to_string(count));
    if (!matrix->is_array) {
      i = lines->Integer(1, matrix->rows, "a row") - 1;
      j = lines->Integer(1, matrix->columns, "a column") - 1;
      if (matrix->is_symmetric && i < j) {
        lines->Reject("a row from the diagonal of a symmetric matrix down", std::to_string(i + 1));
      }
    } else if (++i == matrix->rows) {
      ++j;
      i = matrix->is_symmetric ? j : 0;
    }
    const double value = lines->Number();
    lines->ExpectEndOfLine();
    matrix->entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
    if (matrix->is_symmetric && i != j) matrix->entries.emplace_back(static_cast<int>(j), static_cast<int>(i), value);
  }
  if (!lines->NextData()) return;
  lines->Reject("the end of the file after " + std::to_string(count) + " entries", lines->Line());
}

void RequireNoneTwice(const MarketMatrix& matrix, const std::string& name) {
  std::vector<std::pair<int, int>> places;
  places.reserve(matrix.entries.size());
  for (const auto& entry : matrix.entries) places.emplace_back(entry.row(), entry.col());
  std::sort(places.begin(), places.end());
  const auto twice = std::adjacent_find(places.begin(), places.end());
  if (twice == places.end()) return;
  throw InputError(name + ": expected every entry once, found (" + std::to_string(twice->first + 1) + ", " +
                   std::to_string(twice->second + 1) + ") twice");
}

// dir/name.mtx.gz -> dir/name_part.mtx.gz
std::string PartOf(const std::string& path, const char* part) {
  const FileEnding name = EndingOf(path);
  return name.stem + part + name.ending;
}

std::optional<MarketMatrix> ReadPart(const std::string& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  TextInput file(path);
  return ReadMarketMatrix(file, path);
}

void RequireShape(const MarketMatrix& matrix, Index rows, Index columns, const std::string& path) {
  if (matrix.rows == rows && matrix.columns == columns) return;
  throw InputError(path + ": expected " + std::to_string(rows) + " x " + std::to_string(columns) + " entries, found " +
                   std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns));
}

void RequirePlain(const LcpProblem& problem) {
  const auto refuse = [&](const std::string& kind, const std::string& expected) {
    throw InputError("problem '" + problem.id() + "' has " + kind +
                     " rows, which the format has no place for; expected " + expected);
  };
  if (!problem.friction_rows().empty()) {
    refuse("friction", "JSON lines, FCLib, or --without-friction, which drops them");
  }
  if (!problem.bounded_rows().empty()) refuse("bounded", "JSON lines");
}

}  // namespace

// Not by setFromTriplets, which takes memory for every column that the header promises.
SparseMatrix MarketMatrix::ToSparse() const {
  std::vector<Eigen::Triplet<double, int>> sorted = entries;
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return std::make_pair(a.row(), a.col()) < std::make_pair(b.row(), b.col());
  });
  SparseMatrix matrix(rows, columns);
  matrix.reserve(static_cast<Index>(sorted.size()));
  auto next = sorted.begin();
  for (Index i = 0; i < rows; ++i) {
    matrix.startVec(i);
    for (; next != sorted.end() && next->row() == i; ++next) matrix.insertBack(i, next->col()) = next->value();
  }
  matrix.finalize();
  return matrix;
}

Eigen::VectorXd MarketMatrix::ToVector(const std::string& where) const {
  if (columns != 1 && rows != 1) {
    throw InputError(where + ": expected one column, found " + std::to_string(rows) + " x " + std::to_string(columns) +
                     " entries");
  }
  // A vector by coordinates may promise more zeros than the file holds entries.
  constexpr Index kMostByCoordinates = 10'000'000;
  const Index length = rows * columns;
  if (!is_array && length > kMostByCoordinates) {
    throw InputError(where + ": expected an array for a vector of " + std::to_string(length) +
                     " entries, found coordinates");
  }
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(length);
  for (const auto& entry : entries) vector[std::max(entry.row(), entry.col())] = entry.value();
  return vector;
}

MarketMatrix ReadMarketMatrix(std::istream& input, const std::string& name) {
  TextWords lines(input, name);
  MarketMatrix matrix;
  ReadHeader(&lines, &matrix);
  if (!lines.NextData()) lines.RejectEnd("a line with the size");
  constexpr std::int64_t kMost = std::numeric_limits<int>::max() - 1;
  matrix.rows = lines.Integer(0, kMost, "a number of rows");
  matrix.columns = lines.Integer(0, kMost, "a number of columns");
  if (matrix.is_symmetric && matrix.rows != matrix.columns) {
    lines.Reject("a square symmetric matrix", std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns));
  }
  const std::int64_t count = !matrix.is_array      ? lines.Integer(0, kMost, "a number of entries")
                             : matrix.is_symmetric ? matrix.rows * (matrix.rows + 1) / 2
                                                   : matrix.rows * matrix.columns;
  lines.ExpectEndOfLine();
  ReadEntries(&lines, count, &matrix);
  if (!matrix.is_array) RequireNoneTwice(matrix, name);
  return matrix;
}

void WriteMarketMatrix(const SparseMatrix& matrix, std::ostream& output) {
  const bool symmetric = matrix.rows() == matrix.cols() && SameBits(matrix, SparseMatrix(matrix.transpose()));
  const auto wanted = [symmetric](Index i, Index j) { return !symmetric || i >= j; };
  Index count = 0;
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) count += wanted(i, it.col()) ? 1 : 0;
  }
  output << "%%MatrixMarket matrix coordinate real " << (symmetric ? "symmetric" : "general") << '\n'
         << matrix.rows() << ' ' << matrix.cols() << ' ' << count << '\n';
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      if (wanted(i, it.col())) output << i + 1 << ' ' << it.col() + 1 << ' ' << RoundTripDigits(it.value()) << '\n';
    }
  }
}

void WriteMarketVector(const Eigen::VectorXd& vector, std::ostream& output) {
  output << "%%MatrixMarket matrix array real general\n" << vector.size() << " 1\n";
  for (const double value : vector) output << RoundTripDigits(value) << '\n';
}

MarketProblem ReadMarketProblem(const std::string& path) {
  const std::string id = IdOfFile(path);
  const auto part = [&](const char* name) { return PartOf(path, name); };
  const std::optional<MarketMatrix> b_file = ReadPart(part("_b"));
  if (!b_file.has_value()) throw InputError(part("_b") + ": cannot be opened; expected the vector b of " + path);
  Eigen::VectorXd b = b_file->ToVector(part("_b"));
  const Index n = b.size();

  std::vector<Index> bilateral;
  if (const auto rows = ReadPart(part("_bilateral"))) {
    for (const double value : rows->ToVector(part("_bilateral"))) {
      if (!(value >= 1 && value <= static_cast<double>(n) && value == std::floor(value))) {
        throw InputError(part("_bilateral") + ": expected row numbers from 1 to " + std::to_string(n) + ", found " +
                         RoundTripDigits(value));
      }
      bilateral.push_back(static_cast<Index>(value) - 1);
    }
  }
  std::optional<Eigen::VectorXd> x;
  if (const auto known = ReadPart(part("_x"))) {
    x = known->ToVector(part("_x"));
    if (x->size() != n) RequireShape(*known, n, 1, part("_x"));
  }
  RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral);
  const auto J = ReadPart(part("_J"));
  const auto inverse_mass = ReadPart(part("_invM"));
  if (J.has_value() != inverse_mass.has_value()) {
    throw InputError(part(J.has_value() ? "_invM" : "_J") + ": cannot be opened; expected both factors, or none");
  }
  if (J.has_value()) {
    Eigen::VectorXd masses = inverse_mass->ToVector(part("_invM"));
    RequireShape(*J, n, masses.size(), part("_J"));
    return {LcpProblem::FromFactors(id, J->ToSparse(), std::move(masses), std::move(b), std::move(bounds)),
            std::move(x)};
  }
  const auto A = ReadPart(path);
  if (!A.has_value()) throw InputError(path + ": cannot be opened; expected the matrix A, or its factors");
  RequireShape(*A, n, n, path);
  return {LcpProblem::FromSparse(id, A->ToSparse(), std::move(b), std::move(bounds)), std::move(x)};
}

void WriteMarketProblem(const LcpProblem& problem, const std::string& path) {
  RequirePlain(problem);
  std::vector<std::unique_ptr<TextOrGzipOutput>> written;
  std::set<std::string> parts;
  const auto write = [&](const char* part, const auto& format, const auto& content) {
    parts.insert(part);
    written.push_back(std::make_unique<TextOrGzipOutput>(PartOf(path, part)));
    format(content, written.back()->stream());
    written.back()->Finish();
  };
  write("", WriteMarketMatrix, problem.SparseA());
  if (problem.has_factors()) {
    write("_J", WriteMarketMatrix, problem.J());
    write("_invM", WriteMarketVector, problem.inverse_mass());
  }
  if (const std::vector<Index>& bilateral = problem.bilateral_rows(); !bilateral.empty()) {
    Eigen::VectorXd rows(static_cast<Index>(bilateral.size()));
    for (Index k = 0; k < rows.size(); ++k) rows[k] = static_cast<double>(bilateral[static_cast<size_t>(k)] + 1);
    write("_bilateral", WriteMarketVector, rows);
  }
  write("_b", WriteMarketVector, problem.b());
  // All is written. Without its b, which comes last, a problem is refused: nobody reads parts of two.
  std::error_code absent;
  std::filesystem::remove(std::filesystem::weakly_canonical(PartOf(path, "_b")), absent);
  for (const char* part : {"_J", "_invM", "_bilateral", "_x"}) {
    if (parts.count(part) == 0) std::filesystem::remove(PartOf(path, part), absent);
  }
  for (const std::unique_ptr<TextOrGzipOutput>& part : written) part->Close();
}

}  // namespace lcpbench
