/* The C interface from C99. */
#include <lcpbench.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/c/check.h"

/* A solver, its answer and the verdict on it. */
typedef struct Answer {
  lcpbench_solver* solver;
  lcpbench_answer got;
  lcpbench_verdict verdict;
} Answer;

static Answer Solve(const char* key, const lcpbench_problem* problem, const lcpbench_solve_options* options,
                    double* w) {
  Answer answer = {.got = {.size = sizeof answer.got}};
  CHECK_OK(lcpbench_solver_create(key, NULL, 0, &answer.solver));
  CHECK_OK(lcpbench_solve(answer.solver, problem, options, &answer.got));
  CHECK_OK(lcpbench_verify(problem, &answer.got, 1e-6, &answer.verdict, sizeof answer.verdict, w));
  return answer;
}

static void Free(Answer* answer) { lcpbench_solver_free(answer->solver); }

/* A ball between two walls, and one that lifts off: f = (4/3, 7/3, 0), w = (0, 0, 3), by hand. */
static const double kA[9] = {2, 1, 0, 1, 2, 0, 0, 0, 1};
static const double kB[3] = {-5, -6, 3};
static const double kF[3] = {4.0 / 3, 7.0 / 3, 0};
static const double kW[3] = {0, 0, 3};

static lcpbench_problem* Create(const lcpbench_problem_data* data) {
  lcpbench_problem* problem = NULL;
  CHECK_OK(lcpbench_problem_create(data, &problem));
  return problem;
}

static lcpbench_problem_data DenseData(int64_t n, const double* A, const double* b, const uint8_t* kinds,
                                       uint32_t facts) {
  const lcpbench_problem_data data = {
      .size = sizeof data, .form = LCPBENCH_DENSE, .rows = n, .values = A, .b = b, .kinds = kinds, .facts = facts};
  return data;
}

static lcpbench_problem* Dense(int64_t n, const double* A, const double* b, const uint8_t* kinds, uint32_t facts) {
  const lcpbench_problem_data data = DenseData(n, A, b, kinds, facts);
  return Create(&data);
}

/* Forces from elsewhere. */
static lcpbench_answer Claim(lcpbench_status status, int64_t n, const double* f, const double* ray) {
  const lcpbench_answer answer = {.size = sizeof answer, .status = status, .n = n, .f = f, .ray = ray};
  return answer;
}

static lcpbench_problem* KnownProblem(void) {
  return Dense(3, kA, kB, NULL, LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE);
}

static void SolvesAKnownProblem(void) {
  lcpbench_problem* problem = KnownProblem();
  double w[3];
  Answer answer = Solve("dantzig", problem, NULL, w);
  CHECK(answer.got.status == LCPBENCH_SOLVED);
  CHECK(answer.got.n == 3);
  for (int i = 0; i < 3; ++i) {
    CHECK(fabs(answer.got.f[i] - kF[i]) < 1e-14);
    CHECK(fabs(w[i] - kW[i]) < 1e-14);
    /* The identity, from numbers that the library did not compute. */
    double sum = kB[i];
    for (int j = 0; j < 3; ++j) sum += kA[3 * i + j] * answer.got.f[j];
    CHECK(fabs(w[i] - sum) < 1e-14);
  }
  CHECK(answer.verdict.passes == 1 && answer.verdict.best_tier == 1e-9 && answer.verdict.false_success == 0);
  CHECK(answer.verdict.requested == 1e-6 && answer.verdict.has_ray == 0 && answer.verdict.reason[0] == '\0');
  CHECK(answer.verdict.energy_bound >= 0 && answer.verdict.energy_bound < 1e-14);
  CHECK(answer.got.iterations >= 0);
  CHECK(strcmp(lcpbench_status_key(answer.got.status), "solved") == 0);
  Free(&answer);
  lcpbench_problem_free(problem);
}

/* Two rows that share one load in any way: equal shares have the least norm. */
static void LeastNormSharesEqually(void) {
  const double A[4] = {1, 1, 1, 1}, b[2] = {-2, -2};
  lcpbench_problem* problem = Dense(2, A, b, NULL, LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE);
  lcpbench_solve_options options = {.size = sizeof options, .rank_tolerance = 1e-10};
  Answer answer = Solve("dantzig", problem, &options, NULL);
  const double* f = answer.got.f;
  CHECK(answer.got.status == LCPBENCH_SOLVED && answer.verdict.passes == 1 && answer.got.nullity == 1);
  CHECK(answer.got.n == 2 && fabs(f[0] - 1) < 1e-12 && fabs(f[1] - 1) < 1e-12);
  options.rank_tolerance = 2;
  CHECK_REFUSED(lcpbench_solve(answer.solver, problem, &options, &answer.got), "rank_tolerance is 2");
  options.rank_tolerance = -1;
  CHECK_REFUSED(lcpbench_solve(answer.solver, problem, &options, &answer.got), "rank_tolerance is -1");
  options.rank_tolerance = 1e-10;
  options.tolerance = -1;
  CHECK_REFUSED(lcpbench_solve(answer.solver, problem, &options, &answer.got), "tolerance");
  CHECK(answer.got.nullity == 1 && answer.got.f == f && fabs(f[0] - 1) < 1e-12); /* a refusal leaves the answer */
  Free(&answer);
  lcpbench_problem_free(problem);
}

