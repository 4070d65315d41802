#include "solvers/io/siconos_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "solvers/io/text_words.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<int>::max() - 1;

enum Storage { kDenseStorage = 0, kSparseStorage = 2 };
enum SparseOrigin { kTriplet = 1, kColumns = 2 };

struct NumericsMatrix {
  bool is_dense = true;
  std::vector<double> by_columns;                    // dense
  std::vector<Eigen::Triplet<double, int>> entries;  // sparse
};

struct MixedProblem {
  std::int64_t size = 0;
  NumericsMatrix M;
  std::vector<double> q;
  std::vector<Index> equations;   // ascending
  std::int64_t most_answers = 0;  // numbers that may follow: z of all rows, w of the complementarity rows
};

// A word that ends a label: "nnz:", ":", "to".
void Expect(TextWords* words, std::string_view expected) {
  const std::string_view word = words->Word();
  if (word != expected) words->Reject("'" + std::string(expected) + "'", word);
}

// "3-by-3,"
void ReadShape(TextWords* words, std::string_view word, std::int64_t n) {
  const std::string expected = std::to_string(n) + "-by-" + std::to_string(n) + ",";
  if (word != expected) words->Reject("'" + expected + "'", word);
}

void AddEntry(TextWords* words, std::int64_t row, std::int64_t column, NumericsMatrix* matrix) {
  Expect(words, ":");
  const double value = words->Number();
  words->EndOfLine();
  matrix->entries.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
}

void RequireLine(TextWords* words, const std::string& expected) {
  if (!words->NextLine()) words->RejectEnd(expected);
}

// @return how many entries follow
std::int64_t ReadSparseHeader(TextWords* words, std::int64_t n, SparseOrigin origin) {
  words->EndOfLine();
  RequireLine(words, "a line 'CSparse ...'");
  Expect(words, "CSparse");
  RequireLine(words, "a line 'R-by-C, nzmax: N nnz: N'");
  if (origin == kTriplet) Expect(words, "triplet:");
  ReadShape(words, words->Word(), n);
  Expect(words, "nzmax:");
  words->Integer(0, kMost, "a number of places");
  Expect(words, "nnz:");
  if (origin == kTriplet) {
    const std::int64_t count = words->Integer(0, kMost, "a number of entries");
    words->EndOfLine();
    return count;
  }
  // "4, 1-norm: 2": the norm is not needed.
  std::string_view word = words->Word();
  if (!word.empty() && word.back() == ',') word.remove_suffix(1);
  std::int64_t count = -1;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count < 0 || count > kMost) {
    words->Reject("a number of entries from 0 to " + std::to_string(kMost), word);
  }
  return count;
}

void ReadTriplets(TextWords* words, std::int64_t n, std::int64_t count, NumericsMatrix* matrix) {
  for (std::int64_t k = 0; k < count; ++k) {
    RequireLine(words, "entry " + std::to_string(k + 1) + " of " + std::to_string(count));
    const std::int64_t row = words->Integer(0, n - 1, "a row");
    const std::int64_t column = words->Integer(0, n - 1, "a column");
    AddEntry(words, row, column, matrix);
  }
}

void ReadColumns(TextWords* words, std::int64_t n, std::int64_t count, NumericsMatrix* matrix) {
  std::int64_t read = 0;
  for (std::int64_t column = 0; column < n; ++column) {
    RequireLine(words, "column " + std::to_string(column) + " of " + std::to_string(n));
    Expect(words, "col");
    words->Integer(column, column, "the number of a column");
    Expect(words, ":");
    Expect(words, "locations");
    words->Integer(read, read, "a first location");
    Expect(words, "to");
    const std::int64_t last = words->Integer(read - 1, count - 1, "a last location");
    words->EndOfLine();
    for (; read <= last; ++read) {
      RequireLine(words, "entry " + std::to_string(read + 1) + " of " + std::to_string(count));
      AddEntry(words, words->Integer(0, n - 1, "a row"), column, matrix);
    }
  }
  if (read != count) words->Reject(std::to_string(count) + " entries in all columns", std::to_string(read));
}

std::int64_t ReadStorage(TextWords* words) { return words->IntegerOfAnyLine(0, kMost, "a storage"); }

