/* The C interface from C99. */
#include <lcpbench.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/c/check.h"

/* A solver, a result and a verdict: what a caller has of each. */
typedef struct Answer {
  lcpbench_solver* solver;
  lcpbench_result* result;
  lcpbench_status status;
  lcpbench_verdict verdict;
  const double* f;
  int64_t n;
} Answer;

static Answer Solve(const char* key, const lcpbench_problem* problem, const lcpbench_solve_options* options,
                    double* w) {
  Answer answer;
  memset(&answer, 0, sizeof answer);
  CHECK_OK(lcpbench_solver_create(key, NULL, 0, &answer.solver));
  CHECK_OK(lcpbench_result_create(&answer.result));
  CHECK_OK(lcpbench_solve(answer.solver, problem, options, answer.result));
  CHECK_OK(lcpbench_result_status(answer.result, &answer.status));
  CHECK_OK(lcpbench_result_f(answer.result, &answer.f, &answer.n));
  CHECK_OK(lcpbench_verify_result(problem, answer.result, 1e-6, &answer.verdict, sizeof answer.verdict, w));
  return answer;
}

static int64_t Iterations(const lcpbench_result* result) {
  int64_t iterations = -2;
  CHECK_OK(lcpbench_result_iterations(result, &iterations));
  return iterations;
}

static void Free(Answer* answer) {
  lcpbench_result_free(answer->result);
  lcpbench_solver_free(answer->solver);
}

/* A ball between two walls, and one that lifts off: f = (4/3, 7/3, 0), w = (0, 0, 3), by hand. */
static const double kA[9] = {2, 1, 0, 1, 2, 0, 0, 0, 1};
static const double kB[3] = {-5, -6, 3};
static const double kF[3] = {4.0 / 3, 7.0 / 3, 0};
static const double kW[3] = {0, 0, 3};

static lcpbench_problem* Dense(int64_t n, const double* A, const double* b, const uint8_t* kinds, uint32_t facts) {
  lcpbench_problem* problem = NULL;
  CHECK_OK(lcpbench_problem_from_dense(n, A, LCPBENCH_COLUMN_MAJOR, b, kinds, facts, &problem));
  return problem;
}

static lcpbench_problem* KnownProblem(void) {
  return Dense(3, kA, kB, NULL, LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE);
}

static void SolvesAKnownProblem(void) {
  lcpbench_problem* problem = KnownProblem();
  double w[3];
  Answer answer = Solve("dantzig", problem, NULL, w);
  CHECK(answer.status == LCPBENCH_SOLVED);
  CHECK(answer.n == 3);
  for (int i = 0; i < 3; ++i) {
    CHECK(fabs(answer.f[i] - kF[i]) < 1e-14);
    CHECK(fabs(w[i] - kW[i]) < 1e-14);
    /* The identity, from numbers that the library did not compute. */
    double sum = kB[i];
    for (int j = 0; j < 3; ++j) sum += kA[3 * i + j] * answer.f[j];
    CHECK(fabs(w[i] - sum) < 1e-14);
  }
  CHECK(answer.verdict.passes == 1 && answer.verdict.best_tier == 1e-9 && answer.verdict.false_success == 0);
  CHECK(answer.verdict.requested == 1e-6 && answer.verdict.has_ray == 0 && answer.verdict.reason[0] == '\0');
  CHECK(answer.verdict.energy_bound >= 0 && answer.verdict.energy_bound < 1e-14);
  CHECK(Iterations(answer.result) >= 0);
  CHECK(strcmp(lcpbench_status_key(answer.status), "solved") == 0);
  Free(&answer);
  lcpbench_problem_free(problem);
}

