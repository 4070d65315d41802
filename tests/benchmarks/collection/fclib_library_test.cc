// Our HDF5 files and libfclib's own reader and writer. Built where the library is.

extern "C" {
#include <fclib.h>
}

#include "benchmarks/collection/problem_formats.h"
#include "tests/solvers/lcp/same_problem.h"
#include "tests/solvers/test_problems.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

class FclibLibrary : public FolderTest {
 protected:
  const std::string path_ = Path("p.hdf5");
};

// What fclib_delete_local frees is what the structure holds.
void Free(fclib_local* problem) {
  fclib_delete_local(problem);
  std::free(problem);
}

Eigen::MatrixXd DenseOf(const fclib_matrix* matrix) {
  EXPECT_EQ(matrix->nz, -1);  // compressed columns
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(matrix->m, matrix->n);
  for (int column = 0; column < matrix->n; ++column) {
    for (int k = matrix->p[column]; k < matrix->p[column + 1]; ++k) dense(matrix->i[k], column) = matrix->x[k];
  }
  return dense;
}

void ExpectSame(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
  ASSERT_EQ(found.rows(), expected.rows());
  ASSERT_EQ(found.cols(), expected.cols());
  EXPECT_EQ(found, expected);
}

// Rows of W for the contacts, of R for the bilateral rows.
struct Rows {
  std::vector<Index> contacts, bilateral;

  explicit Rows(const LcpProblem& problem) : bilateral(problem.bilateral_rows()) {
    for (Index i = 0; i < problem.size(); ++i) {
      if (!problem.is_bilateral(i)) contacts.push_back(i);
    }
  }
};

TEST_F(FclibLibrary, ReadsOurFiles) {
  for (const TestProblem& test : GeneratedProblems()) {
    const LcpProblem& problem = test.problem;
    SCOPED_TRACE(problem.id());
    FormatNamed("hdf5").write(problem, path_);
    fclib_local* read = fclib_read_local(path_.c_str());
    ASSERT_NE(read, nullptr);
    const Rows rows(problem);
    const auto contacts = static_cast<Index>(rows.contacts.size());
    const auto bilateral = static_cast<Index>(rows.bilateral.size());
    const auto normal = Eigen::seqN(Index{0}, contacts, Index{2});  // of what has two rows a contact
    const Eigen::MatrixXd& A = problem.DenseA();
    EXPECT_EQ(read->spacedim, 2);
    EXPECT_STREQ(read->info->title, problem.id().c_str());
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(2 * contacts, 2 * contacts), V(2 * contacts, bilateral);
    W(normal, normal) = A(rows.contacts, rows.contacts);
    ExpectSame(DenseOf(read->W), W);
    Eigen::VectorXd q = Eigen::VectorXd::Zero(2 * contacts);
    q(normal) = problem.b()(rows.contacts);
    EXPECT_EQ(Eigen::VectorXd::Map(read->q, 2 * contacts), q);
    EXPECT_TRUE(Eigen::VectorXd::Map(read->mu, contacts).isZero(0));
    EXPECT_EQ(read->R == nullptr, rows.bilateral.empty());
    if (read->R != nullptr) {
      V.setZero();
      V(normal, Eigen::all) = A(rows.contacts, rows.bilateral);
      ExpectSame(DenseOf(read->V), V);
      ExpectSame(DenseOf(read->R), A(rows.bilateral, rows.bilateral));
      EXPECT_EQ(Eigen::VectorXd::Map(read->s, bilateral), problem.b()(rows.bilateral).eval());
    }
    Free(read);
  }
}

// The same matrix with a third, empty row for every contact, and a column where it has columns of contacts.
struct SpatialMatrix {
  std::vector<int> p{0}, i;
  fclib_matrix matrix;

  SpatialMatrix(const fclib_matrix& plane, bool has_contact_columns) : matrix(plane) {
    for (int column = 0; column < plane.n; ++column) {
      for (int k = plane.p[column]; k < plane.p[column + 1]; ++k) i.push_back(plane.i[k] / 2 * 3 + plane.i[k] % 2);
      p.push_back(plane.p[column + 1]);
      if (has_contact_columns && column % 2 == 1) p.push_back(p.back());
    }
    matrix.m = plane.m / 2 * 3;
    matrix.n = static_cast<int>(p.size()) - 1;
    matrix.p = p.data();
    matrix.i = i.data();
  }
};

