#include "solvers/io/siconos_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/io/file_ending.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/text_words.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<int>::max() - 1;

enum Storage { kDenseStorage = 0, kBlockStorage = 1, kSparseStorage = 2 };
enum SparseOrigin { kTriplet = 1, kColumns = 2 };

// Rows of a block of equations.
struct Block {
  std::int64_t begin, end;
};

struct StoredMatrix {
  Index rows = 0, columns = 0;
  bool is_dense = true;
  Eigen::MatrixXd dense;
  std::vector<Eigen::Triplet<double, int>> entries;  // of a sparse one

  SparseMatrix Sparse() const {
    SparseMatrix sparse(rows, columns);
    sparse.setFromTriplets(entries.begin(), entries.end());
    return sparse;
  }
};

struct MixedProblem {
  StoredMatrix M;
  std::vector<double> q;
  std::vector<Block> equations;  // ascending
  std::vector<FrictionRow> friction;
  std::int64_t most_answers = 0;  // numbers that may follow: z of all rows, w of the complementarity rows

  Index size() const { return M.rows; }
  RowBounds Bounds() const {
    RowBounds bounds;
    bounds.bilateral.assign(static_cast<size_t>(size()), 0);
    for (const Block& block : equations) {
      std::fill(bounds.bilateral.begin() + block.begin, bounds.bilateral.begin() + block.end, 1);
    }
    bounds.friction = friction;
    return bounds;
  }
};

void RequireLine(TextWords* words, const std::string& expected) {
  if (!words->NextLine()) words->RejectEnd(expected);
}

// @return how many entries follow
std::int64_t ReadSparseHeader(TextWords* words, const StoredMatrix& matrix, SparseOrigin origin) {
  words->Expect("");
  RequireLine(words, "a line 'CSparse ...'");
  words->Expect("CSparse");
  RequireLine(words, "a line 'R-by-C, nzmax: N nnz: N'");
  if (origin == kTriplet) words->Expect("triplet:");
  words->Expect(std::to_string(matrix.rows) + "-by-" + std::to_string(matrix.columns) + ",");
  words->Expect("nzmax:");
  words->Integer(0, kMost, "a number of places");
  words->Expect("nnz:");
  std::string_view word = words->Word();
  // "4, 1-norm: 2": the norm is not needed.
  if (origin == kColumns && word.ends_with(',')) word.remove_suffix(1);
  const std::int64_t count = words->Integer(0, kMost, "a number of entries", word);
  if (origin == kTriplet) words->Expect("");
  return count;
}

void ReadSparse(TextWords* words, SparseOrigin origin, StoredMatrix* matrix) {
  const std::int64_t count = ReadSparseHeader(words, *matrix, origin);
  std::int64_t read = 0;
  const auto read_entry = [&](std::int64_t column) {
    RequireLine(words, "entry " + std::to_string(++read) + " of " + std::to_string(count));
    const std::int64_t row = words->Integer(0, matrix->rows - 1, "a row");
    if (origin == kTriplet) column = words->Integer(0, matrix->columns - 1, "a column");
    words->Expect(":");
    matrix->entries.emplace_back(static_cast<int>(row), static_cast<int>(column), words->Number());
    words->Expect("");
  };
  if (origin == kTriplet) {
    while (read < count) read_entry(0);
    return;
  }
  for (std::int64_t column = 0; column < matrix->columns; ++column) {
    RequireLine(words, "column " + std::to_string(column) + " of " + std::to_string(matrix->columns));
    words->Expect("col");
    words->Integer(column, column, "the number of a column");
    words->Expect(":");
    words->Expect("locations");
    words->Integer(read, read, "a first location");
    words->Expect("to");
    const std::int64_t last = words->Integer(read - 1, count - 1, "a last location");
    words->Expect("");
    while (read <= last) read_entry(column);
  }
  if (read != count) words->Reject(std::to_string(count) + " entries in all columns", std::to_string(read));
}