void ReadShape(TextWords* words, std::int64_t n) {
  words->IntegerOfAnyLine(n, n, "a number of rows");
  words->IntegerOfAnyLine(n, n, "a number of columns");
}

// What follows storage and shape.
NumericsMatrix ReadEntries(TextWords* words, std::int64_t n, std::int64_t storage) {
  NumericsMatrix matrix;
  if (storage == kDenseStorage) {
    ReadShape(words, n);
    matrix.by_columns = words->NumbersOfAnyLine(n * n, "a matrix");
    return matrix;
  }
  if (storage != kSparseStorage) {
    words->Reject("a matrix of storage 0 (dense) or 2 (sparse)", std::to_string(storage));
  }
  matrix.is_dense = false;
  const auto origin = static_cast<SparseOrigin>(
      words->IntegerOfAnyLine(kTriplet, kColumns, "a sparse form, triplets (1) or compressed columns (2),"));
  const std::int64_t count = ReadSparseHeader(words, n, origin);
  if (origin == kTriplet) {
    ReadTriplets(words, n, count, &matrix);
  } else {
    ReadColumns(words, n, count, &matrix);
  }
  return matrix;
}

struct Block {
  std::int64_t begin, end;
};

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

std::vector<Index> RowsOf(const std::vector<Block>& blocks) {
  std::vector<Index> rows;
  for (const Block& block : blocks) {
    for (Index row = block.begin; row < block.end; ++row) rows.push_back(row);
  }
  return rows;
}

SparseMatrix SparseOf(const MixedProblem& problem) {
  SparseMatrix sparse(problem.size, problem.size);
  sparse.setFromTriplets(problem.M.entries.begin(), problem.M.entries.end());
  return sparse;
}

// The problem of A, B, C, D, a and b: dense, equations first.
MixedProblem ReadParts(TextWords* words, std::int64_t n, std::int64_t m) {
  const std::int64_t size = n + m;
  const std::vector<double> A = words->NumbersOfAnyLine(n * n, "A");
  const std::vector<double> B = words->NumbersOfAnyLine(m * m, "B");
  const std::vector<double> C = words->NumbersOfAnyLine(n * m, "C");
  const std::vector<double> D = words->NumbersOfAnyLine(m * n, "D");
  MixedProblem problem;
  problem.size = size;
  problem.q = words->NumbersOfAnyLine(n, "a");
  const std::vector<double> b = words->NumbersOfAnyLine(m, "b");
  problem.q.insert(problem.q.end(), b.begin(), b.end());
  problem.most_answers = size + m;
  problem.equations = RowsOf({{0, n}});
  problem.M.by_columns.resize(static_cast<size_t>(size * size));
  const auto place = [&](const std::vector<double>& part, std::int64_t row, std::int64_t column, std::int64_t columns) {
    for (size_t k = 0; k < part.size(); ++k) {
      const auto at = static_cast<std::int64_t>(k);
      problem.M.by_columns[static_cast<size_t>((column + at % columns) * size + row + at / columns)] = part[k];
    }
  };
  place(A, 0, 0, n);
  place(B, n, n, m);
  place(C, 0, n, m);
  place(D, n, 0, n);
  return problem;
}

