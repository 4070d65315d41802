#include "solvers/io/siconos_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/io/text_words.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<int>::max() - 1;

enum Storage { kDenseStorage = 0, kSparseStorage = 2 };
enum SparseOrigin { kTriplet = 1, kColumns = 2 };

// Rows of a block of equations.
struct Block {
  std::int64_t begin, end;
};

struct MixedProblem {
  Index size = 0;
  bool is_dense = true;
  Eigen::MatrixXd dense;                             // M
  std::vector<Eigen::Triplet<double, int>> entries;  // of a sparse M
  std::vector<double> q;
  std::vector<Block> equations;   // ascending
  std::int64_t most_answers = 0;  // numbers that may follow: z of all rows, w of the complementarity rows

  SparseMatrix Sparse() const {
    SparseMatrix sparse(size, size);
    sparse.setFromTriplets(entries.begin(), entries.end());
    return sparse;
  }
  RowBounds Bounds() const {
    RowBounds bounds;
    bounds.bilateral.assign(static_cast<size_t>(size), 0);
    for (const Block& block : equations) {
      std::fill(bounds.bilateral.begin() + block.begin, bounds.bilateral.begin() + block.end, 1);
    }
    return bounds;
  }
};

void RequireLine(TextWords* words, const std::string& expected) {
  if (!words->NextLine()) words->RejectEnd(expected);
}

// @return how many entries follow
std::int64_t ReadSparseHeader(TextWords* words, std::int64_t n, SparseOrigin origin) {
  words->Expect("");
  RequireLine(words, "a line 'CSparse ...'");
  words->Expect("CSparse");
  RequireLine(words, "a line 'R-by-C, nzmax: N nnz: N'");
  if (origin == kTriplet) words->Expect("triplet:");
  words->Expect(std::to_string(n) + "-by-" + std::to_string(n) + ",");
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

void ReadSparse(TextWords* words, SparseOrigin origin, MixedProblem* problem) {
  const std::int64_t n = problem->size;
  const std::int64_t count = ReadSparseHeader(words, n, origin);
  std::int64_t read = 0;
  const auto read_entry = [&](std::int64_t column) {
    RequireLine(words, "entry " + std::to_string(++read) + " of " + std::to_string(count));
    const std::int64_t row = words->Integer(0, n - 1, "a row");
    if (origin == kTriplet) column = words->Integer(0, n - 1, "a column");
    words->Expect(":");
    problem->entries.emplace_back(static_cast<int>(row), static_cast<int>(column), words->Number());
    words->Expect("");
  };
  if (origin == kTriplet) {
    while (read < count) read_entry(0);
    return;
  }
  for (std::int64_t column = 0; column < n; ++column) {
    RequireLine(words, "column " + std::to_string(column) + " of " + std::to_string(n));
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

void ReadShape(TextWords* words, std::int64_t n) {
  words->IntegerOfAnyLine(n, n, "a number of rows");
  words->IntegerOfAnyLine(n, n, "a number of columns");
}

// A block of a matrix, in the order of its numbers in the file.
template <int order>
Eigen::MatrixXd ReadBlock(TextWords* words, Index rows, Index columns, const char* name) {
  const std::vector<double> numbers = words->NumbersOfAnyLine(rows * columns, name);
  using Numbers = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, order>;
  return Eigen::Map<const Numbers>(numbers.data(), rows, columns);
}

// M without storage and shape, and q.
void ReadMatrixAndVector(TextWords* words, std::int64_t storage, MixedProblem* problem) {
  problem->is_dense = storage == kDenseStorage;
  if (problem->is_dense) {
    ReadShape(words, problem->size);
    problem->dense = ReadBlock<Eigen::ColMajor>(words, problem->size, problem->size, "a matrix");
  } else if (storage != kSparseStorage) {
    words->Reject("a matrix of storage 0 (dense) or 2 (sparse)", std::to_string(storage));
  } else {
    const auto origin = static_cast<SparseOrigin>(
        words->IntegerOfAnyLine(kTriplet, kColumns, "a sparse form, triplets (1) or compressed columns (2),"));
    ReadSparse(words, origin, problem);
  }
  problem->q = words->NumbersOfAnyLine(problem->size, "q");
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

// The problem of A, B, C, D, a and b: dense, equations first.
MixedProblem ReadParts(TextWords* words, std::int64_t n, std::int64_t m) {
  const auto read = [words](Index rows, Index columns, const char* name) {
    return ReadBlock<Eigen::RowMajor>(words, rows, columns, name);
  };
  const Eigen::MatrixXd A = read(n, n, "A"), B = read(m, m, "B"), C = read(n, m, "C"), D = read(m, n, "D");
  MixedProblem problem;
  problem.size = n + m;
  problem.q = words->NumbersOfAnyLine(n, "a");
  const std::vector<double> b = words->NumbersOfAnyLine(m, "b");
  problem.q.insert(problem.q.end(), b.begin(), b.end());
  problem.most_answers = n + 2 * m;
  problem.equations = {{0, n}};
  problem.dense.resize(n + m, n + m);
  problem.dense.topLeftCorner(n, n) = A;
  problem.dense.topRightCorner(n, m) = C;
  problem.dense.bottomLeftCorner(m, n) = D;
  problem.dense.bottomRightCorner(m, m) = B;
  return problem;
}

void RequireSame(TextWords* words, const MixedProblem& given, const MixedProblem& parts) {
  const SparseMatrix sparse = given.is_dense ? SparseMatrix() : given.Sparse();
  const RowBounds bounds = given.Bounds();
  std::vector<Index> order(static_cast<size_t>(given.size));  // the row of M for every row of the parts
  std::iota(order.begin(), order.end(), 0);
  std::stable_partition(order.begin(), order.end(),
                        [&](Index row) { return bounds.bilateral[static_cast<size_t>(row)] != 0; });
  const auto require = [&](double expected, double found, const std::string& where) {
    if (expected == found) return;
    words->Reject("A to b as M and q have them, " + RoundTripDigits(expected) + " " + where, RoundTripDigits(found));
  };
  for (Index j = 0; j < given.size; ++j) {
    const Index column = order[static_cast<size_t>(j)];
    for (Index i = 0; i < given.size; ++i) {
      const Index row = order[static_cast<size_t>(i)];
      require(given.is_dense ? given.dense(row, column) : sparse.coeff(row, column), parts.dense(i, j),
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
  problem.most_answers = n + 2 * m;
  problem.equations = ReadBlocks(words, n, problem.size);
  const std::int64_t storage = words->IntegerOfAnyLine(0, kMost, "a storage");
  ReadShape(words, problem.size);
  ReadMatrixAndVector(words, storage, &problem);
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
  ReadMatrixAndVector(words, head[1], &problem);
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
  MixedProblem read = Read(&words);
  RequireEnd(&words, read.most_answers);
  Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(read.q.data(), read.size);
  try {
    if (!read.is_dense) return LcpProblem::FromSparse(id, read.Sparse(), std::move(q), read.Bounds());
    return LcpProblem::FromDense(id, std::move(read.dense), std::move(q), read.Bounds());
  } catch (const InputError& error) {  // entries of one place whose sum overflows
    throw InputError(name + ": " + error.what());
  }
}

LcpProblem ReadSiconosProblem(const std::string& path) {
  std::error_code no_folder;
  if (std::filesystem::is_directory(path, no_folder)) throw InputError(path + ": is a folder, expected a file");
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened");
  return ReadSiconosText(file, path, std::filesystem::path(path).stem().string());
}

void WriteSiconosText(const LcpProblem& problem, std::ostream& output) {
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
