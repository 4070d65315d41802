// FCLib's HDF5 files: round trips bit for bit, libfclib's own reader and writer, and one line for whatever is wrong.

#include "solvers/io/fclib_file.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "solvers/io/hdf5_file.h"
#include "tests/fuzz/binary_mutation.h"
#include "tests/fuzz/corpus.h"
#include "tests/fuzz/laws.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

class FclibFile : public FolderTest {
 protected:
  void ExpectRefused(const std::string& path, const std::string& words) const {
    lcpbench::ExpectRefused([&] { ReadFclibProblem(path); }, words, path + ": ");
  }
};

TEST_F(FclibFile, ProblemsComeBackBitForBit) {
  int mixed = 0, plain = 0;
  for (const TestProblem& test : GeneratedProblems()) {
    (test.problem.bilateral_rows().empty() ? plain : mixed) += 1;
    for (const LcpProblem& given : {test.problem, InForm(test.problem, MatrixForm::kSparse)}) {
      SCOPED_TRACE(given.id());
      WriteFclibProblem(given, Path("p.hdf5"));
      const FclibProblem back = ReadFclibProblem(Path("p.hdf5"));
      EXPECT_EQ(back.problem.id(), given.id());
      EXPECT_EQ(DifferenceOfProblems(back.problem, given), "");
      EXPECT_FALSE(back.f.has_value());
    }
    const LcpProblem dense = InForm(test.problem, MatrixForm::kDense);
    WriteFclibProblem(dense, Path("dense.hdf5"));
    const LcpProblem back = ReadFclibProblem(Path("dense.hdf5")).problem;
    EXPECT_EQ(DifferenceOfRows(back, dense), "");
  }
  EXPECT_GT(mixed, 10);
  EXPECT_GT(plain, 10);
}

TEST_F(FclibFile, TheEndsOfTheRangeComeBackToo) {
  // Unsymmetric where all rows are of one kind.
  for (const LcpProblem& dense : {EndsOfTheRange(), EndsOfTheRange({0, 1})}) {
    const LcpProblem problem = InForm(dense, MatrixForm::kSparse);
    WriteFclibProblem(problem, Path("p.h5"));
    const LcpProblem back = ReadFclibProblem(Path("p.h5")).problem;
    EXPECT_EQ(back.id(), problem.id());
    EXPECT_EQ(DifferenceOfProblems(back, problem), "");
  }
  WriteFclibProblem(LcpProblem::FromSparse("none", SparseMatrix(), {}), Path("none.h5"));
  EXPECT_EQ(ReadFclibProblem(Path("none.h5")).problem.size(), 0);
}

// In any order of rows, and with contacts that have none.
TEST_F(FclibFile, FrictionInThePlaneComesBackBitForBit) {
  std::mt19937 random(7);
  for (const TestProblem& test : GeneratedProblems()) {
    std::vector<Index> unilateral;
    for (Index row = 0; row < test.problem.size(); ++row) {
      if (!test.problem.is_bilateral(row)) unilateral.push_back(row);
    }
    std::shuffle(unilateral.begin(), unilateral.end(), random);
    RowBounds bounds = test.problem.bounds();
    for (std::size_t k = 0; k + 2 < unilateral.size(); k += 3) {
      bounds.friction.push_back({unilateral[k], unilateral[k + 1], 0.1 * static_cast<double>(k + 1)});
    }
    for (const LcpProblem& problem :
         {test.problem.WithBounds(bounds), InForm(test.problem, MatrixForm::kSparse).WithBounds(bounds)}) {
      WriteFclibProblem(problem, Path("p.h5"));
      EXPECT_EQ(DifferenceOfProblems(ReadFclibProblem(Path("p.h5")).problem, problem), "") << problem.id();
    }
  }
}

TEST_F(FclibFile, TheSameProblemGivesTheSameBytes) {
  const LcpProblem given = GeneratedProblems()[30].problem;
  WriteFclibProblem(given, Path("a.h5"));
  WriteFclibProblem(given, Path("b.h5"));
  EXPECT_EQ(Bytes("a.h5"), Bytes("b.h5"));
}