// A part of a matrix, in the order of its numbers in the file.
template <int order>
Eigen::MatrixXd ReadPart(TextWords* words, Index rows, Index columns, const char* name) {
  const std::vector<double> numbers = words->NumbersOfAnyLine(rows * columns, name);
  using Numbers = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, order>;
  return Eigen::Map<const Numbers>(numbers.data(), rows, columns);
}

// The ends of the rows, or columns, of `count` blocks, of which the last is `end`.
std::vector<std::int64_t> ReadEnds(TextWords* words, std::int64_t count, std::int64_t end) {
  std::vector<std::int64_t> ends;
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t least = k + 1 == count ? end : (ends.empty() ? 0 : ends.back());
    ends.push_back(words->IntegerOfAnyLine(least, end, "the end of a block"));
  }
  return ends;
}

// Blocks that are dense, column by column, with the number of each before it.
void ReadSparseBlocks(TextWords* words, StoredMatrix* matrix) {
  const std::int64_t count = words->IntegerOfAnyLine(0, kMost, "a number of blocks");
  if (count == 0) return;  // Siconos' files say nothing more of a matrix 0
  const std::int64_t block_rows = words->IntegerOfAnyLine(1, kMost, "a number of rows of blocks");
  const std::int64_t block_columns = words->IntegerOfAnyLine(1, kMost, "a number of columns of blocks");
  const std::vector<std::int64_t> row_ends = ReadEnds(words, block_rows, matrix->rows);
  const std::vector<std::int64_t> column_ends = ReadEnds(words, block_columns, matrix->columns);
  const std::int64_t starts =
      words->IntegerOfAnyLine(2, block_rows + 1, "one more than the rows up to the last block,");
  words->IntegerOfAnyLine(count, count, "the number of blocks again");
  std::vector<std::int64_t> first_blocks, columns;
  for (std::int64_t k = 0; k < starts; ++k) {
    const std::int64_t least = k == 0 ? 0 : (k + 1 == starts ? count : first_blocks.back());
    first_blocks.push_back(words->IntegerOfAnyLine(least, k == 0 ? 0 : count, "the first block of a row"));
  }
  for (std::int64_t k = 0; k < count; ++k) {
    columns.push_back(words->IntegerOfAnyLine(0, block_columns - 1, "the column of a block"));
  }
  std::size_t row = 0;
  for (std::int64_t k = 0; k < count; ++k) {
    while (first_blocks[row + 1] <= k) ++row;
    words->IntegerOfAnyLine(k, k, "the number of a block");
    const auto column = static_cast<std::size_t>(columns[static_cast<std::size_t>(k)]);
    const std::int64_t top = row == 0 ? 0 : row_ends[row - 1], left = column == 0 ? 0 : column_ends[column - 1];
    for (std::int64_t j = left; j < column_ends[column]; ++j) {
      std::int64_t i = top;
      for (const double value : words->NumbersOfAnyLine(row_ends[row] - top, "a column of a block")) {
        matrix->entries.emplace_back(static_cast<int>(i++), static_cast<int>(j), value);
      }
    }
  }
}

// What follows storage and shape.
StoredMatrix ReadMatrix(TextWords* words, std::int64_t storage, std::int64_t rows, std::int64_t columns) {
  StoredMatrix matrix;
  matrix.rows = rows;
  matrix.columns = columns;
  matrix.is_dense = storage == kDenseStorage;
  if (matrix.is_dense) {
    words->IntegerOfAnyLine(rows, rows, "a number of rows");
    words->IntegerOfAnyLine(columns, columns, "a number of columns");
    matrix.dense = ReadPart<Eigen::ColMajor>(words, rows, columns, "a matrix");
  } else if (storage == kBlockStorage) {
    ReadSparseBlocks(words, &matrix);
  } else if (storage == kSparseStorage) {
    const auto origin = static_cast<SparseOrigin>(
        words->IntegerOfAnyLine(kTriplet, kColumns, "a sparse form, triplets (1) or compressed columns (2),"));
    ReadSparse(words, origin, &matrix);
  } else {
    words->Reject("a matrix of storage 0 (dense), 1 (sparse blocks) or 2 (sparse)", std::to_string(storage));
  }
  return matrix;
}