// In FCLib's own judgement, which it has for space only: u and r have three rows a contact.
double Merit(const fclib_local& plane, std::vector<double> u, std::vector<double> r, std::vector<double> l) {
  SpatialMatrix W(*plane.W, true);
  std::vector<double> q(u.size(), 0.0);
  for (size_t k = 0; k < u.size() / 3; ++k) q[3 * k] = plane.q[2 * k];
  fclib_local spatial = plane;
  spatial.spacedim = 3;
  spatial.W = &W.matrix;
  spatial.q = q.data();
  fclib_solution solution{nullptr, u.data(), r.data(), l.data()};
  if (plane.V == nullptr) return fclib_merit_local(&spatial, MERIT_1, &solution);
  SpatialMatrix V(*plane.V, false);
  spatial.V = &V.matrix;
  return fclib_merit_local(&spatial, MERIT_1, &solution);
}

// FCLib's own judgement of planted answers, in integers: its signs are ours.
TEST_F(FclibLibrary, TakesOurAnswersForItsOwn) {
  std::mt19937 random(11);
  const auto integer = [&](int least, int most) {
    return static_cast<double>(least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1)));
  };
  constexpr Index kRows = 7;
  for (const std::vector<Index>& bilateral : {std::vector<Index>{}, {2}, {0, 3, 6}}) {
    const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(kRows, kRows, [&] { return integer(-3, 3); });
    const Eigen::MatrixXd A = J * J.transpose();
    Eigen::VectorXd f(kRows), w = Eigen::VectorXd::Zero(kRows);
    for (Index i = 0; i < kRows; ++i) {
      const bool separates = i % 3 == 1;
      f[i] = separates ? 0 : integer(1, 5);
      w[i] = separates ? integer(1, 5) : 0;
    }
    for (const Index row : bilateral) {
      f[row] = -integer(1, 5);
      w[row] = 0;
    }
    const LcpProblem problem =
        LcpProblem::FromDense("planted", A, w - A * f, RowBounds::WithBilateralRows(kRows, bilateral));
    const Rows rows(problem);
    std::vector<double> r(3 * rows.contacts.size(), 0.0), u = r, plane_r(2 * rows.contacts.size(), 0.0), l;
    for (size_t k = 0; k < rows.contacts.size(); ++k) {
      r[3 * k] = plane_r[2 * k] = f[rows.contacts[k]];
      u[3 * k] = w[rows.contacts[k]];
    }
    for (const Index row : rows.bilateral) l.push_back(f[row]);
    FormatNamed("hdf5").write(problem, path_);
    std::vector<double> plane_u(plane_r.size(), 0.0);
    fclib_solution solution{nullptr, plane_u.data(), plane_r.data(), l.data()};
    ASSERT_EQ(fclib_write_solution(&solution, path_.c_str()), 1);
    fclib_local* read = fclib_read_local(path_.c_str());
    ASSERT_NE(read, nullptr);
    constexpr double kRounding = 1e-9;
    EXPECT_LT(std::abs(Merit(*read, u, r, l)), kRounding);
    for (double* number : {&r[0], bilateral.empty() ? &r[3] : &l[0]}) {  // and it does look
      *number += 1;
      EXPECT_GT(Merit(*read, u, r, l), kRounding);
      *number -= 1;
    }
    Free(read);
    EXPECT_EQ(DifferenceOfRows(ReadProblemFile(path_, {}), problem), "");
  }
}

TEST_F(FclibLibrary, WritesFilesThatWeRead) {
  // Normal rows 0 and 2; A = [4 1 5; 1 3 6; 5 6 2].
  std::vector<double> W{4, 1, 1, 3, 0.5}, V{5, 6}, R{2}, q{-1, 0, -2, 0.5}, s{-3}, mu{0, 0};
  // In each form: triplets with p rows and i columns, compressed columns, compressed rows.
  std::vector<int> pW{0, 0, 2, 2, 1}, iW{0, 2, 0, 2, 0}, pV{0, 2}, iV{0, 2}, pR{0, 1}, iR{0};
  fclib_matrix matrix_W{5, 4, 4, pW.data(), iW.data(), W.data(), 5, nullptr};
  fclib_matrix matrix_V{2, 4, 1, pV.data(), iV.data(), V.data(), -1, nullptr};
  fclib_matrix matrix_R{1, 1, 1, pR.data(), iR.data(), R.data(), -2, nullptr};
  char title[] = "title", description[] = "description";
  fclib_info info{title, description, nullptr};
  fclib_local given{&matrix_W, &matrix_V, &matrix_R, mu.data(), q.data(), s.data(), 2, &info};
  ASSERT_EQ(fclib_write_local(&given, path_.c_str()), 1);
  const LcpProblem read = ReadProblemFile(path_, {});
  Eigen::Matrix3d A;
  A << 4, 1, 5, 1, 3, 6, 5, 6, 2;
  EXPECT_EQ(read.DenseA(), A);
  EXPECT_EQ(read.b(), Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(read.bilateral_rows(), std::vector<Index>{2});
}

}  // namespace
}  // namespace lcpbench