/* A nonsymmetric A tells rows from columns: w = A f + b at f = (1, 2). */
static void LayoutsAndFormsAgree(void) {
  const double by_columns[4] = {4, 3, -1, 5}, by_rows[4] = {4, -1, 3, 5};
  const double b[2] = {7, 11}, f[2] = {1, 2}, expected[2] = {4 - 2 + 7, 3 + 10 + 11};
  const int32_t starts[3] = {0, 2, 4};
  const int32_t indices[4] = {0, 1, 1, 0}; /* the second column (or row) is not sorted */
  const double columns[4] = {4, 3, 5, -1}, rows[4] = {4, -1, 5, 3};
  lcpbench_problem_data data[4];
  for (int k = 0; k < 4; ++k) {
    data[k] = DenseData(2, k == 0 ? by_columns : by_rows, b, NULL, 0);
    data[k].layout = k % 2 ? LCPBENCH_ROW_MAJOR : LCPBENCH_COLUMN_MAJOR;
    if (k < 2) continue;
    data[k].form = LCPBENCH_SPARSE;
    data[k].values = k == 2 ? columns : rows;
    data[k].entries = 4;
    data[k].starts = starts;
    data[k].indices = indices;
  }
  for (int k = 0; k < 4; ++k) {
    lcpbench_problem* problem = Create(&data[k]);
    const lcpbench_answer answer = Claim(LCPBENCH_NOT_RUN, 2, f, NULL);
    double w[2] = {0, 0};
    lcpbench_verdict verdict;
    CHECK_OK(lcpbench_verify(problem, &answer, 1e-9, &verdict, sizeof verdict, w));
    CHECK(w[0] == expected[0] && w[1] == expected[1]);
    CHECK(verdict.energy_bound == -1);
    lcpbench_problem_free(problem);
  }
}

/* A chain of bodies on a line, each pushing the next: J has -1 and 1, A = J M^-1 J^T is known entry by entry. */
static void FactorsAreTheirProduct(void) {
  enum { kRows = 20 };
  int32_t row_starts[kRows + 1], row_indices[2 * kRows];
  double row_values[2 * kRows], inverse_mass[3 * (kRows + 1)], b[kRows], A[kRows * kRows];
  uint8_t kinds[kRows];
  memset(inverse_mass, 0, sizeof inverse_mass);
  memset(A, 0, sizeof A);
  for (int k = 0; k <= kRows; ++k) inverse_mass[3 * k] = 1.0 / (1 + k % 3);
  for (int i = 0; i < kRows; ++i) {
    row_starts[i] = 2 * i;
    row_indices[2 * i] = 3 * i;
    row_values[2 * i] = -1;
    row_indices[2 * i + 1] = 3 * (i + 1);
    row_values[2 * i + 1] = 1;
    kinds[i] = i % 6 == 1 ? LCPBENCH_BILATERAL : LCPBENCH_UNILATERAL;
    b[i] = kinds[i] == LCPBENCH_BILATERAL ? 3 : (i * 7) % 5 - 2.5;
    A[i * kRows + i] = inverse_mass[3 * i] + inverse_mass[3 * (i + 1)];
    if (i + 1 < kRows) A[i * kRows + i + 1] = A[(i + 1) * kRows + i] = -inverse_mass[3 * (i + 1)];
  }
  row_starts[kRows] = 2 * kRows;
  const lcpbench_problem_data data = {.size = sizeof data,
                                      .form = LCPBENCH_FACTORS,
                                      .layout = LCPBENCH_ROW_MAJOR,
                                      .rows = kRows,
                                      .columns = 3 * (kRows + 1),
                                      .values = row_values,
                                      .entries = 2 * kRows,
                                      .starts = row_starts,
                                      .indices = row_indices,
                                      .inverse_mass = inverse_mass,
                                      .b = b,
                                      .kinds = kinds};
  lcpbench_problem *factors = Create(&data), *dense = Dense(kRows, A, b, kinds, LCPBENCH_SYMMETRIC);
  double w_factors[kRows], w_dense[kRows];
  Answer first = Solve("auto", factors, NULL, w_factors);
  Answer second = Solve("lemke", dense, NULL, w_dense);
  CHECK(first.verdict.best_tier == 1e-9 && second.verdict.best_tier == 1e-9);
  int negative = 0;
  for (int i = 0; i < kRows; ++i) {
    CHECK(fabs(first.got.f[i] - second.got.f[i]) < 1e-11); /* A is positive definite: one solution */
    CHECK(fabs(w_factors[i] - w_dense[i]) < 1e-11);
    negative += kinds[i] == LCPBENCH_BILATERAL && first.got.f[i] < -1e-3;
  }
  CHECK(negative > 0); /* some joint pulls, which no contact could */
  Free(&first);
  Free(&second);
  lcpbench_problem_free(factors);
  lcpbench_problem_free(dense);
}