// The blocks of equations.
std::vector<Block> ReadBlocks(TextWords* words, std::int64_t equations, std::int64_t size) {
  std::vector<std::int64_t> first_rows{words->IntegerOfAnyLine(0, 0, "the first row of the first block")};
  while (first_rows.back() < size) {
    first_rows.push_back(words->IntegerOfAnyLine(first_rows.back(), size, "the first row of the next block"));
  }
  std::vector<Block> blocks;
  std::int64_t count = 0;
  for (size_t k = 0; k + 1 < first_rows.size(); ++k) {
    if (words->IntegerOfAnyLine(0, 1, "the kind of a block") != 0) continue;
    blocks.push_back({first_rows[k], first_rows[k + 1]});
    count += first_rows[k + 1] - first_rows[k];
  }
  if (count != equations) {
    words->Reject("blocks of " + std::to_string(equations) + " equations", std::to_string(count));
  }
  return blocks;
}

// M = [A C; D B] and q = [a; b], dense, equations first.
MixedProblem ReadParts(TextWords* words, std::int64_t n, std::int64_t m) {
  const auto read = [words](Index rows, Index columns, const char* name) {
    return ReadPart<Eigen::RowMajor>(words, rows, columns, name);
  };
  MixedProblem problem;
  problem.M.rows = problem.M.columns = n + m;
  problem.equations = {{0, n}};
  const Eigen::MatrixXd A = read(n, n, "A"), B = read(m, m, "B"), C = read(n, m, "C"), D = read(m, n, "D");
  problem.M.dense.resize(n + m, n + m);
  problem.M.dense << A, C, D, B;
  problem.q = words->NumbersOfAnyLine(n, "a");
  const std::vector<double> b = words->NumbersOfAnyLine(m, "b");
  problem.q.insert(problem.q.end(), b.begin(), b.end());
  return problem;
}

void RequireEqual(TextWords* words, double expected, double found, const std::string& where) {
  if (expected == found) return;
  words->Reject("A to b as M and q have them, " + RoundTripDigits(expected) + " " + where, RoundTripDigits(found));
}

// M and q, and the parts that the file has besides, must agree. What Siconos prints of A, C and a is of n equations,
// whatever M has.
// @param first  row of the parts; the others are those of `rows` of M and q, in their order
void RequireSame(TextWords* words, const StoredMatrix& M, const std::vector<double>& q, const MixedProblem& parts,
                 Index first, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  const SparseMatrix sparse = M.is_dense ? SparseMatrix() : M.Sparse();
  for (size_t i = 0; i < rows.size(); ++i) {
    const Index row = rows[i], part = first + static_cast<Index>(i);
    const std::string where = "in row " + std::to_string(row);
    for (size_t j = 0; j < columns.size(); ++j) {
      const Index column = columns[j];
      RequireEqual(words, M.is_dense ? M.dense(row, column) : sparse.coeff(row, column),
                   parts.M.dense(part, static_cast<Index>(j)), where + " and column " + std::to_string(column));
    }
    if (row >= static_cast<Index>(q.size())) continue;
    RequireEqual(words, q[static_cast<size_t>(row)], parts.q[static_cast<size_t>(part)], where);
  }
}

std::vector<Index> Range(Index first, Index end) {
  std::vector<Index> range(static_cast<size_t>(end - first));
  std::iota(range.begin(), range.end(), first);
  return range;
}

