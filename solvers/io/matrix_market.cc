#include "solvers/io/matrix_market.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>
#include <utility>

#include "solvers/io/text_words.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr char kComment = '%';

std::string Lower(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

struct Header {
  bool is_array = false;
  bool is_symmetric = false;
};

Header ReadHeader(TextWords* lines) {
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
  Header header;
  header.is_array = require({"coordinate", "array"}) == "array";
  require({"real", "integer"});
  header.is_symmetric = require({"general", "symmetric"}) == "symmetric";
  lines->EndOfLine();
  return header;
}

void EndOfFile(TextWords* lines, std::int64_t entries) {
  if (!lines->NextData(kComment)) return;
  lines->Reject("the end of the file after " + std::to_string(entries) + " entries", lines->Line());
}

void ReadCoordinates(TextWords* lines, std::int64_t count, MarketMatrix* matrix) {
  for (std::int64_t k = 0; k < count; ++k) {
    if (!lines->NextData(kComment)) lines->RejectEnd("entry " + std::to_string(k + 1) + " of " + std::to_string(count));
    const auto i = static_cast<int>(lines->Integer(1, matrix->rows, "a row") - 1);
    const auto j = static_cast<int>(lines->Integer(1, matrix->columns, "a column") - 1);
    if (matrix->is_symmetric && i < j) {
      lines->Reject("a row from the diagonal of a symmetric matrix down", std::to_string(i + 1));
    }
    const double value = lines->Number();
    lines->EndOfLine();
    matrix->entries.emplace_back(i, j, value);
    if (matrix->is_symmetric && i != j) matrix->entries.emplace_back(j, i, value);
  }
  EndOfFile(lines, count);
}

void ReadArray(TextWords* lines, MarketMatrix* matrix) {
  const std::int64_t count =
      matrix->is_symmetric ? matrix->rows * (matrix->rows + 1) / 2 : matrix->rows * matrix->columns;
  std::int64_t read = 0;
  for (Index j = 0; j < matrix->columns; ++j) {
    for (Index i = matrix->is_symmetric ? j : 0; i < matrix->rows; ++i, ++read) {
      if (!lines->NextData(kComment))
        lines->RejectEnd("entry " + std::to_string(read + 1) + " of " + std::to_string(count));
      const double value = lines->Number();
      lines->EndOfLine();
      matrix->entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
      if (matrix->is_symmetric && i != j) matrix->entries.emplace_back(static_cast<int>(j), static_cast<int>(i), value);
    }
  }
  EndOfFile(lines, count);
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

bool IsSymmetric(const SparseMatrix& matrix) {
  if (matrix.rows() != matrix.cols()) return false;
  const SparseMatrix transposed = matrix.transpose();
  if (transposed.nonZeros() != matrix.nonZeros()) return false;
  const auto equal = [](const auto* a, const auto* b, Index n) { return std::equal(a, a + n, b); };
  if (!equal(matrix.outerIndexPtr(), transposed.outerIndexPtr(), matrix.rows() + 1)) return false;
  if (!equal(matrix.innerIndexPtr(), transposed.innerIndexPtr(), matrix.nonZeros())) return false;
  // By bits: 0 and -0 are two numbers to whom reads the file.
  return std::equal(
      matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros(), transposed.valuePtr(),
      [](double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); });
}

// dir/name.mtx -> dir/name_part.mtx
std::filesystem::path PartOf(const std::filesystem::path& path, const char* part) {
  return path.parent_path() / (path.stem().string() + part + ".mtx");
}

std::optional<MarketMatrix> ReadPart(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be opened");
  return ReadMarketMatrix(file, path.string());
}

void RequireShape(const MarketMatrix& matrix, Index rows, Index columns, const std::filesystem::path& path) {
  if (matrix.rows == rows && matrix.columns == columns) return;
  throw InputError(path.string() + ": expected " + std::to_string(rows) + " x " + std::to_string(columns) +
                   " entries, found " + std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns));
}