/* w_1 + w_2 = b_1 + b_2 = -2 whatever f is: A y = 0 and b.y < 0 for y = (1, 1). */
static void AnInfeasibleProblemHasARay(void) {
  const double A[4] = {1, -1, -1, 1}, b[2] = {-1, -1};
  lcpbench_problem* problem = Dense(2, A, b, NULL, LCPBENCH_SYMMETRIC);
  Answer answer = Solve("lemke", problem, NULL, NULL);
  CHECK(answer.got.status == LCPBENCH_INFEASIBLE);
  CHECK(answer.verdict.passes == 0 && answer.verdict.false_infeasible == 0);
  CHECK(answer.verdict.has_ray == 1 && answer.verdict.ray_accepted == 1 && answer.verdict.ray_b_dot_y < 0);
  CHECK(answer.got.n == 2 && answer.got.ray[0] > 0 && answer.got.ray[0] == answer.got.ray[1]);
  CHECK(answer.verdict.ray_proved == 1 && isinf(answer.verdict.ray_force_min));
  /* A ray that proves nothing is refused with its reason. */
  const double f[2] = {0, 0}, wrong[2] = {1, 2};
  lcpbench_verdict verdict;
  const lcpbench_answer claim = Claim(LCPBENCH_INFEASIBLE, 2, f, wrong);
  CHECK_OK(lcpbench_verify(problem, &claim, 1e-6, &verdict, sizeof verdict, NULL));
  CHECK(verdict.has_ray == 1 && verdict.ray_accepted == 0 && strlen(verdict.ray_reason) > 0);
  Free(&answer);
  lcpbench_problem_free(problem);
}

static void AWrongAnswerIsFound(void) {
  lcpbench_problem* problem = KnownProblem();
  lcpbench_verdict verdict;
  double f[3] = {4.0 / 3, 7.0 / 3, 1e-3}, w[3];
  lcpbench_answer claim = Claim(LCPBENCH_SOLVED, 3, f, NULL);
  CHECK_OK(lcpbench_verify(problem, &claim, 1e-9, &verdict, sizeof verdict, w));
  CHECK(verdict.passes == 0 && verdict.false_success == 1 && verdict.best_tier == 1e-3);
  CHECK(strstr(verdict.reason, "rho") != NULL);
  /* By hand: D = (2, 2, 1), r = (0, 0, 1e-3), D^-1/2 b = (-5, -6, 0) / sqrt 2 and 3. */
  CHECK(fabs(verdict.rho - 1e-3 / sqrt(12.5 + 18 + 9)) < 1e-15);
  CHECK(fabs(verdict.complementarity - 1e-3 * 3.001) < 1e-15);
  CHECK(fabs(w[2] - 3.001) < 1e-15);
  f[0] = -1;
  claim.status = LCPBENCH_ITERATION_LIMIT;
  CHECK_OK(lcpbench_verify(problem, &claim, 1e-9, &verdict, sizeof verdict, NULL));
  CHECK(verdict.passes == 0 && verdict.false_success == 0 && verdict.best_tier == 0 &&
        verdict.primal_infeasibility == 1);
  f[0] = NAN;
  claim.status = LCPBENCH_SOLVED;
  CHECK_OK(lcpbench_verify(problem, &claim, 1e-3, &verdict, sizeof verdict, w));
  CHECK(verdict.passes == 0 && verdict.false_success == 1 && isinf(verdict.rho) && isnan(w[0]));
  lcpbench_problem_free(problem);
}

/* Own solvers must solve the known problem. Other projects' may fail, and some claim what they do not reach; who passes
   is right. */
static void EverySolverSolvesTheKnownProblem(void) {
  lcpbench_problem* problem = KnownProblem();
  const lcpbench_solve_options options = {.size = sizeof options, .tolerance = 1e-6};
  const size_t count = lcpbench_solver_count();
  int solved = 0, has_auto = 0;
  CHECK(count >= 14);
  for (size_t i = 0; i < count; ++i) {
    lcpbench_solver_info info;
    CHECK_OK(lcpbench_solver_describe(i, &info, sizeof info));
    CHECK(strlen(info.method) > 0 && strlen(info.licence) > 0);
    has_auto |= strcmp(info.key, "auto") == 0;
    if (!info.available) {
      lcpbench_solver* none = NULL;
      CHECK_REFUSED(lcpbench_solver_create(info.key, NULL, 0, &none), "not in this build");
      CHECK(none == NULL);
      continue;
    }
    double w[3];
    Answer answer = Solve(info.key, problem, &options, w);
    // Methods of auto alone do not take every form.
    const int is_right = answer.got.status == LCPBENCH_SOLVED && answer.verdict.passes == 1;
    if (!info.is_peer) CHECK(is_right || answer.got.status == LCPBENCH_UNSUPPORTED);
    if (answer.verdict.passes) {
      ++solved;
      for (int k = 0; k < 3; ++k) CHECK(fabs(answer.got.f[k] - kF[k]) < 1e-4 && fabs(w[k] - kW[k]) < 1e-4);
    } else {
      printf("%s does not pass, and says %s\n", info.key, lcpbench_status_key(answer.got.status));
    }
    Free(&answer);
  }
  CHECK(has_auto && solved >= 10);
  lcpbench_problem_free(problem);
}