/* Two rows that share one load in any way: equal shares have the least norm. */
static void LeastNormSharesEqually(void) {
  const double A[4] = {1, 1, 1, 1}, b[2] = {-2, -2};
  lcpbench_problem* problem = Dense(2, A, b, NULL, LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE);
  double w[2];
  Answer answer = Solve("dantzig", problem, NULL, w);
  int64_t nullity = -2, n = 0;
  const double* f = NULL;
  CHECK_OK(lcpbench_result_least_norm(problem, answer.result, 1e-9, 1e-10, &nullity));
  CHECK_OK(lcpbench_result_f(answer.result, &f, &n));
  CHECK(nullity == 1 && n == 2 && fabs(f[0] - 1) < 1e-12 && fabs(f[1] - 1) < 1e-12);
  CHECK_REFUSED(lcpbench_result_least_norm(problem, answer.result, 1e-9, 2, &nullity), "rank_tolerance");
  CHECK_REFUSED(lcpbench_result_least_norm(problem, answer.result, 0, 1e-10, &nullity), "tolerance");
  CHECK_REFUSED(lcpbench_result_least_norm(NULL, answer.result, 1e-9, 1e-10, &nullity), "problem is NULL");
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
  lcpbench_problem* problems[4] = {NULL, NULL, NULL, NULL};
  CHECK_OK(lcpbench_problem_from_dense(2, by_columns, LCPBENCH_COLUMN_MAJOR, b, NULL, 0, &problems[0]));
  CHECK_OK(lcpbench_problem_from_dense(2, by_rows, LCPBENCH_ROW_MAJOR, b, NULL, 0, &problems[1]));
  CHECK_OK(
      lcpbench_problem_from_sparse(2, LCPBENCH_COLUMN_MAJOR, starts, indices, columns, 4, b, NULL, 0, &problems[2]));
  CHECK_OK(lcpbench_problem_from_sparse(2, LCPBENCH_ROW_MAJOR, starts, indices, rows, 4, b, NULL, 0, &problems[3]));
  for (int k = 0; k < 4; ++k) {
    double w[2] = {0, 0};
    lcpbench_verdict verdict;
    CHECK_OK(lcpbench_verify(problems[k], f, 2, LCPBENCH_NOT_RUN, NULL, 1e-9, &verdict, sizeof verdict, w));
    CHECK(w[0] == expected[0] && w[1] == expected[1]);
    CHECK(verdict.energy_bound == -1);
    lcpbench_problem_free(problems[k]);
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
  lcpbench_problem *factors = NULL, *dense = Dense(kRows, A, b, kinds, LCPBENCH_SYMMETRIC);
  CHECK_OK(lcpbench_problem_from_factors(kRows, 3 * (kRows + 1), LCPBENCH_ROW_MAJOR, row_starts, row_indices,
                                         row_values, 2 * kRows, inverse_mass, b, kinds, &factors));
  double w_factors[kRows], w_dense[kRows];
  Answer first = Solve("auto", factors, NULL, w_factors);
  Answer second = Solve("lemke", dense, NULL, w_dense);
  CHECK(first.verdict.best_tier == 1e-9 && second.verdict.best_tier == 1e-9);
  int negative = 0;
  for (int i = 0; i < kRows; ++i) {
    CHECK(fabs(first.f[i] - second.f[i]) < 1e-11); /* A is positive definite: one solution */
    CHECK(fabs(w_factors[i] - w_dense[i]) < 1e-11);
    negative += kinds[i] == LCPBENCH_BILATERAL && first.f[i] < -1e-3;
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
  CHECK(answer.status == LCPBENCH_INFEASIBLE);
  CHECK(answer.verdict.passes == 0 && answer.verdict.false_infeasible == 0);
  CHECK(answer.verdict.has_ray == 1 && answer.verdict.ray_accepted == 1 && answer.verdict.ray_b_dot_y < 0);
  const double* ray = NULL;
  int64_t n = 0;
  CHECK_OK(lcpbench_result_farkas_ray(answer.result, &ray, &n));
  CHECK(n == 2 && ray[0] > 0 && ray[0] == ray[1]);
  CHECK(answer.verdict.ray_proved == 1 && isinf(answer.verdict.ray_force_min));
  /* A ray that proves nothing is refused with its reason. */
  const double f[2] = {0, 0}, wrong[2] = {1, 2};
  lcpbench_verdict verdict;
  CHECK_OK(lcpbench_verify(problem, f, 2, LCPBENCH_INFEASIBLE, wrong, 1e-6, &verdict, sizeof verdict, NULL));
  CHECK(verdict.has_ray == 1 && verdict.ray_accepted == 0 && strlen(verdict.ray_reason) > 0);
  Free(&answer);
  lcpbench_problem_free(problem);
}

static void AWrongAnswerIsFound(void) {
  lcpbench_problem* problem = KnownProblem();
  lcpbench_verdict verdict;
  double f[3] = {4.0 / 3, 7.0 / 3, 1e-3}, w[3];
  CHECK_OK(lcpbench_verify(problem, f, 3, LCPBENCH_SOLVED, NULL, 1e-9, &verdict, sizeof verdict, w));
  CHECK(verdict.passes == 0 && verdict.false_success == 1 && verdict.best_tier == 1e-3);
  CHECK(strstr(verdict.reason, "rho") != NULL);
  /* By hand: D = (2, 2, 1), r = (0, 0, 1e-3), D^-1/2 b = (-5, -6, 0) / sqrt 2 and 3. */
  CHECK(fabs(verdict.rho - 1e-3 / sqrt(12.5 + 18 + 9)) < 1e-15);
  CHECK(fabs(verdict.complementarity - 1e-3 * 3.001) < 1e-15);
  CHECK(fabs(w[2] - 3.001) < 1e-15);
  f[0] = -1;
  CHECK_OK(lcpbench_verify(problem, f, 3, LCPBENCH_ITERATION_LIMIT, NULL, 1e-9, &verdict, sizeof verdict, NULL));
  CHECK(verdict.passes == 0 && verdict.false_success == 0 && verdict.best_tier == 0 &&
        verdict.primal_infeasibility == 1);
  f[0] = NAN;
  CHECK_OK(lcpbench_verify(problem, f, 3, LCPBENCH_SOLVED, NULL, 1e-3, &verdict, sizeof verdict, w));
  CHECK(verdict.passes == 0 && verdict.false_success == 1 && isinf(verdict.rho) && isnan(w[0]));
  lcpbench_problem_free(problem);
}

/* Own solvers must solve the known problem. Other projects' may fail, and some claim what they do not reach; who passes
   is right. */
static void EverySolverSolvesTheKnownProblem(void) {
  lcpbench_problem* problem = KnownProblem();
  lcpbench_solve_options options;
  CHECK_OK(lcpbench_solve_options_init(&options, sizeof options));
  options.tolerance = 1e-6;
  size_t count = 0;
  int solved = 0, has_auto = 0;
  CHECK_OK(lcpbench_solver_count(&count));
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
    const int is_right = answer.status == LCPBENCH_SOLVED && answer.verdict.passes == 1;
    if (!info.is_peer) CHECK(is_right || answer.status == LCPBENCH_UNSUPPORTED);
    if (answer.verdict.passes) {
      ++solved;
      for (int k = 0; k < 3; ++k) CHECK(fabs(answer.f[k] - kF[k]) < 1e-4 && fabs(w[k] - kW[k]) < 1e-4);
    } else {
      printf("%s does not pass, and says %s\n", info.key, lcpbench_status_key(answer.status));
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
  lcpbench_solve_options options;
  CHECK_OK(lcpbench_solve_options_init(&options, sizeof options));
  CHECK(options.size == sizeof options && options.tolerance == 1e-9 && isinf(options.time_limit_s));
  CHECK(options.max_iterations == 0 && options.initial_f == NULL && options.initial_f_size == 0);

  options.max_iterations = 3;
  Answer few = Solve("pgs", problem, &options, NULL);
  CHECK(few.status == LCPBENCH_ITERATION_LIMIT);
  CHECK(Iterations(few.result) == 3);
  Free(&few);

  options.max_iterations = 0;
  Answer cold = Solve("pgs", problem, &options, NULL);
  CHECK(cold.status == LCPBENCH_SOLVED && cold.n == kRows);
  /* -f'' = 1 with f = 0 at both ends, in finite differences. */
  for (int i = 0; i < kRows; ++i) CHECK(fabs(cold.f[i] - 0.5 * (i + 1) * (kRows - i)) < 1e-4);
  const int64_t cold_sweeps = Iterations(cold.result);

  options.initial_f = cold.f;
  options.initial_f_size = cold.n;
  Answer warm = Solve("pgs", problem, &options, NULL);
  CHECK(warm.status == LCPBENCH_SOLVED);
  CHECK(Iterations(warm.result) * 10 < cold_sweeps);
  Free(&warm);

  /* One result may be the start of the next solve into itself. */
  lcpbench_result* result = cold.result;
  CHECK_OK(lcpbench_solve(cold.solver, problem, &options, result));
  CHECK(Iterations(result) * 10 < cold_sweeps);

  /* Settings reach the method: 1.8 is close to the best relaxation of this chain. */
  const lcpbench_setting settings[2] = {{"relaxation", "1.8"}, {"form", "assembled"}};
  lcpbench_solver* relaxed = NULL;
  CHECK_OK(lcpbench_solve_options_init(&options, sizeof options));
  CHECK_OK(lcpbench_solver_create("pgs", settings, 2, &relaxed));
  CHECK_OK(lcpbench_solver_prepare(relaxed, problem));
  CHECK_OK(lcpbench_solve(relaxed, problem, &options, result));
  CHECK(Iterations(result) * 2 < cold_sweeps);
  lcpbench_solver_free(relaxed);

  options.time_limit_s = 1e-9;
  Answer late = Solve("pgs", problem, &options, NULL);
  CHECK(late.status == LCPBENCH_TIME_LIMIT);
  Free(&late);
  Free(&cold);
  lcpbench_problem_free(problem);
}

/* Of a dense matrix, a sparse one, and factors with and without bodies, in both layouts, by every own solver. */
static void NoRowsAreAProblem(void) {
  const double inverse_mass[3] = {1, 1, 1};
  size_t solvers = 0;
  CHECK_OK(lcpbench_solver_count(&solvers));
  for (int form = 0; form < 8; ++form) {
    const lcpbench_layout layout = form % 2;
    lcpbench_problem* problem = NULL;
    if (form < 2) CHECK_OK(lcpbench_problem_from_dense(0, NULL, layout, NULL, NULL, 0, &problem));
    if (form / 2 == 1) CHECK_OK(lcpbench_problem_from_sparse(0, layout, NULL, NULL, NULL, 0, NULL, NULL, 0, &problem));
    if (form >= 4) {
      CHECK_OK(lcpbench_problem_from_factors(0, form < 6 ? 0 : 3, layout, NULL, NULL, NULL, 0, inverse_mass, NULL, NULL,
                                             &problem));
    }
    int64_t n = -1;
    CHECK_OK(lcpbench_problem_size(problem, &n));
    CHECK(n == 0);
    for (size_t k = 0; k < solvers; ++k) {
      lcpbench_solver_info info;
      CHECK_OK(lcpbench_solver_describe(k, &info, sizeof info));
      if (!info.available || info.is_peer) continue;
      Answer answer = Solve(info.key, problem, NULL, NULL);
      CHECK(answer.status == LCPBENCH_SOLVED && answer.n == 0 && answer.f == NULL && answer.verdict.passes == 1);
      Free(&answer);
    }
    lcpbench_problem_free(problem);
  }
}

static void WrongProblemsAreRefused(void) {
  lcpbench_problem* problem = NULL;
  double A[9] = {2, 1, 0, 1, 2, 0, 0, 0, 1}, b[3] = {-5, -6, 3};
  const uint8_t kinds[3] = {0, 2, 0};
  CHECK_REFUSED(lcpbench_problem_from_dense(-1, A, 0, b, NULL, 0, &problem), "n is -1");
  CHECK_REFUSED(lcpbench_problem_from_dense((int64_t)1 << 31, A, 0, b, NULL, 0, &problem), "n is 2147483648");
  CHECK_REFUSED(lcpbench_problem_from_dense(3, NULL, 0, b, NULL, 0, &problem), "A is NULL");
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, 0, NULL, NULL, 0, &problem), "b is NULL");
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, 7, b, NULL, 0, &problem), "layout is 7");
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, 0, b, kinds, 0, &problem), "kinds[1] is 2");
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, 0, b, NULL, 8, &problem), "facts is 8");
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, 0, b, NULL, 0, NULL), "problem is NULL");
  A[3] = NAN;
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, LCPBENCH_COLUMN_MAJOR, b, NULL, 0, &problem),
                "A: entry (0, 1) is nan");
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, LCPBENCH_ROW_MAJOR, b, NULL, 0, &problem), "A: entry (1, 0) is nan");
  A[3] = 5;
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, 0, b, NULL, LCPBENCH_SYMMETRIC, &problem), "A is not symmetric");
  A[3] = 1;
  b[2] = -INFINITY;
  CHECK_REFUSED(lcpbench_problem_from_dense(3, A, 0, b, NULL, 0, &problem), "b[2] is -inf");
  b[2] = 3;

  int32_t starts[4] = {0, 2, 4, 5}, indices[5] = {0, 1, 0, 1, 2};
  double values[5] = {2, 1, 1, 2, 1};