TEST_F(FclibFile, WhatTheFormatCannotHoldIsNotWritten) {
  Eigen::MatrixXd A(2, 2);
  A << 1, 2, 3, 1;
  const LcpProblem coupled =
      LcpProblem::FromDense("p", A, Eigen::VectorXd::Ones(2), RowBounds::WithBilateralRows(2, {1}));
  EXPECT_THROW(WriteFclibProblem(coupled, Path("p.h5")), InputError);
  const LcpProblem plain = LcpProblem::FromDense("p", Eigen::MatrixXd::Identity(3, 3), Eigen::VectorXd::Ones(3));
  const auto expect = [&](std::vector<FrictionRow> friction, std::vector<BoundedRow> bounded,
                          const std::string& words) {
    const LcpProblem problem = plain.WithBounds({{}, std::move(friction), std::move(bounded)});
    lcpbench::ExpectRefused([&] { WriteFclibProblem(problem, Path("p.h5")); }, words, "problem 'p' has ");
  };
  expect({{1, 0, 0.5}, {2, 0, 0.5}}, {}, "several friction rows of a contact");
  expect({{1, 0, 0.5, 1}}, {}, "sliding rows");
  expect({{1, 0, 0}}, {}, "friction rows of mu = 0");
  expect({}, {{1, 0, 1}}, "bounded rows");
  EXPECT_THROW(WriteFclibProblem(LcpProblem::FromDense("p", A, Eigen::VectorXd::Ones(2)), "/nowhere/p.h5"), InputError);
}