static void OptionsReachTheSolver(void) {
  enum { kRows = 40 };
  double A[kRows * kRows], b[kRows];
  memset(A, 0, sizeof A);
  for (int i = 0; i < kRows; ++i) {
    A[i * kRows + i] = 2;
    if (i + 1 < kRows) A[i * kRows + i + 1] = A[(i + 1) * kRows + i] = -1;
    b[i] = -1; /* all rows are active: a long chain, which Gauss-Seidel creeps along */
  }
  lcpbench_problem* problem = Dense(kRows, A, b, NULL, LCPBENCH_SYMMETRIC);
  lcpbench_solve_options options = {.size = sizeof options};
  options.max_iterations = 3;
  Answer few = Solve("pgs", problem, &options, NULL);
  CHECK(few.got.status == LCPBENCH_ITERATION_LIMIT);
  CHECK(few.got.iterations == 3);
  Free(&few);

  options.max_iterations = 0;
  Answer cold = Solve("pgs", problem, &options, NULL);
  CHECK(cold.got.status == LCPBENCH_SOLVED && cold.got.n == kRows);
  /* -f'' = 1 with f = 0 at both ends, in finite differences. */
  for (int i = 0; i < kRows; ++i) CHECK(fabs(cold.got.f[i] - 0.5 * (i + 1) * (kRows - i)) < 1e-4);
  const int64_t cold_sweeps = cold.got.iterations;

  options.initial_f = cold.got.f;
  options.initial_f_size = cold.got.n;
  Answer warm = Solve("pgs", problem, &options, NULL);
  CHECK(warm.got.status == LCPBENCH_SOLVED);
  CHECK(warm.got.iterations * 10 < cold_sweeps);
  Free(&warm);

  /* A solver's answer may be the start of its next solve. */
  lcpbench_answer next = {.size = sizeof next};
  CHECK_OK(lcpbench_solve(cold.solver, problem, &options, &next));
  CHECK(next.status == LCPBENCH_SOLVED && next.iterations * 10 < cold_sweeps);

  /* Settings reach the method: 1.8 is close to the best relaxation of this chain. */
  const lcpbench_setting settings[2] = {{"relaxation", "1.8"}, {"form", "assembled"}};
  lcpbench_solver* relaxed = NULL;
  options.initial_f = NULL;
  options.initial_f_size = 0;
  CHECK_OK(lcpbench_solver_create("pgs", settings, 2, &relaxed));
  CHECK_OK(lcpbench_solver_prepare(relaxed, problem));
  CHECK_OK(lcpbench_solve(relaxed, problem, &options, &next));
  CHECK(next.status == LCPBENCH_SOLVED && next.iterations * 2 < cold_sweeps);
  lcpbench_solver_free(relaxed);

  options.time_limit_s = 1e-9;
  Answer late = Solve("pgs", problem, &options, NULL);
  CHECK(late.got.status == LCPBENCH_TIME_LIMIT);
  Free(&late);
  Free(&cold);
  lcpbench_problem_free(problem);
}

/* Of a dense matrix, a sparse one, and factors with and without bodies, in both layouts, by every own solver. */
static void NoRowsAreAProblem(void) {
  const double inverse_mass[3] = {1, 1, 1};
  const size_t solvers = lcpbench_solver_count();
  for (int form = 0; form < 8; ++form) {
    lcpbench_problem_data data = {.size = sizeof data, .form = LCPBENCH_DENSE, .layout = form % 2};
    if (form / 2 == 1) data.form = LCPBENCH_SPARSE;
    if (form >= 4) {
      data.form = LCPBENCH_FACTORS;
      data.columns = form < 6 ? 0 : 3;
      data.inverse_mass = inverse_mass;
    }
    lcpbench_problem* problem = Create(&data);
    for (size_t k = 0; k < solvers; ++k) {
      lcpbench_solver_info info;
      CHECK_OK(lcpbench_solver_describe(k, &info, sizeof info));
      if (!info.available || info.is_peer) continue;
      Answer answer = Solve(info.key, problem, NULL, NULL);
      CHECK(answer.got.status == LCPBENCH_SOLVED && answer.got.n == 0 && answer.got.f == NULL &&
            answer.verdict.passes == 1);
      Free(&answer);
    }
    lcpbench_problem_free(problem);
  }
}