#define FROM_SPARSE(entries) lcpbench_problem_from_sparse(3, 0, starts, indices, values, entries, b, NULL, 0, &problem)
  CHECK_REFUSED(FROM_SPARSE(4), "starts[3] is 5, expected entries = 4");
  CHECK_REFUSED(FROM_SPARSE(-1), "entries is -1");
  starts[0] = 1;
  CHECK_REFUSED(FROM_SPARSE(5), "starts[0] is 1");
  starts[0] = 0;
  starts[1] = 5;
  CHECK_REFUSED(FROM_SPARSE(5), "starts[2] is 4, less than the 5 before it");
  starts[1] = 2;
  for (indices[4] = -1; indices[4] <= 3; indices[4] += 4) {
    CHECK_REFUSED(FROM_SPARSE(5), indices[4] < 0 ? "indices[4] is -1" : "indices[4] is 3");
  }
  indices[4] = 2;
  indices[1] = 0;
  CHECK_REFUSED(FROM_SPARSE(5), "entry (0, 0) of A is stored twice");
  indices[1] = 1;
  values[2] = INFINITY;
  CHECK_REFUSED(FROM_SPARSE(5), "values[2] is inf");
  values[2] = 1;
  CHECK_REFUSED(lcpbench_problem_from_sparse(3, 0, NULL, indices, values, 5, b, NULL, 0, &problem), "starts is NULL");
  CHECK_REFUSED(lcpbench_problem_from_sparse(3, 0, starts, NULL, values, 5, b, NULL, 0, &problem), "indices is NULL");
  CHECK_REFUSED(lcpbench_problem_from_sparse(3, 0, starts, indices, NULL, 5, b, NULL, 0, &problem), "values is NULL");

  double inverse_mass[3] = {1, -2, 1};