TEST_F(FclibFile, SeveralThreadsRead) {
  const LcpProblem given = GeneratedProblems()[33].problem;
  WriteFclibProblem(given, Path("p.h5"));
  std::vector<std::string> differences(4, "not read");
  std::vector<std::thread> threads;
  for (std::string& difference : differences) {
    threads.emplace_back([&] {
      for (int k = 0; k < 10; ++k) difference = DifferenceOfProblems(ReadFclibProblem(Path("p.h5")).problem, given);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& difference : differences) EXPECT_EQ(difference, "");
}

// The datasets of a file, to be changed.
struct Contents {
  std::map<std::string, std::vector<int>> integers;
  std::map<std::string, std::vector<double>> reals;

  void Matrix(const std::string& name, int rows, int columns, int form, std::vector<int> p, std::vector<int> i,
              std::vector<double> x) {
    integers[name + "/nzmax"] = {static_cast<int>(x.size())};
    integers[name + "/m"] = {rows};
    integers[name + "/n"] = {columns};
    integers[name + "/nz"] = {form};
    integers[name + "/p"] = std::move(p);
    integers[name + "/i"] = std::move(i);
    reals[name + "/x"] = std::move(x);
  }

  void Write(const std::string& path) const {
    Hdf5Datasets datasets(integers.begin(), integers.end());
    datasets.insert(datasets.end(), reals.begin(), reals.end());
    WriteHdf5(path, datasets);
  }
};

constexpr char kW[] = "/fclib_local/W";
constexpr char kV[] = "/fclib_local/V";
constexpr char kR[] = "/fclib_local/R";

// Two contacts in the plane and a bilateral row, in three forms of matrices, with tangential entries:
//     A = [4 1 5; 1 3 0; 5 0 2], b = (-1, -2, -3).
Contents Example() {
  Contents contents;
  contents.integers["/fclib_local/spacedim"] = {2};
  contents.Matrix(kW, 4, 4, -1, {0, 3, 4, 6, 6}, {0, 1, 2, 3, 0, 2}, {4, 0.5, 1, 9, 1, 3});
  contents.Matrix(kV, 4, 1, 2, {0, 3}, {0, 0}, {5, 7});
  contents.Matrix(kR, 1, 1, -2, {0, 1}, {0}, {2});
  contents.reals["/fclib_local/vectors/q"] = {-1, 0.25, -2, 0};
  contents.reals["/fclib_local/vectors/mu"] = {0, 0};
  contents.reals["/fclib_local/vectors/s"] = {-3};
  return contents;
}

TEST_F(FclibFile, TheNormalPartIsTheProblem) {
  Example().Write(Path("example.hdf5"));
  const LcpProblem problem = ReadFclibProblem(Path("example.hdf5")).problem;
  EXPECT_EQ(problem.id(), "example");
  EXPECT_EQ(problem.DenseA(), (Eigen::Matrix3d() << 4, 1, 5, 1, 3, 0, 5, 0, 2).finished());
  EXPECT_EQ(problem.b(), Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(problem.bilateral_rows(), std::vector<Index>{2});

  // Three rows a contact; no bilateral rows.
  Contents spatial;
  spatial.integers["/fclib_local/spacedim"] = {3};
  spatial.Matrix(kW, 6, 6, 5, {0, 3, 0, 3, 4}, {0, 3, 3, 0, 5}, {1, 2, 3, 4, 5});
  spatial.reals["/fclib_local/vectors/q"] = {-1, 8, 8, -2, 8, 8};
  spatial.reals["/fclib_local/vectors/mu"] = {0, -0.0};
  spatial.reals["/solution/r"] = {1, 8, 8, 2, 8, 8};
  spatial.Write(Path("spatial.h5"));
  const FclibProblem read = ReadFclibProblem(Path("spatial.h5"), {FclibTriplets::kRowsFirst});
  EXPECT_EQ(read.problem.DenseA(), (Eigen::Matrix2d() << 1, 3, 4, 2).finished());
  EXPECT_EQ(read.problem.b(), Eigen::Vector2d(-1, -2));
  EXPECT_EQ(read.f.value(), Eigen::Vector2d(1, 2));
}

// Triplets of a square matrix that is not symmetric fit both readings; a V that is not square tells them apart.
TEST_F(FclibFile, TripletsAreReadByRowsOrByColumnsAndNeverTransposedInSilence) {
  const FclibOptions rows_first{FclibTriplets::kRowsFirst}, columns_first{FclibTriplets::kColumnsFirst};
  const std::string told =
      "triplets of which one reading is possible, or `lcpbench convert --fclib-triplets rows-first`";
  const Eigen::Matrix3d A = (Eigen::Matrix3d() << 4, 7, 5, 1, 3, 0, 5, 0, 2).finished();
  const Eigen::Matrix3d turned = (Eigen::Matrix3d() << 4, 1, 5, 7, 3, 0, 5, 0, 2).finished();
  Contents contents = Example();
  const auto read = [&](const FclibOptions& options = {}) -> Eigen::Matrix3d {
    contents.Write(Path("p.h5"));
    return ReadFclibProblem(Path("p.h5"), options).problem.DenseA();
  };
  // p rows, i columns.
  contents.Matrix(kW, 4, 4, 4, {0, 0, 2, 2}, {0, 2, 0, 2}, {4, 7, 1, 3});
  contents.Matrix(kV, 4, 1, -1, {0, 1}, {0}, {5});
  contents.Write(Path("p.h5"));
  ExpectRefused(Path("p.h5"), "/fclib_local/W: expected " + told);
  EXPECT_EQ(read(rows_first), A);
  EXPECT_EQ(read(columns_first), turned);
  // One program wrote the file: what V says holds for W.
  contents.Matrix(kV, 4, 1, 2, {3, 0}, {0, 0}, {8, 5});
  EXPECT_EQ(read(), A);
  EXPECT_EQ(read(rows_first), A);
  lcpbench::ExpectRefused([&] { read(columns_first); }, "V/p: expected indices from 0 to 0, found 3", Path("p.h5"));
  contents.Matrix(kV, 4, 1, 2, {0, 0}, {3, 0}, {8, 5});
  EXPECT_EQ(read(), turned);
  lcpbench::ExpectRefused([&] { read(rows_first); }, "V/i: expected indices from 0 to 0, found 3", Path("p.h5"));
  // Symmetric where it counts: tangential entries, their order, sums and zeros do not matter.
  contents.Matrix(kV, 4, 1, -1, {0, 1}, {0}, {5});
  contents.Matrix(kW, 4, 4, 7, {2, 0, 0, 2, 0, 1, 2}, {0, 0, 2, 2, 2, 0, 3}, {7, 4, 3, 3, 4, 9, 0});
  EXPECT_EQ(read(), (Eigen::Matrix3d() << 4, 7, 5, 7, 3, 0, 5, 0, 2).finished());
  contents.Matrix(kR, 1, 1, 1, {0}, {0}, {2});
  EXPECT_EQ(read()(2, 2), 2);
}

TEST_F(FclibFile, EveryReadingOfATripletFileIsThatOfItsWriter) {
  for (const TestProblem& test : GeneratedProblems()) {
    SCOPED_TRACE(test.problem.id());
    const LcpProblem given = InForm(test.problem, MatrixForm::kSparse);
    if (!given.bilateral_rows().empty()) continue;
    const auto n = static_cast<int>(given.size());
    Contents contents;
    contents.integers["/fclib_local/spacedim"] = {2};
    std::vector<int> row, column;
    std::vector<double> value;
    for (int i = 0; i < n; ++i) {
      for (SparseMatrix::InnerIterator it(given.SparseA(), i); it; ++it) {
        row.push_back(2 * i);
        column.push_back(2 * static_cast<int>(it.col()));
        value.push_back(it.value());
      }
    }
    std::vector<double> q(2 * static_cast<size_t>(n), 0.0);
    for (int i = 0; i < n; ++i) q[2 * static_cast<size_t>(i)] = given.b()[i];
    contents.reals["/fclib_local/vectors/q"] = q;
    contents.reals["/fclib_local/vectors/mu"].assign(static_cast<size_t>(n), 0.0);
    for (const FclibTriplets form : {FclibTriplets::kRowsFirst, FclibTriplets::kColumnsFirst}) {
      const bool by_rows = form == FclibTriplets::kRowsFirst;
      contents.Matrix(kW, 2 * n, 2 * n, static_cast<int>(value.size()), by_rows ? row : column, by_rows ? column : row,
                      value);
      contents.Write(Path("p.h5"));
      EXPECT_EQ(DifferenceOfProblems(ReadFclibProblem(Path("p.h5"), {form}).problem, given), "");
    }
  }
}

// Two contacts of two bodies of one coordinate, and a joint: J = [1 0; -1 1; 0 1], inverse masses 1/2, 1/4.
TEST_F(FclibFile, GlobalProblemsOfADiagonalMassAreReadByFactors) {
  const std::string global = "/fclib_global", vectors = global + "/vectors";
  Contents contents;
  contents.integers[global + "/spacedim"] = {2};
  contents.Matrix(global + "/M", 2, 2, 2, {0, 1}, {0, 1}, {2, 4});
  contents.Matrix(global + "/H", 2, 4, 4, {0, 2, 2, 3}, {0, 0, 1, 1}, {1, -1, 1, 9});  // columns first, as Siconos
  contents.Matrix(global + "/G", 2, 1, -1, {0, 1}, {1}, {1});
  contents.reals[vectors + "/f"] = {-2, 8};
  contents.reals[vectors + "/w"] = {0.5, 7, 0.25, 7};
  contents.reals[vectors + "/b"] = {3};
  contents.reals[vectors + "/mu"] = {0.5, 0.5};
  contents.reals["/solution/r"] = {1, 8, 2, 8};
  contents.reals["/solution/l"] = {-1};
  contents.Write(Path("p.h5"));
  const FclibProblem friction = ReadFclibProblem(Path("p.h5"));
  EXPECT_EQ(Eigen::MatrixXd(friction.problem.J()), (Eigen::MatrixXd(5, 2) << 1, 0, 0, 0, -1, 1, 0, 9, 0, 1).finished());
  EXPECT_EQ(friction.problem.b(), (Eigen::VectorXd(5) << -0.5, 7, 3.25, 25, 5).finished());
  EXPECT_EQ(friction.problem.friction_rows(), (std::vector<FrictionRow>{{1, 0, 0.5}, {3, 2, 0.5}}));
  EXPECT_EQ(friction.problem.bilateral_rows(), std::vector<Index>{4});
  EXPECT_EQ(friction.f.value(), (Eigen::VectorXd(5) << 1, 8, 2, 8, -1).finished());
  const FclibOptions normal{FclibTriplets::kByRanges, TangentRows::kNone};
  const FclibProblem read = ReadFclibProblem(Path("p.h5"), normal);
  EXPECT_EQ(Eigen::MatrixXd(read.problem.J()), (Eigen::MatrixXd(3, 2) << 1, 0, -1, 1, 0, 1).finished());
  EXPECT_EQ(read.problem.inverse_mass(), Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(read.problem.b(), Eigen::Vector3d(-1 + 0.5, 1 + 2 + 0.25, 2 + 3));
  EXPECT_EQ(read.problem.bilateral_rows(), std::vector<Index>{2});
  EXPECT_EQ(read.f.value(), Eigen::Vector3d(1, 2, -1));
  const auto expect = [&](const std::string& words) {
    contents.Write(Path("q.h5"));
    lcpbench::ExpectRefused([&] { ReadFclibProblem(Path("q.h5"), normal); }, words, Path("q.h5") + ": ");
  };
  contents.Matrix(global + "/M", 2, 2, 3, {0, 1, 0}, {0, 1, 1}, {2, 4, 1});
  expect("M: expected a diagonal matrix, others are not supported, found an entry in row 1 and column 0");
  contents.Matrix(global + "/M", 2, 2, 2, {0, 0}, {0, 0}, {2, 4});
  expect("M: expected masses > 0 on the diagonal, found 0.000000 at 1");
  contents.Matrix(global + "/M", 3, 3, 0, {}, {}, {});
  expect("M: expected 2 x 2 entries, found 3 x 3");
}

// Groups of FCLib that are not taken, one or several, with a solution beside them; and a global problem that lacks
// part.
TEST_F(FclibFile, AFileOfOtherGroupsIsToldWhatItHas) {
  for (const std::string other : {"fclib_global_rolling", "fclib_local_rolling", "FCLIB_LOCAL", "a group"}) {
    Contents contents;
    contents.integers["/" + other + "/spacedim"] = {5};
    contents.Matrix("/" + other + "/M", 1, 1, 1, {0}, {0}, {2});
    contents.Write(Path("p.h5"));
    ExpectRefused(Path("p.h5"), "expected a group fclib_local or fclib_global, found " + other);
    contents.reals["/solution/r"] = {1};
    contents.Write(Path("p.h5"));
    ExpectRefused(Path("p.h5"), "fclib_global, found " + other + ", solution");
  }
  Contents contents;
  for (int k = 0; k < 100; ++k) contents.integers["/group" + std::to_string(k) + "/n"] = {k};
  contents.Write(Path("p.h5"));
  ExpectRefused(Path("p.h5"), "found group0, group1, group10");
  contents = {};
  contents.Matrix("/fclib_global/M", 1, 1, 1, {0}, {0}, {2});
  contents.Write(Path("p.h5"));
  ExpectRefused(Path("p.h5"), "/fclib_global/spacedim: expected a dataset of integers, found none");
}

// As a writer leaves it that creates a dataset and then has nothing for it.
TEST_F(FclibFile, ForcesThatWereNeverWrittenAreNone) {
  const auto create = [this](const char* name, hsize_t size) {
    const hid_t file = H5Fopen(Path("p.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    const hid_t group = H5Gopen2(file, "/solution", H5P_DEFAULT), space = H5Screate_simple(1, &size, nullptr);
    const hid_t set = H5Dcreate2(group, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(set, 0);
    ASSERT_EQ(H5Dget_storage_size(set), 0U);
    H5Dclose(set);
    H5Sclose(space);
    H5Gclose(group);
    H5Fclose(file);
  };
  Contents contents = Example();
  contents.reals["/solution/u"] = {1, 2, 3, 4};
  contents.Write(Path("p.h5"));
  create("r", 4);
  FclibProblem read = ReadFclibProblem(Path("p.h5"));
  EXPECT_EQ(read.problem.size(), 3);
  EXPECT_FALSE(read.f.has_value());
  contents.reals["/solution/r"] = {1, 8, 2, 8};
  contents.Write(Path("p.h5"));
  create("l", 1);
  read = ReadFclibProblem(Path("p.h5"));
  EXPECT_EQ(read.problem.size(), 3);
  EXPECT_FALSE(read.f.has_value());
}

// A dataset of this type alone; or without it.
void Change(const std::string& words, Contents* contents) {
  std::istringstream stream(words);
  std::string type, name;
  stream >> type >> name;
  if (!name.starts_with("/")) name = "/fclib_local/" + name;
  contents->integers.erase(name);
  contents->reals.erase(name);
  if (type == "integers") contents->integers[name] = {};
  if (type == "reals") contents->reals[name] = {};
  for (std::string number; stream >> number;) {
    if (type == "integers") {
      contents->integers[name].push_back(std::stoi(number));
    } else {
      contents->reals[name].push_back(std::stod(number));
    }
  }
}

TEST_F(FclibFile, WhatIsWrongIsOneLineWithItsDataset) {
  const auto expect_refused = [this](const std::string& words, auto change) {
    SCOPED_TRACE(words);
    Contents contents = Example();
    change(&contents);
    contents.Write(Path("p.hdf5"));
    ExpectRefused(Path("p.hdf5"), words);
  };
  for (const auto& refused : RefusalCases("fclib")) {
    expect_refused(refused[1], [&](Contents* contents) { Change(refused[0], contents); });
  }
  const auto factors = [](int rows, double inverse_mass) {
    return [=](Contents* contents) {
      contents->Matrix("/lcpbench/J", rows, 3, 0, {}, {}, {});
      contents->reals["/lcpbench/inverse_mass"] = {1, inverse_mass, 1};
    };
  };
  expect_refused("/lcpbench/J: expected 3 x 3 entries, found 2 x 3", factors(2, 1));
  expect_refused("inverse", factors(3, -1));
  expect_refused("expected a group fclib_local or fclib_global, found nothing", [](Contents* c) { *c = {}; });
  expect_refused("finite", [](Contents* c) { c->Matrix(kR, 1, 1, 2, {0, 0}, {0, 0}, {1e308, 1e308}); });
  expect_refused("W/m: expected a dataset of 32-bit integers, found another object", [](Contents* c) {
    c->integers.erase(std::string(kW) + "/m");
    c->integers[std::string(kW) + "/m/m"] = {1};
  });
  expect_refused("/fclib_local: expected a group, found another object", [](Contents* c) {
    c->integers = {{"/fclib_local", {1}}};
    c->reals.clear();
  });
}

TEST_F(FclibFile, WhatIsNoFileOfThisKindIsRefused) {
  ExpectRefused(Path("absent.h5"), "cannot be opened");
  ExpectRefused(folder_.string(), "not a regular file");
  Write("empty.h5", "");
  ExpectRefused(Path("empty.h5"), "expected an HDF5 file that libhdf5 can read, found one that it refuses");
  Write("text.h5", "this is no HDF5 file at all");
  ExpectRefused(Path("text.h5"), "expected an HDF5 file that libhdf5 can read, found one that it refuses");
}

TEST_F(FclibFile, WhatLeadsOutOfTheFileIsRefused) {
  using Change = std::function<void(hid_t)>;
  const std::string q = "/fclib_local/vectors/q";
  const auto expect = [&](const Change& change, const std::string& words) {
    Contents contents = Example();
    contents.reals.erase(q);
    contents.reals["/elsewhere"] = {-1, 0, -2, 0};
    contents.Write(Path("changed.h5"));
    const hid_t file = H5Fopen(Path("changed.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    change(file);
    ASSERT_GE(H5Fclose(file), 0);
    ExpectRefused(Path("changed.h5"), words);
  };
  const auto create = [](const std::string& name, const Change& set, const std::vector<double>& values = {},
                         hsize_t size = 4) {
    return [=](hid_t file) {
      const hid_t space = H5Screate_simple(1, &size, nullptr), properties = H5Pcreate(H5P_DATASET_CREATE);
      set(properties);
      const hid_t dataset = H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
      ASSERT_GE(dataset, 0);
      if (!values.empty()) H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      H5Dclose(dataset);
      H5Pclose(properties);
      H5Sclose(space);
    };
  };
  const std::string other = Path("other.h5"), values = Path("values");
  Example().Write(other);
  Write("values", std::string(32, '\0'));
  expect([&](hid_t file) { H5Lcreate_soft("/elsewhere", file, q.c_str(), H5P_DEFAULT, H5P_DEFAULT); },
         "q: expected a hard link, found another");
  expect([&](hid_t f) { H5Lcreate_external(other.c_str(), q.c_str(), f, q.c_str(), H5P_DEFAULT, H5P_DEFAULT); },
         "q: expected a hard link, found another");
  expect(create(q, [&](hid_t properties) { H5Pset_external(properties, values.c_str(), 0, 32); }),
         "q: expected values in the file itself, found names of other files");
  const hsize_t size = 4;
  const hid_t space = H5Screate_simple(1, &size, nullptr);
  expect(create(q, [&](hid_t properties) { H5Pset_virtual(properties, space, other.c_str(), q.c_str(), space); }),
         "q: expected values in one piece as fclib writes them, found chunks, filters or other datasets");
  H5Sclose(space);
  const auto chunks = [](hid_t properties) {
    const hsize_t chunk = 2;
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 9);
  };
  expect(create(q, chunks), "q: expected values in one piece");
  // Promised, and never written.
  const auto nothing = [](hid_t) {};
  expect(create(q, nothing, {}, 1'000'000'000'000), "q: expected 4 numbers, found 0");
  // The same values under many names.
  const auto share = [&](hid_t file) {
    const std::string W_x = "/fclib_local/W/x";
    H5Lcreate_hard(file, "/elsewhere", file, q.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    H5Ldelete(file, W_x.c_str(), H5P_DEFAULT);
    create(W_x, nothing, std::vector<double>(2000, 1.0), 2000)(file);
    for (const std::string x : {"/fclib_local/V/x", "/fclib_local/R/x"}) {
      H5Ldelete(file, x.c_str(), H5P_DEFAULT);
      H5Lcreate_hard(file, W_x.c_str(), file, x.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    }
  };
  expect(share, "expected values that no other dataset shares, found shared ones");
}

// Headers whose sizes promise what the file does not hold.
TEST_F(FclibFile, PromisesAreNotBelieved) {
  Contents contents = Example();
  constexpr std::uint64_t kEntries = 1237;  // a number that stands nowhere else
  contents.reals["/fclib_local/vectors/q"].assign(kEntries, 1.0);
  contents.Write(Path("p.h5"));
  const std::string bytes = Bytes("p.h5");
  const auto replaced = [](std::string text, std::uint64_t from, std::uint64_t to) {
    char old_bytes[sizeof from], new_bytes[sizeof to];
    std::memcpy(old_bytes, &from, sizeof from);
    std::memcpy(new_bytes, &to, sizeof to);
    const std::string old_text(old_bytes, sizeof from);
    int count = 0;
    for (std::size_t at = text.find(old_text); at != std::string::npos; at = text.find(old_text, at + 1), ++count) {
      text.replace(at, sizeof to, new_bytes, sizeof to);
    }
    EXPECT_GE(count, 1);
    return text;
  };
  constexpr std::uint64_t kPromised = 1'000'000'000'000;
  const std::string size_only = replaced(bytes, kEntries, kPromised);
  Write("size.h5", size_only);
  ExpectRefused(Path("size.h5"), "");
  Write("both.h5", replaced(size_only, 8 * kEntries, 8 * kPromised));
  ExpectRefused(Path("both.h5"), "");
  constexpr long kMostMemory = 512 * 1024;  // kB, of which a sanitizer takes the most
  for (const auto& who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ASSERT_EQ(getrusage(who, &usage), 0);
    EXPECT_LT(usage.ru_maxrss, kMostMemory);
  }
}

TEST_F(FclibFile, TruncatedFilesAreRefusedInOneLine) {
  WriteFclibProblem(GeneratedProblems()[1].problem, Path("whole.h5"));
  const std::string whole = Bytes("whole.h5");
  constexpr std::size_t kCuts = 40;
  for (std::size_t k = 0; k < kCuts; ++k) {
    Write("cut.h5", whole.substr(0, whole.size() * k / kCuts));
    ExpectRefused(Path("cut.h5"), "expected");
  }
}

TEST(FclibLaw, HoldsForTheCorpusAndItsChanges) {
  constexpr char kFolder[] = "fclib_file_corpus";
  for (const auto& path : CorpusFiles(kFolder)) EXPECT_NO_THROW(ReadFclibProblem(path.string())) << path;
  // Each change is a process.
  ExpectLawHolds(BrokenFclibLaw, kFolder, 200,
                 [random = std::mt19937_64(1)](const std::string& bytes, const auto&) mutable {
                   return std::vector<std::string>{OverwrittenBytes(bytes, &random)};
                 });
}

}  // namespace
}  // namespace lcpbench