static void WrongProblemsAreRefused(void) {
  lcpbench_problem* problem = NULL;
  double A[9] = {2, 1, 0, 1, 2, 0, 0, 0, 1}, b[3] = {-5, -6, 3};
  const uint8_t kinds[3] = {0, 2, 0};
  const lcpbench_problem_data dense = DenseData(3, A, b, NULL, 0);
  lcpbench_problem_data data = dense;
#define CREATE() lcpbench_problem_create(&data, &problem)
#define WITH(right, member, value, words) \
  do {                                    \
    data = right;                         \
    data.member = value;                  \
    CHECK_REFUSED(CREATE(), words);       \
  } while (0)
  CHECK_REFUSED(lcpbench_problem_create(NULL, &problem), "data is NULL");
  CHECK_REFUSED(lcpbench_problem_create(&data, NULL), "problem is NULL");
  WITH(dense, size, 0, "size is 0, expected sizeof(lcpbench_problem_data)");
  WITH(dense, form, 0, "form is 0");
  WITH(dense, form, 4, "form is 4");
  WITH(dense, rows, -1, "rows is -1");
  WITH(dense, rows, (int64_t)1 << 31, "rows is 2147483648");
  WITH(dense, values, NULL, "values is NULL");
  WITH(dense, b, NULL, "b is NULL");
  WITH(dense, layout, 7, "layout is 7");
  WITH(dense, kinds, kinds, "kinds[1] is 2");
  WITH(dense, facts, 8, "facts is 8");
  A[3] = NAN;
  WITH(dense, layout, LCPBENCH_COLUMN_MAJOR, "A: entry (0, 1) is nan");
  WITH(dense, layout, LCPBENCH_ROW_MAJOR, "A: entry (1, 0) is nan");
  A[3] = 5;
  WITH(dense, facts, LCPBENCH_SYMMETRIC, "A is not symmetric");
  A[3] = 1;
  b[2] = -INFINITY;
  WITH(dense, facts, 0, "b[2] is -inf");
  b[2] = 3;

  int32_t starts[4] = {0, 2, 4, 5}, indices[5] = {0, 1, 0, 1, 2};
  double values[5] = {2, 1, 1, 2, 1};
  lcpbench_problem_data sparse = DenseData(3, values, b, NULL, 0);
  sparse.form = LCPBENCH_SPARSE;
  sparse.starts = starts;
  sparse.indices = indices;
  sparse.entries = 5;
  WITH(sparse, entries, 4, "starts[3] is 5, expected entries = 4");
  WITH(sparse, entries, -1, "entries is -1");
  WITH(sparse, starts, NULL, "starts is NULL");
  WITH(sparse, indices, NULL, "indices is NULL");
  WITH(sparse, values, NULL, "values is NULL");
  data = sparse;
  starts[0] = 1;
  CHECK_REFUSED(CREATE(), "starts[0] is 1");
  starts[0] = 0;
  starts[1] = 5;
  CHECK_REFUSED(CREATE(), "starts[2] is 4, less than the 5 before it");
  starts[1] = 2;
  for (indices[4] = -1; indices[4] <= 3; indices[4] += 4) {
    CHECK_REFUSED(CREATE(), indices[4] < 0 ? "indices[4] is -1" : "indices[4] is 3");
  }
  indices[4] = 2;
  indices[1] = 0;
  CHECK_REFUSED(CREATE(), "entry (0, 0) of A is stored twice");
  indices[1] = 1;
  values[2] = INFINITY;
  CHECK_REFUSED(CREATE(), "values[2] is inf");
  values[2] = 1;

  const double inverse_mass[3] = {1, -2, 1};
  lcpbench_problem_data factors = sparse;
  factors.form = LCPBENCH_FACTORS;
  factors.columns = 3;
  WITH(factors, inverse_mass, inverse_mass, "inverse_mass[1] is -2");
  WITH(factors, inverse_mass, NULL, "inverse_mass is NULL");
  WITH(factors, columns, -3, "columns is -3");
  data = factors;
  data.rows = data.columns = data.entries = 0;
  data.columns_per_body = 5;
  CHECK_REFUSED(CREATE(), "columns_per_body is 5, expected 3");
  CHECK(problem == NULL);
#undef WITH
}