#define FROM_FACTORS(columns, masses) \
  lcpbench_problem_from_factors(3, columns, 0, starts, indices, values, 5, masses, b, NULL, &problem)
  CHECK_REFUSED(FROM_FACTORS(3, inverse_mass), "inverse_mass[1] is -2");
  CHECK_REFUSED(FROM_FACTORS(3, NULL), "inverse_mass is NULL");
  CHECK_REFUSED(FROM_FACTORS(-3, inverse_mass), "columns is -3");
  CHECK(problem == NULL);
}

static void WrongCallsAreRefused(void) {
  lcpbench_problem* problem = KnownProblem();
  lcpbench_solver* solver = NULL;
  lcpbench_result* result = NULL;
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
  CHECK_OK(lcpbench_result_create(&result));
  CHECK(Iterations(result) == -1);

  lcpbench_verdict verdict;
  CHECK_REFUSED(lcpbench_verify_result(problem, result, 1e-6, &verdict, sizeof verdict, NULL), "result is empty");
  CHECK_REFUSED(lcpbench_solve(NULL, problem, NULL, result), "solver is NULL");
  CHECK_REFUSED(lcpbench_solve(solver, NULL, NULL, result), "problem is NULL");
  CHECK_REFUSED(lcpbench_solve(solver, problem, NULL, NULL), "result is NULL");

  lcpbench_solve_options options;
  memset(&options, 0, sizeof options);
  CHECK_REFUSED(lcpbench_solve(solver, problem, &options, result), "lcpbench_solve_options_init");
  CHECK_REFUSED(lcpbench_solve_options_init(&options, 8), "size is 8");
  const double start[3] = {1, NAN, 0};
  const struct {
    double tolerance, time_limit_s;
    int64_t max_iterations;
    const double* initial_f;
    int64_t initial_f_size;
    const char* words;
  } wrong[] = {{0, 1, 0, NULL, 0, "tolerance"},           {1, 1, 0, NULL, 0, "tolerance"},
               {NAN, 1, 0, NULL, 0, "tolerance"},         {1e-6, 0, 0, NULL, 0, "time limit"},
               {1e-6, NAN, 0, NULL, 0, "time limit"},     {1e-6, 1, -1, NULL, 0, "iteration limit"},
               {1e-6, 1, 0, start, 2, "initial_f_size"},  {1e-6, 1, 0, start, 3, "initial f must be finite"},
               {1e-6, 1, 0, NULL, 3, "initial_f is NULL"}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
    CHECK_OK(lcpbench_solve_options_init(&options, sizeof options));
    options.tolerance = wrong[i].tolerance;
    options.time_limit_s = wrong[i].time_limit_s;
    options.max_iterations = wrong[i].max_iterations;
    options.initial_f = wrong[i].initial_f;
    options.initial_f_size = wrong[i].initial_f_size;
    CHECK_REFUSED(lcpbench_solve(solver, problem, &options, result), wrong[i].words);
  }
  lcpbench_status status = LCPBENCH_SOLVED;
  CHECK_OK(lcpbench_result_status(result, &status));
  CHECK(status == LCPBENCH_NOT_RUN); /* none of these wrote to the result */

  const double f[3] = {0, 0, 0};
  size_t count = 0;
  CHECK_OK(lcpbench_solver_count(&count));
  lcpbench_solver_info info;
  CHECK_REFUSED(lcpbench_verify(problem, f, 2, 0, NULL, 1e-6, &verdict, sizeof verdict, NULL), "f_size is 2");
  CHECK_REFUSED(lcpbench_verify(problem, NULL, 3, 0, NULL, 1e-6, &verdict, sizeof verdict, NULL), "f is NULL");
  CHECK_REFUSED(lcpbench_verify(problem, f, 3, 9, NULL, 1e-6, &verdict, sizeof verdict, NULL), "claim is 9");
  CHECK_REFUSED(lcpbench_verify(problem, f, 3, 0, NULL, 2, &verdict, sizeof verdict, NULL), "tolerance is 2");
  CHECK_REFUSED(lcpbench_verify(problem, f, 3, 0, NULL, 1e-6, NULL, sizeof verdict, NULL), "verdict is NULL");
  CHECK_REFUSED(lcpbench_verify(problem, f, 3, 0, NULL, 1e-6, &verdict, 16, NULL), "size is 16");
  CHECK_REFUSED(lcpbench_solver_describe(count, &info, sizeof info), "index is");
  CHECK_REFUSED(lcpbench_solver_describe(0, &info, 3), "size is 3");
  CHECK_REFUSED(lcpbench_limit_library_threads(0, NULL), "threads is 0");
  CHECK_REFUSED(lcpbench_result_status(NULL, &status), "result is NULL");
  CHECK(strcmp(lcpbench_status_key(99), "unknown") == 0);

  /* A result of another problem does not fit. */
  lcpbench_problem* smaller = Dense(1, kA, kB, NULL, 0);
  CHECK_OK(lcpbench_solve(solver, smaller, NULL, result));
  CHECK_REFUSED(lcpbench_verify_result(problem, result, 1e-6, &verdict, sizeof verdict, NULL), "result has 1 forces");
  lcpbench_problem_free(smaller);
  lcpbench_result_free(result);
  lcpbench_solver_free(solver);
  lcpbench_problem_free(problem);
  lcpbench_result_free(NULL);
  lcpbench_solver_free(NULL);
  lcpbench_problem_free(NULL);
}