// Rows and columns 0 beside the n free unknowns, or below the equations, until there is one equation for each: an
// equation 0 = 0, or an unknown that acts on nothing.
MixedProblem MakeSquare(const StoredMatrix& M, const std::vector<double>& q, std::int64_t n, std::int64_t m) {
  const Index equations = M.rows - m;
  const Index free = std::max<Index>(equations, n);
  const auto new_row = [&](Index row) { return row < equations ? row : row - equations + free; };
  const auto new_column = [&](Index column) { return column < n ? column : column - n + free; };
  MixedProblem problem;
  problem.M.rows = problem.M.columns = free + m;
  problem.M.is_dense = false;  // whatever n is: most of it may be 0
  const auto add = [&](Index row, Index column, double value) {
    problem.M.entries.emplace_back(static_cast<int>(new_row(row)), static_cast<int>(new_column(column)), value);
  };
  for (Index j = 0; j < M.dense.cols(); ++j) {
    for (Index i = 0; i < M.dense.rows(); ++i) add(i, j, M.dense(i, j));
  }
  for (const auto& entry : M.entries) add(entry.row(), entry.col(), entry.value());
  problem.q.assign(static_cast<size_t>(free + m), 0.0);
  for (Index row = 0; row < M.rows; ++row) {
    problem.q[static_cast<size_t>(new_row(row))] = q[static_cast<size_t>(row)];
  }
  problem.equations = {{0, free}};
  return problem;
}

// M has n + m columns and another number of rows: the equations, and the m complementarity rows last. Siconos prints
// n + m numbers of q whatever its rows are; the last m are also b.
MixedProblem ReadRectangular(TextWords* words, const StoredMatrix& M, const std::vector<Block>& equations,
                             bool has_parts, std::int64_t n, std::int64_t m) {
  const auto text = [](std::int64_t number) { return std::to_string(number); };
  if (M.rows < m) words->Reject("a matrix of at least " + text(m) + " complementarity rows", text(M.rows));
  for (const Block& block : equations) {
    if (block.begin < block.end && block.end > n) {
      words->Reject("all equations before all complementarity rows, as M is not square", "another order of blocks");
    }
  }
  std::vector<double> q = words->NumbersOfAnyLine(n + m, "q");
  const Index known = n + m;
  if (M.rows > known && (!has_parts || M.rows - m > known)) {
    words->Reject("q of " + text(M.rows) + " rows, in q and b together", text(known) + (has_parts ? " and b" : ""));
  }
  if (has_parts) {
    const MixedProblem parts = ReadParts(words, n, m);
    q.resize(static_cast<size_t>(std::min<Index>(known, M.rows)));
    RequireSame(words, M, q, parts, n, Range(M.rows - m, M.rows), Range(0, known));
    for (Index row = known; row < M.rows; ++row) q.push_back(parts.q[static_cast<size_t>(row - M.rows + known)]);
  }
  return MakeSquare(M, q, n, m);
}

// Words may follow, and behind an MLCP a known answer, as in Siconos' own collection; more numbers are too many.
void RequireEnd(TextWords* words, std::int64_t most_numbers) {
  constexpr std::string_view kBeginsNumber = "0123456789+-.";
  const auto begins_number = [&](std::string_view word) {
    return !word.empty() && kBeginsNumber.find(word.front()) != std::string_view::npos;
  };
  for (std::int64_t k = 0; begins_number(words->PeekOfAnyLine()); ++k) {
    if (k == most_numbers) {
      words->Reject("the end of the file or a remark in words after the last number", words->PeekOfAnyLine());
    }
    words->NumbersOfAnyLine(1, "a known answer");
  }
}

MixedProblem ReadMixed(TextWords* words, bool has_M, bool has_parts, std::int64_t n, std::int64_t m) {
  const std::int64_t size = n + m;
  if (size > kMost) words->Reject("at most " + std::to_string(kMost) + " rows", std::to_string(size));
  if (!has_M && !has_parts) words->Reject("M and q, or A to b, or both", "0 0");
  if (!has_M) return ReadParts(words, n, m);
  const std::vector<Block> equations = ReadBlocks(words, n, size);
  const std::int64_t storage = words->IntegerOfAnyLine(0, kMost, "a storage");
  const std::int64_t rows = words->IntegerOfAnyLine(0, kMost - size, "a number of rows");
  words->IntegerOfAnyLine(size, size, "a number of columns");
  MixedProblem problem;
  problem.M = ReadMatrix(words, storage, rows, size);
  if (rows != size) return ReadRectangular(words, problem.M, equations, has_parts, n, m);
  problem.q = words->NumbersOfAnyLine(size, "q");
  problem.equations = equations;
  if (has_parts) {
    const MixedProblem parts = ReadParts(words, n, m);
    const RowBounds bounds = problem.Bounds();
    std::vector<Index> order = Range(0, size);  // the row of M for every row of the parts
    std::stable_partition(order.begin(), order.end(),
                          [&](Index row) { return bounds.bilateral[static_cast<size_t>(row)] != 0; });
    RequireSame(words, problem.M, problem.q, parts, 0, order, order);
  }
  return problem;
}