static void WrongCallsAreRefused(void) {
  lcpbench_problem* problem = KnownProblem();
  lcpbench_solver* solver = NULL;
  lcpbench_answer answer = {.size = sizeof answer};
  const lcpbench_setting unknown[1] = {{"colour", "red"}}, twice[2] = {{"relaxation", "1"}, {"relaxation", "1.5"}};
  const lcpbench_setting far[1] = {{"relaxation", "2.5"}}, empty[1] = {{NULL, "1"}};
  CHECK_REFUSED(lcpbench_solver_create("simplex", NULL, 0, &solver),
                "lcpbench_solver_create: unknown solver 'simplex'");
  CHECK_REFUSED(lcpbench_solver_create(NULL, NULL, 0, &solver), "key is NULL");
  CHECK_REFUSED(lcpbench_solver_create("pgs", NULL, 0, NULL), "solver is NULL");
  CHECK_REFUSED(lcpbench_solver_create("pgs", NULL, 1, &solver), "settings is NULL");
  CHECK_REFUSED(lcpbench_solver_create("pgs", unknown, 1, &solver), "unknown option 'colour'");
  CHECK_REFUSED(lcpbench_solver_create("pgs", far, 1, &solver), "relaxation");
  CHECK_REFUSED(lcpbench_solver_create("pgs", twice, 2, &solver), "settings[1].name is 'relaxation'");
  CHECK_REFUSED(lcpbench_solver_create("pgs", empty, 1, &solver), "settings[0].name is NULL");
  CHECK(solver == NULL);
  CHECK_OK(lcpbench_solver_create("pgs", NULL, 0, &solver));

  lcpbench_verdict verdict;
  CHECK_REFUSED(lcpbench_verify(problem, &answer, 1e-6, &verdict, sizeof verdict, NULL), "answer.n is 0");
  CHECK_REFUSED(lcpbench_solve(NULL, problem, NULL, &answer), "solver is NULL");
  CHECK_REFUSED(lcpbench_solve(solver, NULL, NULL, &answer), "problem is NULL");
  CHECK_REFUSED(lcpbench_solve(solver, problem, NULL, NULL), "answer is NULL");
  answer.size = 8;
  CHECK_REFUSED(lcpbench_solve(solver, problem, NULL, &answer), "size is 8, expected sizeof(lcpbench_answer)");
  answer.size = sizeof answer;

  lcpbench_solve_options options = {.size = 0};
  CHECK_REFUSED(lcpbench_solve(solver, problem, &options, &answer), "sizeof(lcpbench_solve_options)");
  options.size = 8;
  CHECK_REFUSED(lcpbench_solve(solver, problem, &options, &answer), "size is 8");
  const double start[3] = {1, NAN, 0};
  const struct {
    double tolerance, time_limit_s;
    int64_t max_iterations;
    const double* initial_f;
    int64_t initial_f_size;
    const char* words;
  } wrong[] = {{-1, 1, 0, NULL, 0, "tolerance"},          {1, 1, 0, NULL, 0, "tolerance"},
               {NAN, 1, 0, NULL, 0, "tolerance"},         {1e-6, -1, 0, NULL, 0, "time limit"},
               {1e-6, NAN, 0, NULL, 0, "time limit"},     {1e-6, 1, -1, NULL, 0, "iteration limit"},
               {1e-6, 1, 0, start, 2, "initial_f_size"},  {1e-6, 1, 0, start, 3, "initial f must be finite"},
               {1e-6, 1, 0, NULL, 3, "initial_f is NULL"}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
    options.size = sizeof options;
    options.tolerance = wrong[i].tolerance;
    options.time_limit_s = wrong[i].time_limit_s;
    options.max_iterations = wrong[i].max_iterations;
    options.initial_f = wrong[i].initial_f;
    options.initial_f_size = wrong[i].initial_f_size;
    CHECK_REFUSED(lcpbench_solve(solver, problem, &options, &answer), wrong[i].words);
  }
  CHECK(answer.status == LCPBENCH_NOT_RUN && answer.f == NULL); /* none of these wrote to the answer */

  const double f[3] = {0, 0, 0};
  lcpbench_solver_info info;
#define VERIFY(tolerance, verdict, size) lcpbench_verify(problem, &answer, tolerance, verdict, size, NULL)
  answer = Claim(LCPBENCH_NOT_RUN, 2, f, NULL);
  CHECK_REFUSED(VERIFY(1e-6, &verdict, sizeof verdict), "answer.n is 2, expected the problem's n = 3");
  answer = Claim(LCPBENCH_NOT_RUN, 3, NULL, NULL);
  CHECK_REFUSED(VERIFY(1e-6, &verdict, sizeof verdict), "answer.f is NULL");
  answer = Claim(9, 3, f, NULL);
  CHECK_REFUSED(VERIFY(1e-6, &verdict, sizeof verdict), "answer.status is 9");
  answer = Claim(LCPBENCH_NOT_RUN, 3, f, NULL);
  CHECK_REFUSED(VERIFY(2, &verdict, sizeof verdict), "tolerance is 2");
  CHECK_REFUSED(VERIFY(1e-6, NULL, sizeof verdict), "verdict is NULL");
  CHECK_REFUSED(VERIFY(1e-6, &verdict, 16), "size is 16");
  CHECK_REFUSED(lcpbench_verify(NULL, &answer, 1e-6, &verdict, sizeof verdict, NULL), "problem is NULL");
  CHECK_REFUSED(lcpbench_verify(problem, NULL, 1e-6, &verdict, sizeof verdict, NULL), "answer is NULL");
  answer.size = 0;
  CHECK_REFUSED(VERIFY(1e-6, &verdict, sizeof verdict), "size is 0, expected sizeof(lcpbench_answer)");
  answer.size = sizeof answer;
  CHECK_REFUSED(lcpbench_solver_describe(lcpbench_solver_count(), &info, sizeof info), "index is");
  CHECK_REFUSED(lcpbench_solver_describe(0, &info, 3), "size is 3");
  CHECK_REFUSED(lcpbench_limit_library_threads(0, NULL), "threads is 0");
  CHECK(strcmp(lcpbench_status_key(99), "unknown") == 0);

  /* An answer to another problem does not fit. */
  lcpbench_problem* smaller = Dense(1, kA, kB, NULL, 0);
  CHECK_OK(lcpbench_solve(solver, smaller, NULL, &answer));
  CHECK_REFUSED(VERIFY(1e-6, &verdict, sizeof verdict), "answer.n is 1");
  lcpbench_problem_free(smaller);
  lcpbench_solver_free(solver);
  lcpbench_problem_free(problem);
  lcpbench_solver_free(NULL);
  lcpbench_problem_free(NULL);
}