/* Programs of a later version have larger structs: members that this library does not know must be unused. */
static void LaterStructsAreUnderstood(void) {
  struct {
    lcpbench_solve_options options;
    double later;
  } options;
  struct {
    lcpbench_verdict verdict;
    char later[40];
  } verdict;
  lcpbench_problem* problem = KnownProblem();
  memset(&options, 0xff, sizeof options);
  memset(&verdict, 0xff, sizeof verdict);
  CHECK_OK(lcpbench_solve_options_init(&options.options, sizeof options));
  CHECK(options.options.size == sizeof options && options.later == 0);
  Answer answer = Solve("bpp", problem, &options.options, NULL);
  CHECK(answer.status == LCPBENCH_SOLVED);
  CHECK_OK(lcpbench_verify_result(problem, answer.result, 1e-9, &verdict.verdict, sizeof verdict, NULL));
  CHECK(verdict.verdict.passes == 1 && verdict.later[0] == 0 && verdict.later[39] == 0);
  options.later = 1;
  CHECK_REFUSED(lcpbench_solve(answer.solver, problem, &options.options, answer.result), "does not know");
  Free(&answer);
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
  lcpbench_result* result = NULL;
  lcpbench_verdict verdict;
  char name[32], words[64];
  snprintf(name, sizeof name, "no-%s", share->key);
  snprintf(words, sizeof words, "unknown option '%s'", name);
  const lcpbench_setting setting[1] = {{name, "1"}};
  if (lcpbench_solver_create(share->key, NULL, 0, &solver) || lcpbench_result_create(&result)) ++share->wrong;
  for (int i = 0; i < 50; ++i) {
    lcpbench_solver* none = NULL;
    if (lcpbench_solver_create(share->key, setting, 1, &none) == LCPBENCH_OK) ++share->wrong;
    share->wrong += lcpbench_solve(solver, share->problem, NULL, result) ||
                    lcpbench_verify_result(share->problem, result, 1e-9, &verdict, sizeof verdict, NULL) ||
                    !verdict.passes;
    if (strstr(lcpbench_last_error(), words) == NULL) ++share->wrong; /* this thread's mistake, not another's */
  }
  lcpbench_result_free(result);
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
  lcpbench_problem* plain = Dense(2, A, b, NULL, LCPBENCH_SYMMETRIC | LCPBENCH_POSITIVE_SEMIDEFINITE);
  lcpbench_problem* problem = NULL;
  lcpbench_friction_row row = {1, 0, 1, 0, 0};
  double w[2];
  Answer answer;
  CHECK_OK(lcpbench_problem_with_laws(plain, &row, 1, NULL, 0, &problem));
  answer = Solve("pgs", problem, NULL, w);
  CHECK(answer.status == LCPBENCH_SOLVED && answer.verdict.passes == 1);
  CHECK(fabs(answer.f[0] - 1) < 1e-9 && fabs(answer.f[1] + 1) < 1e-9 && fabs(w[1]) < 1e-9);
  Free(&answer);
  answer = Solve("dantzig", problem, NULL, w);
  CHECK(answer.status == LCPBENCH_UNSUPPORTED);
  Free(&answer);
  lcpbench_problem_free(problem);

  row.mu = 0.5;
  CHECK_OK(lcpbench_problem_with_laws(plain, &row, 1, NULL, 0, &problem));
  answer = Solve("pgs", problem, NULL, w);
  CHECK(answer.status == LCPBENCH_SOLVED && answer.verdict.passes == 1);
  CHECK(fabs(answer.f[1] + 0.5) < 1e-9 && fabs(w[1] - 0.5) < 1e-9);
  Free(&answer);
  answer = Solve("relaxation", problem, NULL, w); /* slip separates */
  CHECK(answer.status == LCPBENCH_SOLVED && answer.verdict.passes == 0 && answer.verdict.false_success == 0);
  CHECK(answer.verdict.model_rho >= 0 && answer.verdict.model_rho < 1e-9 && answer.verdict.separation > 1e-3);
  Free(&answer);
  lcpbench_problem_free(problem);

  row.mu = -1;
  problem = NULL;
  CHECK(lcpbench_problem_with_laws(plain, &row, 1, NULL, 0, &problem) == LCPBENCH_INVALID_ARGUMENT && problem == NULL);
  CHECK(strstr(lcpbench_last_error(), "friction: row 1: mu is -1, expected a finite number >= 0") != NULL);
  row.mu = NAN;
  CHECK(lcpbench_problem_with_laws(plain, &row, 1, NULL, 0, &problem) == LCPBENCH_INVALID_ARGUMENT && problem == NULL);
  CHECK(strstr(lcpbench_last_error(), "friction: row 1: mu is nan") != NULL);
  row.mu = 1;
  row.normal = 2;
  CHECK(lcpbench_problem_with_laws(plain, &row, 1, NULL, 0, &problem) == LCPBENCH_INVALID_ARGUMENT && problem == NULL);
  CHECK(strstr(lcpbench_last_error(), "friction: row 1: normal is 2, expected a unilateral row") != NULL);
  lcpbench_problem_free(plain);
}

int main(void) {
  CHECK(lcpbench_last_error()[0] == '\0');
  CHECK(strcmp(lcpbench_version(), LCPBENCH_EXPECTED_VERSION) == 0);
  SolvesAKnownProblem();
  FrictionIsSolvedAndJudged();
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