// Reads W, q and mu: of every contact its normal row and its tangents, as RowsOfContacts has them.
MixedProblem ReadContacts(TextWords* words, std::int64_t dimension, std::int64_t contacts, std::int64_t storage,
                          TangentRows tangents) {
  const std::int64_t rows = dimension * contacts;
  words->IntegerOfAnyLine(rows, rows, "a number of columns");
  const StoredMatrix W = ReadMatrix(words, storage, rows, rows);
  const std::vector<double> q = words->NumbersOfAnyLine(rows, "q");
  ContactRows read =
      RowsOfContacts(static_cast<int>(dimension), words->NumbersOfAnyLine(contacts, "friction coefficients"), tangents,
                     [&](const std::string& expected, const std::string& found) { words->Reject(expected, found); });
  MixedProblem problem;
  std::vector<Index> kept;
  for (std::size_t row = 0; row < read.row.size(); ++row) {
    if (read.row[row] < 0) continue;
    kept.push_back(static_cast<Index>(row));
    problem.q.push_back(q[row]);
  }
  problem.M.rows = problem.M.columns = read.count;
  problem.M.is_dense = W.is_dense;
  if (W.is_dense) problem.M.dense = W.dense(kept, kept);
  for (const auto& entry : W.entries) {
    const int row = read.row[static_cast<std::size_t>(entry.row())];
    const int column = read.row[static_cast<std::size_t>(entry.col())];
    if (row >= 0 && column >= 0) problem.M.entries.emplace_back(row, column, entry.value());
  }
  problem.friction = std::move(read.friction);
  problem.most_answers = 1;
  return problem;
}

// Contacts: rows of a contact (2 or 3), contacts, storage, rows. LCP: n, storage, n, n; where both are possible, it is
// an LCP of two rows.
bool IsOfContacts(const std::array<std::int64_t, 4>& head) {
  const bool may_be_lcp = head[2] == head[0] && head[3] == head[0];
  return (head[0] == 2 || head[0] == 3) && head[1] > 0 && head[3] == head[0] * head[1] && head[2] <= kSparseStorage &&
         !may_be_lcp;
}

// LCP: n, storage, n, n. MLCP: flag, flag, n, m. Both look alike for one row, where the next word of an MLCP, the first
// row of a block, is 0, and that of an LCP never.
bool IsMixed(TextWords* words, const std::array<std::int64_t, 4>& head) {
  const bool may_be_lcp = head[2] == head[0] && head[3] == head[0];
  const bool may_be_mixed = head[0] <= 1 && head[1] <= 1;
  return may_be_mixed && (!may_be_lcp || (head[0] == 1 && words->PeekOfAnyLine() == "0"));
}

MixedProblem Read(TextWords* words, TangentRows tangents) {
  std::array<std::int64_t, 4> head{};
  for (std::int64_t& number : head) number = words->IntegerOfAnyLine(0, kMost, "a size, a storage or a flag");
  MixedProblem problem;
  if (IsMixed(words, head)) {
    problem = ReadMixed(words, head[0] == 1, head[1] == 1, head[2], head[3]);
    problem.most_answers = head[2] + 2 * head[3];
    return problem;
  }
  if (IsOfContacts(head)) return ReadContacts(words, head[0], head[1], head[2], tangents);
  const std::int64_t n = head[0];
  if (head[2] != n || head[3] != n) {
    words->Reject("a matrix of " + std::to_string(n) + " x " + std::to_string(n) + " entries",
                  std::to_string(head[2]) + " x " + std::to_string(head[3]));
  }
  problem.M = ReadMatrix(words, head[1], n, n);
  problem.q = words->NumbersOfAnyLine(n, "q");
  return problem;
}