/* Programs of a later version have larger structs: members that this library does not know must be unused. */
static void LaterStructsAreUnderstood(void) {
  struct {
    lcpbench_solve_options options;
    double later;
  } options = {.options = {.size = sizeof options}};
  struct {
    lcpbench_answer answer;
    double later;
  } answer = {.answer = {.size = sizeof answer}};
  struct {
    lcpbench_verdict verdict;
    char later[40];
  } verdict;
  lcpbench_problem* problem = KnownProblem();
  lcpbench_solver* solver = NULL;
  memset(&verdict, 0xff, sizeof verdict);
  CHECK_OK(lcpbench_solver_create("bpp", NULL, 0, &solver));
  CHECK_OK(lcpbench_solve(solver, problem, &options.options, &answer.answer));
  CHECK(answer.answer.status == LCPBENCH_SOLVED && answer.answer.size == sizeof answer && answer.later == 0);
  CHECK_OK(lcpbench_verify(problem, &answer.answer, 1e-9, &verdict.verdict, sizeof verdict, NULL));
  CHECK(verdict.verdict.passes == 1 && verdict.later[0] == 0 && verdict.later[39] == 0);
  options.later = 1;
  CHECK_REFUSED(lcpbench_solve(solver, problem, &options.options, &answer.answer), "options has members that");
  answer.later = 1;
  CHECK_REFUSED(lcpbench_solve(solver, problem, NULL, &answer.answer), "answer has members that");
  lcpbench_solver_free(solver);
  lcpbench_problem_free(problem);
}

typedef struct Share {
  const char* key;
  const lcpbench_problem* problem;
  int wrong;
} Share;

static void* SolveAndFail(void* argument) {
  Share* share = argument;
  lcpbench_solver* solver = NULL;
  lcpbench_answer answer = {.size = sizeof answer};
  lcpbench_verdict verdict;
  char name[32], words[64];
  snprintf(name, sizeof name, "no-%s", share->key);
  snprintf(words, sizeof words, "unknown option '%s'", name);
  const lcpbench_setting setting[1] = {{name, "1"}};
  if (lcpbench_solver_create(share->key, NULL, 0, &solver)) ++share->wrong;
  for (int i = 0; i < 50; ++i) {
    lcpbench_solver* none = NULL;
    if (lcpbench_solver_create(share->key, setting, 1, &none) == LCPBENCH_OK) ++share->wrong;
    share->wrong += lcpbench_solve(solver, share->problem, NULL, &answer) ||
                    lcpbench_verify(share->problem, &answer, 1e-9, &verdict, sizeof verdict, NULL) || !verdict.passes;
    if (strstr(lcpbench_last_error(), words) == NULL) ++share->wrong; /* this thread's mistake, not another's */
  }
  lcpbench_solver_free(solver);
  return NULL;
}

static void ThreadsShareAProblemAndKeepTheirErrors(void) {
  lcpbench_problem* problem = KnownProblem();
  Share shares[4] = {{"auto", problem, 0}, {"dantzig", problem, 0}, {"lemke", problem, 0}, {"bpp", problem, 0}};
  pthread_t threads[4];
  for (int i = 0; i < 4; ++i) CHECK(pthread_create(&threads[i], NULL, SolveAndFail, &shares[i]) == 0);
  for (int i = 0; i < 4; ++i) {
    CHECK(pthread_join(threads[i], NULL) == 0);
    CHECK(shares[i].wrong == 0);
  }
  lcpbench_problem_free(problem);
}