template <typename Write>
void WritePart(const std::filesystem::path& path, bool wanted, const Write& write) {
  if (!wanted) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    return;
  }
  std::ofstream file(path);
  if (file) write(file);
  file.close();
  if (!file) throw InputError(path.string() + ": cannot be written");
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
  const Header header = ReadHeader(&lines);
  MarketMatrix matrix;
  matrix.is_array = header.is_array;
  matrix.is_symmetric = header.is_symmetric;
  if (!lines.NextData(kComment)) lines.RejectEnd("a line with the size");
  constexpr std::int64_t kMost = std::numeric_limits<int>::max() - 1;
  matrix.rows = lines.Integer(0, kMost, "a number of rows");
  matrix.columns = lines.Integer(0, kMost, "a number of columns");
  if (matrix.is_symmetric && matrix.rows != matrix.columns) {
    lines.Reject("a square symmetric matrix", std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns));
  }
  if (matrix.is_array) {
    lines.EndOfLine();
    ReadArray(&lines, &matrix);
    return matrix;
  }
  const std::int64_t count = lines.Integer(0, kMost, "a number of entries");
  lines.EndOfLine();
  ReadCoordinates(&lines, count, &matrix);
  RequireNoneTwice(matrix, name);
  return matrix;
}

void WriteMarketMatrix(const SparseMatrix& matrix, std::ostream& output) {
  const bool symmetric = IsSymmetric(matrix);
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
  const std::filesystem::path file(path);
  const std::string id = file.stem().string();
  const std::filesystem::path b_path = PartOf(file, "_b");
  const std::optional<MarketMatrix> b_file = ReadPart(b_path);
  if (!b_file.has_value()) throw InputError(b_path.string() + ": cannot be opened; expected the vector b");
  Eigen::VectorXd b = b_file->ToVector(b_path.string());
  const Index n = b.size();

  std::vector<Index> bilateral;
  if (const auto rows = ReadPart(PartOf(file, "_bilateral"))) {
    const std::string name = PartOf(file, "_bilateral").string();
    for (const double value : rows->ToVector(name)) {
      if (!(value >= 1 && value <= static_cast<double>(n) && value == std::floor(value))) {
        throw InputError(name + ": expected row numbers from 1 to " + std::to_string(n) + ", found " +
                         RoundTripDigits(value));
      }
      bilateral.push_back(static_cast<Index>(value) - 1);
    }
  }
  std::optional<Eigen::VectorXd> x;
  if (const auto known = ReadPart(PartOf(file, "_x"))) {
    x = known->ToVector(PartOf(file, "_x").string());
    if (x->size() != n) RequireShape(*known, n, 1, PartOf(file, "_x"));
  }
  RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral);
  const auto J = ReadPart(PartOf(file, "_J"));
  const auto inverse_mass = ReadPart(PartOf(file, "_invM"));
  if (J.has_value() != inverse_mass.has_value()) {
    throw InputError(PartOf(file, J.has_value() ? "_invM" : "_J").string() +
                     ": cannot be opened; expected both factors, or none");
  }
  if (J.has_value()) {
    Eigen::VectorXd masses = inverse_mass->ToVector(PartOf(file, "_invM").string());
    RequireShape(*J, n, masses.size(), PartOf(file, "_J"));
    return {LcpProblem::FromFactors(id, J->ToSparse(), std::move(masses), std::move(b), std::move(bounds)),
            std::move(x)};
  }
  const auto A = ReadPart(file);
  if (!A.has_value()) throw InputError(path + ": cannot be opened; expected the matrix A, or its factors");
  RequireShape(*A, n, n, file);
  return {LcpProblem::FromSparse(id, A->ToSparse(), std::move(b), std::move(bounds)), std::move(x)};
}

void WriteMarketProblem(const LcpProblem& problem, const std::string& path) {
  const std::filesystem::path file(path);
  WritePart(file, true, [&](std::ostream& out) { WriteMarketMatrix(problem.SparseA(), out); });
  WritePart(PartOf(file, "_b"), true, [&](std::ostream& out) { WriteMarketVector(problem.b(), out); });
  const bool factors = problem.has_factors();
  WritePart(PartOf(file, "_J"), factors, [&](std::ostream& out) { WriteMarketMatrix(problem.J(), out); });
  WritePart(PartOf(file, "_invM"), factors, [&](std::ostream& out) { WriteMarketVector(problem.inverse_mass(), out); });
  const std::vector<Index>& bilateral = problem.bilateral_rows();
  WritePart(PartOf(file, "_bilateral"), !bilateral.empty(), [&](std::ostream& out) {
    Eigen::VectorXd rows(static_cast<Index>(bilateral.size()));
    for (Index k = 0; k < rows.size(); ++k) rows[k] = static_cast<double>(bilateral[static_cast<size_t>(k)] + 1);
    WriteMarketVector(rows, out);
  });
  WritePart(PartOf(file, "_x"), false, [](std::ostream&) {});
}

}  // namespace lcpbench