void WriteMatrix(const LcpProblem& problem, std::ostream& output) {
  const Index n = problem.size();
  const auto shape = [&](char between) { output << n << between << n << '\n'; };
  if (problem.given_form() == MatrixForm::kDense) {
    const Eigen::MatrixXd& A = problem.DenseA();
    output << kDenseStorage << '\n';
    shape('\n');
    shape('\t');
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) output << RoundTripDigits(A(i, j)) << (i + 1 < n ? ' ' : '\n');
    }
    return;
  }
  const SparseMatrix& A = problem.SparseA();
  output << kSparseStorage << '\n';
  shape('\n');
  output << kTriplet << "\nCSparse\ntriplet: " << n << "-by-" << n << ", nzmax: " << A.nonZeros()
         << " nnz: " << A.nonZeros() << '\n';
  for (Index i = 0; i < n; ++i) {
    for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
      output << "    " << i << ' ' << it.col() << " : " << RoundTripDigits(it.value()) << '\n';
    }
  }
}

// The blocks of an MLCP, runs of rows of one kind.
void WriteBlocks(const LcpProblem& problem, std::ostream& output) {
  const Index n = problem.size();
  std::string kinds;
  output << 0;
  for (Index row = 0; row < n; ++row) {
    const bool is_last = row + 1 == n || problem.is_bilateral(row + 1) != problem.is_bilateral(row);
    if (!is_last) continue;
    output << ' ' << row + 1;
    kinds += problem.is_bilateral(row) ? "0 " : "1 ";
  }
  output << '\n' << kinds << '\n';
}

}  // namespace

LcpProblem ReadSiconosText(std::istream& input, const std::string& name, const std::string& id, TangentRows tangents) {
  TextWords words(input, name);
  MixedProblem read = Read(&words, tangents);
  RequireEnd(&words, read.most_answers);
  Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(read.q.data(), read.size());
  try {
    if (!read.M.is_dense) return LcpProblem::FromSparse(id, read.M.Sparse(), std::move(q), read.Bounds());
    return LcpProblem::FromDense(id, std::move(read.M.dense), std::move(q), read.Bounds());
  } catch (const InputError& error) {  // entries of one place whose sum overflows
    throw InputError(name + ": " + error.what());
  }
}

LcpProblem ReadSiconosProblem(const std::string& path, TangentRows tangents) {
  TextInput file(path);
  return ReadSiconosText(file, path, IdOfFile(path), tangents);
}

void WriteSiconosText(const LcpProblem& problem, std::ostream& output) {
  RequireNoFriction(problem, false);
  if (problem.has_factors()) {
    const SparseMatrix& A = problem.SparseA();
    if (!Eigen::Map<const Eigen::VectorXd>(A.valuePtr(), A.nonZeros()).allFinite()) {
      throw InputError("problem '" + problem.id() + "': expected factors whose product is finite, found an overflow");
    }
  }
  const Index n = problem.size();
  const auto equations = static_cast<Index>(problem.bilateral_rows().size());
  if (equations == 0) {
    output << n << '\n';
  } else {
    output << "1\n0\n" << equations << '\n' << n - equations << '\n';
    WriteBlocks(problem, output);
  }
  WriteMatrix(problem, output);
  for (Index i = 0; i < n; ++i) output << RoundTripDigits(problem.b()[i]) << (i + 1 < n ? ' ' : '\n');
}

void WriteSiconosProblem(const LcpProblem& problem, const std::string& path) {
  WriteFile(path, [&](std::ostream& file) { WriteSiconosText(problem, file); });
}

}  // namespace lcpbench