/* A block on the ground, pushed: sticks for mu = 1 (f_t = -1), slips for mu = 1/2 (w_t = 1/2). */
static void FrictionIsSolvedAndJudged(void) {
  const double A[4] = {1, 0, 0, 1};
  const double b[2] = {-1, 1};
  lcpbench_friction_row row = {1, 0, 1, 0, 0};
  lcpbench_problem_data data = DenseData(2, A, b, NULL, LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE);
  data.friction = &row;
  data.friction_count = 1;
  double w[2];
  Answer answer;
  lcpbench_problem* problem = Create(&data);
  answer = Solve("pgs", problem, NULL, w);
  CHECK(answer.got.status == LCPBENCH_SOLVED && answer.verdict.passes == 1);
  CHECK(fabs(answer.got.f[0] - 1) < 1e-9 && fabs(answer.got.f[1] + 1) < 1e-9 && fabs(w[1]) < 1e-9);
  Free(&answer);
  answer = Solve("dantzig", problem, NULL, w);
  CHECK(answer.got.status == LCPBENCH_UNSUPPORTED);
  Free(&answer);
  lcpbench_problem_free(problem);

  row.mu = 0.5;
  problem = Create(&data);
  answer = Solve("pgs", problem, NULL, w);
  CHECK(answer.got.status == LCPBENCH_SOLVED && answer.verdict.passes == 1);
  CHECK(fabs(answer.got.f[1] + 0.5) < 1e-9 && fabs(w[1] - 0.5) < 1e-9);
  Free(&answer);
  answer = Solve("relaxation", problem, NULL, w); /* slip separates */
  CHECK(answer.got.status == LCPBENCH_SOLVED && answer.verdict.passes == 0 && answer.verdict.false_success == 0);
  CHECK(answer.verdict.model_rho >= 0 && answer.verdict.model_rho < 1e-9 && answer.verdict.separation > 1e-3);
  Free(&answer);
  lcpbench_problem_free(problem);

  problem = NULL;
  row.mu = -1;
  CHECK_REFUSED(CREATE(), "friction: row 1: mu is -1, expected a finite number >= 0");
  row.mu = NAN;
  CHECK_REFUSED(CREATE(), "friction: row 1: mu is nan");
  row.mu = 1;
  row.normal = 2;
  CHECK_REFUSED(CREATE(), "friction: row 1: normal is 2, expected a unilateral row");
  CHECK(problem == NULL);
}

/* A ball that pushes with 5 N against what yields at 2 N. */
static void BoundsAreSolvedAndRefused(void) {
  const double A[1] = {1}, b[1] = {-5};
  lcpbench_bounded_row row = {0, -2, 2};
  lcpbench_problem_data data = DenseData(1, A, b, NULL, LCPBENCH_SYMMETRIC);
  data.bounded = &row;
  data.bounded_count = 1;
  lcpbench_problem* problem = Create(&data);
  double w[1];
  Answer answer = Solve("auto", problem, NULL, w);
  CHECK(answer.got.status == LCPBENCH_SOLVED && answer.verdict.passes == 1);
  CHECK(fabs(answer.got.f[0] - 2) < 1e-12 && fabs(w[0] + 3) < 1e-12);
  Free(&answer);
  const lcpbench_solve_options options = {.size = sizeof options, .rank_tolerance = 1e-10};
  answer = Solve("auto", problem, &options, NULL);
  CHECK(answer.got.status == LCPBENCH_SOLVED && answer.got.nullity == -1 && fabs(answer.got.f[0] - 2) < 1e-12);
  CHECK(strcmp(answer.got.detail, "not of least norm: least norm is for plain problems") == 0);
  Free(&answer);
  lcpbench_problem_free(problem);
  problem = NULL;
  row.lower = 3;
  CHECK_REFUSED(CREATE(), "bounded: row 0: lower is 3 and upper 2");
  data.bounded = NULL;
  CHECK_REFUSED(CREATE(), "bounded is NULL");
  data.bounded_count = -1;
  CHECK_REFUSED(CREATE(), "bounded_count is -1");
  CHECK(problem == NULL);
}

int main(void) {
  CHECK(lcpbench_last_error()[0] == '\0');
  CHECK(strcmp(lcpbench_version(), LCPBENCH_EXPECTED_VERSION) == 0);
  SolvesAKnownProblem();
  FrictionIsSolvedAndJudged();
  BoundsAreSolvedAndRefused();
  LeastNormSharesEqually();
  LayoutsAndFormsAgree();
  FactorsAreTheirProduct();
  AnInfeasibleProblemHasARay();
  AWrongAnswerIsFound();
  EverySolverSolvesTheKnownProblem();
  OptionsReachTheSolver();
  NoRowsAreAProblem();
  WrongProblemsAreRefused();
  WrongCallsAreRefused();
  LaterStructsAreUnderstood();
  ThreadsShareAProblemAndKeepTheirErrors();
  return CountFailures();
}