void RequireSame(TextWords* words, const MixedProblem& given, const MixedProblem& parts) {
  const SparseMatrix sparse = given.M.is_dense ? SparseMatrix() : SparseOf(given);
  std::vector<Index> order = given.equations;  // the row of M for every row of the parts
  std::vector<bool> is_equation(static_cast<size_t>(given.size), false);
  for (const Index row : given.equations) is_equation[static_cast<size_t>(row)] = true;
  for (Index row = 0; row < given.size; ++row) {
    if (!is_equation[static_cast<size_t>(row)]) order.push_back(row);
  }
  const auto require = [&](double expected, double found, const std::string& where) {
    if (expected == found) return;
    words->Reject("A to b as M and q have them, " + RoundTripDigits(expected) + " " + where, RoundTripDigits(found));
  };
  size_t k = 0;
  for (const Index column : order) {
    for (const Index row : order) {
      const double expected = given.M.is_dense ? given.M.by_columns[static_cast<size_t>(column * given.size + row)]
                                               : sparse.coeff(row, column);
      require(expected, parts.M.by_columns[k++],
              "in row " + std::to_string(row) + " and column " + std::to_string(column));
    }
  }
  for (size_t i = 0; i < order.size(); ++i) {
    require(given.q[static_cast<size_t>(order[i])], parts.q[i], "in row " + std::to_string(order[i]));
  }
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
  if (n + m > kMost) words->Reject("at most " + std::to_string(kMost) + " rows", std::to_string(n + m));
  if (!has_M && !has_parts) words->Reject("M and q, or A to b, or both", "0 0");
  if (!has_M) return ReadParts(words, n, m);
  MixedProblem problem;
  problem.size = n + m;
  problem.most_answers = problem.size + m;
  const std::vector<Block> equations = ReadBlocks(words, n, problem.size);
  const std::int64_t storage = ReadStorage(words);
  ReadShape(words, problem.size);
  problem.M = ReadEntries(words, problem.size, storage);
  problem.q = words->NumbersOfAnyLine(problem.size, "q");
  problem.equations = RowsOf(equations);  // now that q has shown so many rows to be there
  if (has_parts) RequireSame(words, problem, ReadParts(words, n, m));
  return problem;
}

// LCP: n, storage, n, n. MLCP: flag, flag, n, m. Both look alike for one row, where the next word of an MLCP, the first
// row of a block, is 0, and that of an LCP never.
bool IsMixed(TextWords* words, const std::array<std::int64_t, 4>& head) {
  const bool may_be_lcp = head[2] == head[0] && head[3] == head[0];
  const bool may_be_mixed = head[0] <= 1 && head[1] <= 1;
  return may_be_mixed && (!may_be_lcp || (head[0] == 1 && words->PeekOfAnyLine() == "0"));
}

MixedProblem Read(TextWords* words) {
  std::array<std::int64_t, 4> head{};
  for (std::int64_t& number : head) number = words->IntegerOfAnyLine(0, kMost, "a size, a storage or a flag");
  if (IsMixed(words, head)) return ReadMixed(words, head[0] == 1, head[1] == 1, head[2], head[3]);
  MixedProblem problem;
  problem.size = head[0];
  for (const std::int64_t side : {head[2], head[3]}) {
    if (side == problem.size) continue;
    words->Reject("a matrix of " + std::to_string(problem.size) + " x " + std::to_string(problem.size) + " entries",
                  std::to_string(head[2]) + " x " + std::to_string(head[3]));
  }
  problem.M = ReadEntries(words, problem.size, head[1]);
  problem.q = words->NumbersOfAnyLine(problem.size, "q");
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

LcpProblem ReadSiconosText(std::istream& input, const std::string& name, const std::string& id) {
  TextWords words(input, name);
  const MixedProblem read = Read(&words);
  RequireEnd(&words, read.most_answers);
  const auto n = static_cast<Index>(read.size);
  Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(read.q.data(), n);
  RowBounds bounds = RowBounds::WithBilateralRows(n, read.equations);
  try {
    if (!read.M.is_dense) return LcpProblem::FromSparse(id, SparseOf(read), std::move(q), std::move(bounds));
    Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(read.M.by_columns.data(), n, n);
    return LcpProblem::FromDense(id, std::move(M), std::move(q), std::move(bounds));
  } catch (const InputError& error) {  // entries of one place whose sum overflows
    throw InputError(name + ": " + error.what());
  }
}

LcpProblem ReadSiconosProblem(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw InputError(path + ": is a folder, expected a file");
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened");
  return ReadSiconosText(file, path, std::filesystem::path(path).stem().string());
}

void WriteSiconosText(const LcpProblem& problem, std::ostream& output) {
  if (!problem.has_standard_bounds()) {
    throw InputError("problem '" + problem.id() + "': expected unilateral and bilateral rows only, found other bounds");
  }
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
  std::ofstream file(path);
  if (file) WriteSiconosText(problem, file);
  file.close();
  if (!file) throw InputError(path + ": cannot be written");
}

}  // namespace lcpbench
