/* The C interface from C99. */
#include <lcpbench.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "tests/c/check.h"

/* A dense A that is known to be symmetric positive semidefinite. */
static lcpbench_problem_data Dense(int64_t n, const double* A, const double* b) {
  const lcpbench_problem_data data = {.size = sizeof data,
                                      .form = LCPBENCH_DENSE,
                                      .rows = n,
                                      .symmetric = 1,
                                      .positive_semidefinite = 1,
                                      .values = A,
                                      .b = b};
  return data;
}

/* A ball between two walls, and one that lifts off: f = (4/3, 7/3, 0), w = (0, 0, 3), by hand. */
static const double kA[9] = {2, 1, 0, 1, 2, 0, 0, 0, 1};
static const double kB[3] = {-5, -6, 3};
static const double kF[3] = {4.0 / 3, 7.0 / 3, 0};
static const double kW[3] = {0, 0, 3};

static lcpbench_problem_data Known(void) { return Dense(3, kA, kB); }

/* Forces from elsewhere. */
static lcpbench_answer Claim(lcpbench_status status, int64_t n, const double* f, const double* ray) {
  const lcpbench_answer answer = {.size = sizeof answer, .status = status, .n = n, .f = f, .ray = ray};
  return answer;
}

static void SolvesAKnownProblem(void) {
  Solved known = Solve("dantzig", Known(), NULL);
  CHECK(known.answer.status == LCPBENCH_SOLVED && known.answer.n == 3 && known.answer.iterations >= 0);
  CHECK(isinf(known.answer.rho) && known.answer.force_min == 0 && known.answer.fallbacks == 0);
  CHECK_NEAR(known.answer.f, kF, 3, 4e-15);
  CHECK_NEAR(known.w, kW, 3, 4e-15);
  CHECK(known.verdict.passes == 1 && known.verdict.best_tier == 1e-9 && known.verdict.false_success == 0);
  CHECK(known.verdict.requested == 1e-6 && known.verdict.has_ray == 0 && known.verdict.reason[0] == '\0');
  CHECK(known.verdict.energy_bound >= 0 && known.verdict.energy_bound < 1e-14);
  CHECK(strcmp(lcpbench_status_key(known.answer.status), "solved") == 0);
}

/* Two rows that share one load in any way: equal shares have the least norm. */
static void LeastNormSharesEqually(void) {
  const double A[4] = {1, 1, 1, 1}, b[2] = {-2, -2}, equal[2] = {1, 1};
  const lcpbench_solve_options options = {.size = sizeof options, .rank_tolerance = 1e-10};
  Solved shared = Solve("dantzig", Dense(2, A, b), &options);
  CHECK(shared.answer.status == LCPBENCH_SOLVED && shared.verdict.passes == 1 && shared.answer.nullity == 1);
  CHECK_NEAR(shared.answer.f, equal, 2, 1e-12);
}

/* A nonsymmetric A tells rows from columns: w = A f + b at f = (1, 2). */
static void LayoutsAndFormsAgree(void) {
  const double by_columns[4] = {4, 3, -1, 5}, by_rows[4] = {4, -1, 3, 5};
  const double b[2] = {7, 11}, f[2] = {1, 2}, expected[2] = {4 - 2 + 7, 3 + 10 + 11};
  const int32_t starts[3] = {0, 2, 4};
  const int32_t indices[4] = {0, 1, 1, 0}; /* the second column (or row) is not sorted */
  const double columns[4] = {4, 3, 5, -1}, rows[4] = {4, -1, 5, 3};
  const double* const values[4] = {by_columns, by_rows, columns, rows};
  for (int k = 0; k < 4; ++k) {
    const lcpbench_problem_data data = {.form = k < 2 ? LCPBENCH_DENSE : LCPBENCH_SPARSE,
                                        .by_rows = k % 2,
                                        .rows = 2,
                                        .values = values[k],
                                        .entries = 4,
                                        .starts = starts,
                                        .indices = indices,
                                        .b = b};
    lcpbench_problem* problem = Create(data);
    const lcpbench_answer answer = Claim(LCPBENCH_NOT_RUN, 2, f, NULL);
    double w[2] = {0, 0};
    CHECK(Judge(problem, &answer, 1e-9, w).energy_bound == -1);
    CHECK(w[0] == expected[0] && w[1] == expected[1]);
  }
}

/* w_1 + w_2 = b_1 + b_2 = -2 whatever f is: A y = 0 and b.y < 0 for y = (1, 1). */
static void AnInfeasibleProblemHasARay(void) {
  const double A[4] = {1, -1, -1, 1}, b[2] = {-1, -1};
  Solved none = Solve("lemke", Dense(2, A, b), NULL);
  CHECK(none.answer.status == LCPBENCH_INFEASIBLE);
  CHECK(none.verdict.passes == 0 && none.verdict.false_infeasible == 0);
  CHECK(none.verdict.has_ray == 1 && none.verdict.ray_accepted == 1 && none.verdict.ray_b_dot_y < 0);
  CHECK(none.answer.n == 2 && none.answer.ray[0] > 0 && none.answer.ray[0] == none.answer.ray[1]);
  CHECK(none.verdict.ray_proved == 1 && isinf(none.verdict.ray_force_min));
  /* A ray that proves nothing is refused with its reason. */
  const double f[2] = {0, 0}, wrong[2] = {1, 2};
  const lcpbench_answer claim = Claim(LCPBENCH_INFEASIBLE, 2, f, wrong);
  const lcpbench_verdict verdict = Judge(none.problem, &claim, 1e-6, NULL);
  CHECK(verdict.has_ray == 1 && verdict.ray_accepted == 0 && strlen(verdict.ray_reason) > 0);
}

static void AWrongAnswerIsFound(void) {
  lcpbench_problem* problem = Create(Known());
  double f[3] = {4.0 / 3, 7.0 / 3, 1e-3}, w[3];
  lcpbench_answer claim = Claim(LCPBENCH_SOLVED, 3, f, NULL);
  lcpbench_verdict verdict = Judge(problem, &claim, 1e-9, w);
  CHECK(verdict.passes == 0 && verdict.false_success == 1 && verdict.best_tier == 1e-3);
  CHECK(strstr(verdict.reason, "rho") != NULL);
  /* By hand: D = (2, 2, 1), r = (0, 0, 1e-3), D^-1/2 b = (-5, -6, 0) / sqrt 2 and 3. */
  CHECK(fabs(verdict.rho - 1e-3 / sqrt(12.5 + 18 + 9)) < 1e-15);
  CHECK(fabs(verdict.complementarity - 1e-3 * 3.001) < 1e-15);
  CHECK(fabs(w[2] - 3.001) < 1e-15);
  f[0] = -1;
  claim.status = LCPBENCH_ITERATION_LIMIT;
  verdict = Judge(problem, &claim, 1e-9, NULL);
  CHECK(verdict.passes == 0 && verdict.false_success == 0 && verdict.best_tier == 0);
  CHECK(verdict.primal_infeasibility == 1);
  f[0] = NAN;
  claim.status = LCPBENCH_SOLVED;
  verdict = Judge(problem, &claim, 1e-3, w);
  CHECK(verdict.passes == 0 && verdict.false_success == 1 && isinf(verdict.rho) && isnan(w[0]));
}

/* Own solvers must solve the known problem, and problems of no rows: of a dense matrix, a sparse one, factors with and
   without bodies, in both layouts, and two bodies. Other projects' may fail, and some claim what they do not reach; who
   passes is right. */
static void EverySolverSolvesWhatItMust(void) {
  const lcpbench_solve_options options = {.size = sizeof options, .tolerance = 1e-6};
  const double inverse_mass[3] = {1, 1, 1};
  lcpbench_problem_data empty[9];
  memset(empty, 0, sizeof empty);
  for (int k = 0; k < 9; ++k) {
    empty[k].form = k < 6 ? k / 2 + 1 : k < 8 ? LCPBENCH_FACTORS : LCPBENCH_TWO_BODIES;
    empty[k].by_rows = k % 2;
    empty[k].columns = k < 6 ? 0 : 3;
    empty[k].inverse_mass = inverse_mass;
  }
  int solved = 0, has_auto = 0;
  CHECK(lcpbench_solver_count() >= 14);
  for (size_t i = 0; i < lcpbench_solver_count(); ++i) {
    lcpbench_solver_info info = {.size = sizeof info};
    CHECK_OK(lcpbench_solver_describe(i, &info));
    CHECK(strlen(info.method) > 0 && strlen(info.licence) > 0);
    has_auto |= strcmp(info.key, "auto") == 0;
    if (!info.available) {
      lcpbench_solver* none = NULL;
      CHECK_REFUSED(lcpbench_solver_create(info.key, NULL, &none), "not in this build");
      CHECK(none == NULL);
      continue;
    }
    Solved known = Solve(info.key, Known(), &options);
    // Methods of auto alone do not take every form.
    const int is_right = known.answer.status == LCPBENCH_SOLVED && known.verdict.passes == 1;
    if (!info.is_peer) CHECK(is_right || known.answer.status == LCPBENCH_UNSUPPORTED);
    if (known.verdict.passes) {
      ++solved;
      CHECK_NEAR(known.answer.f, kF, 3, 4e-5);
      CHECK_NEAR(known.w, kW, 3, 3e-5);
    } else {
      printf("%s does not pass, and says %s\n", info.key, lcpbench_status_key(known.answer.status));
    }
    for (int k = 0; k < 9 && !info.is_peer; ++k) {
      Solved none = Solve(info.key, empty[k], NULL);
      CHECK(none.answer.status == LCPBENCH_SOLVED && none.answer.n == 0 && none.answer.f == NULL);
      CHECK(none.verdict.passes == 1);
    }
    FreeMade(); /* workers of peers, too */
  }
  CHECK(has_auto && solved >= 10);
}

static void OptionsReachTheSolver(void) {
  enum { kRows = 40 };
  double A[kRows * kRows], b[kRows], expected[kRows];
  memset(A, 0, sizeof A);
  for (int i = 0; i < kRows; ++i) {
    A[i * kRows + i] = 2;
    if (i + 1 < kRows) A[i * kRows + i + 1] = A[(i + 1) * kRows + i] = -1;
    b[i] = -1;                                 /* all rows are active: a long chain, which Gauss-Seidel creeps along */
    expected[i] = 0.5 * (i + 1) * (kRows - i); /* -f'' = 1 with f = 0 at both ends, in finite differences */
  }
  const lcpbench_problem_data chain = Dense(kRows, A, b);
  const lcpbench_solve_options plain = {.size = sizeof plain};
  lcpbench_solve_options options = plain;
  options.max_iterations = 3;
  Solved few = Solve("pgs", chain, &options);
  CHECK(few.answer.status == LCPBENCH_ITERATION_LIMIT && few.answer.iterations == 3);

  options = plain;
  options.time_limit_s = 1e-9;
  Solved late = Solve("pgs", chain, &options);
  CHECK(late.answer.status == LCPBENCH_TIME_LIMIT);

  Solved cold = Solve("pgs", chain, &plain);
  CHECK(cold.answer.status == LCPBENCH_SOLVED && cold.answer.n == kRows);
  for (int i = 0; i < kRows; ++i) CHECK(fabs(cold.answer.f[i] - expected[i]) < 1e-4);

  /* A solver's answer may be the start of its next solve. */
  options = plain;
  options.initial_f = cold.answer.f;
  options.initial_f_size = cold.answer.n;
  lcpbench_answer next = {.size = sizeof next};
  CHECK_OK(lcpbench_solve(cold.solver, cold.problem, &options, &next));
  CHECK(next.status == LCPBENCH_SOLVED && next.iterations * 10 < cold.answer.iterations);

  /* Settings reach the method: 1.8 is close to the best relaxation of this chain. */
  lcpbench_solver* relaxed = CreateSolver("pgs", "relaxation=1.8 form=assembled");
  CHECK_OK(lcpbench_solver_prepare(relaxed, cold.problem));
  CHECK_OK(lcpbench_solve(relaxed, cold.problem, &plain, &next));
  CHECK(next.status == LCPBENCH_SOLVED && next.iterations * 2 < cold.answer.iterations);
}

static void WrongProblemsAreRefused(void) {
  lcpbench_problem* problem = NULL;
  double A[9] = {2, 1, 0, 1, 2, 0, 0, 0, 1}, b[3] = {-5, -6, 3}, values[5] = {2, 1, 1, 2, 1};
  int32_t starts[4] = {0, 2, 4, 5}, indices[5] = {0, 1, 0, 1, 2};
  double inverse_mass[3] = {1, 2, 1};
  uint8_t kinds[3] = {0, 1, 0};
  lcpbench_friction_row friction = {.row = 2, .normal = 0, .mu = 1};
  lcpbench_bounded_row bounded = {.row = 0, .lower = -2, .upper = 2};
  lcpbench_problem_data data = Dense(3, A, b);
  CHECK_REFUSED(lcpbench_problem_create(NULL, &problem), "data is NULL");
  CHECK_REFUSED(lcpbench_problem_create(&data, NULL), "problem is NULL");
#define CALL() lcpbench_problem_create(&data, &problem)
  data.kinds = kinds;
  REFUSED(data.size, 0, "size is 0, expected sizeof(lcpbench_problem_data)");
  REFUSED(data.form, 0, "form is 0");
  REFUSED(data.form, 5, "form is 5");
  REFUSED(data.rows, -1, "rows is -1");
  REFUSED(data.rows, (int64_t)1 << 31, "rows is 2147483648");
  REFUSED(data.values, NULL, "values is NULL");
  REFUSED(data.b, NULL, "b is NULL");
  REFUSED(kinds[1], 2, "kinds[1] is 2");
  REFUSED(A[3], NAN, "A: entry (0, 1) is nan");
  REFUSED(A[3], 5, "A is not symmetric");
  REFUSED(b[2], -INFINITY, "b[2] is -inf");
  data.by_rows = 1;
  REFUSED(A[3], NAN, "A: entry (1, 0) is nan");

  data.kinds = NULL;
  data.friction = &friction;
  data.friction_count = 1;
  REFUSED(friction.mu, -1, "friction: row 2: mu is -1, expected a finite number >= 0");
  REFUSED(friction.normal, 3, "friction: row 2: normal is 3, expected a unilateral row");
  REFUSED(friction.slip, 256, "friction[0].slip is 256, expected -1, 0 or 1");
  REFUSED(data.friction, NULL, "friction is NULL");
  REFUSED(data.friction_count, -1, "friction_count is -1");
  data.friction_count = 0;
  data.bounded = &bounded;
  data.bounded_count = 1;
  REFUSED(bounded.lower, 3, "bounded: row 0: lower is 3 and upper 2");
  REFUSED(data.bounded, NULL, "bounded is NULL");
  REFUSED(data.bounded_count, -1, "bounded_count is -1");
  data.bounded_count = 0;

  data.form = LCPBENCH_SPARSE;
  data.values = values;
  data.starts = starts;
  data.indices = indices;
  data.entries = 5;
  REFUSED(data.entries, 4, "starts[3] is 5, expected entries = 4");
  REFUSED(data.entries, -1, "entries is -1");
  REFUSED(data.starts, NULL, "starts is NULL");
  REFUSED(data.indices, NULL, "indices is NULL");
  REFUSED(data.values, NULL, "values is NULL");
  REFUSED(starts[0], 1, "starts[0] is 1");
  REFUSED(starts[1], 5, "starts[2] is 4, less than the 5 before it");
  REFUSED(indices[4], -1, "indices[4] is -1");
  REFUSED(indices[4], 3, "indices[4] is 3");
  REFUSED(indices[1], 0, "entry (0, 0) of A is stored twice");
  REFUSED(values[2], INFINITY, "values[2] is inf");

  data.form = LCPBENCH_FACTORS;
  data.columns = 3;
  data.inverse_mass = inverse_mass;
  REFUSED(inverse_mass[1], -2, "inverse_mass[1] is -2");
  REFUSED(data.inverse_mass, NULL, "inverse_mass is NULL");
  REFUSED(data.columns, -3, "columns is -3");
  data.rows = data.columns = data.entries = 0;
  REFUSED(data.columns_per_body, 5, "columns_per_body is 5, expected 3");

  data.form = LCPBENCH_TWO_BODIES;
  data.bodies = 1;
  REFUSED(data.columns_per_body, 5, "columns per body must be 3 or 6, found 5");
  REFUSED(data.bodies, INT32_MAX, "bodies * columns_per_body is 6442450941");
  REFUSED(data.bodies, -1, "bodies is -1");
  REFUSED(data.inverse_mass, NULL, "inverse_mass is NULL");
  REFUSED(data.bodies, (int64_t)1 << 31, "bodies is 2147483648");
  CHECK(problem == NULL);
#undef CALL
  Create(data); /* nothing else was wrong */
}

static void WrongSolversAreRefused(void) {
  lcpbench_solver* solver = NULL;
  const char *key = "pgs", *settings = "relaxation=1";
  CHECK_REFUSED(lcpbench_solver_create(key, NULL, NULL), "solver is NULL");
#define CALL() lcpbench_solver_create(key, settings, &solver)
  REFUSED(key, "simplex", "lcpbench_solver_create: unknown solver 'simplex'");
  REFUSED(key, NULL, "key is NULL");
  REFUSED(settings, "colour=red", "unknown option 'colour'");
  REFUSED(settings, "relaxation=2.5", "relaxation");
  REFUSED(settings, "relaxation=1 relaxation=1.5", "settings has 'relaxation=1.5', but its name is set before");
  REFUSED(settings, "relaxation", "settings has 'relaxation', expected NAME=VALUE");
#undef CALL
  CHECK(solver == NULL);
  CreateSolver(key, settings);

  lcpbench_solver_info info = {.size = sizeof info};
  CHECK_REFUSED(lcpbench_solver_describe(lcpbench_solver_count(), &info), "index is");
  CHECK_REFUSED(lcpbench_solver_describe(0, NULL), "info is NULL");
  info.size = 3;
  CHECK_REFUSED(lcpbench_solver_describe(0, &info), "size is 3");
  CHECK_REFUSED(lcpbench_limit_library_threads(0, NULL), "threads is 0");
  CHECK(strcmp(lcpbench_status_key(99), "unknown") == 0);
}

static void WrongSolvesAndAnswersAreRefused(void) {
  double f[3] = {0, 0, 0};
  lcpbench_problem* problem = Create(Known());
  lcpbench_solver* solver = CreateSolver("pgs", NULL);
  lcpbench_answer answer = {.size = sizeof answer};
  lcpbench_solve_options options = {.size = sizeof options, .initial_f = f, .initial_f_size = 3};
  CHECK_REFUSED(lcpbench_solve(NULL, problem, NULL, &answer), "solver is NULL");
  CHECK_REFUSED(lcpbench_solve(solver, NULL, NULL, &answer), "problem is NULL");
  CHECK_REFUSED(lcpbench_solve(solver, problem, NULL, NULL), "answer is NULL");
#define CALL() lcpbench_solve(solver, problem, &options, &answer)
  CHECK_OK(CALL());
  const lcpbench_answer before = answer;
  REFUSED(answer.size, 8, "size is 8, expected sizeof(lcpbench_answer)");
  REFUSED(options.size, 8, "size is 8, expected sizeof(lcpbench_solve_options)");
  REFUSED(options.tolerance, -1, "tolerance");
  REFUSED(options.tolerance, NAN, "tolerance");
  REFUSED(options.time_limit_s, -1, "time limit");
  REFUSED(options.max_iterations, -1, "iteration limit");
  REFUSED(options.rank_tolerance, 2, "rank_tolerance is 2");
  REFUSED(options.rank_tolerance, -1, "rank_tolerance is -1");
  REFUSED(options.initial_f_size, 2, "initial_f_size");
  REFUSED(options.initial_f, NULL, "initial_f is NULL");
  REFUSED(f[1], NAN, "initial f must be finite");
#undef CALL
  CHECK(memcmp(&answer, &before, sizeof answer) == 0); /* none of these wrote to the answer, or to what it points to */
  CHECK_NEAR(answer.f, kF, 3, 1e-8);

  lcpbench_verdict verdict = {.size = sizeof verdict};
  double tolerance = 1e-6;
  answer = Claim(LCPBENCH_NOT_RUN, 3, f, NULL);
#define CALL() lcpbench_verify(problem, &answer, tolerance, &verdict, NULL)
  REFUSED(answer.n, 2, "answer.n is 2, expected the problem's n = 3");
  REFUSED(answer.f, NULL, "answer.f is NULL");
  REFUSED(answer.status, 9, "answer.status is 9");
  REFUSED(answer.size, 0, "size is 0, expected sizeof(lcpbench_answer)");
  REFUSED(tolerance, 2, "tolerance is 2");
  REFUSED(verdict.size, 16, "size is 16");
#undef CALL
  CHECK_REFUSED(lcpbench_verify(NULL, &answer, tolerance, &verdict, NULL), "problem is NULL");
  CHECK_REFUSED(lcpbench_verify(problem, NULL, tolerance, &verdict, NULL), "answer is NULL");
  CHECK_REFUSED(lcpbench_verify(problem, &answer, tolerance, NULL, NULL), "verdict is NULL");
}

/* Members that this library does not know must be unused. */
static void LaterStructsAreUnderstood(void) {
  LATER(lcpbench_problem_data) data = {.known = Known()};
  LATER(lcpbench_solve_options) options = {.known = {.size = sizeof options}};
  LATER(lcpbench_answer) answer = {.known = {.size = sizeof answer}};
  LATER(lcpbench_verdict) verdict = {.known = {.size = sizeof verdict}};
  lcpbench_problem* problem = NULL;
  lcpbench_solver* solver = CreateSolver("bpp", NULL);
  data.known.size = sizeof data;
#define CALL() lcpbench_problem_create(&data.known, &problem)
  REFUSED(data.later, 1, "data has members that this version of the library does not know");
  CHECK_OK(CALL());
#undef CALL
#define CALL() lcpbench_solve(solver, problem, &options.known, &answer.known)
  REFUSED(options.later, 1, "options has members that");
  REFUSED(answer.later, 1, "answer has members that");
  CHECK_OK(CALL());
#undef CALL
  CHECK(answer.known.status == LCPBENCH_SOLVED && answer.known.size == sizeof answer && answer.later == 0);
  CHECK_OK(lcpbench_verify(problem, &answer.known, 1e-9, &verdict.known, NULL));
  CHECK(verdict.known.passes == 1 && verdict.known.size == sizeof verdict && verdict.later == 0);
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
  lcpbench_verdict verdict = {.size = sizeof verdict};
  char setting[32], words[64];
  snprintf(setting, sizeof setting, "no-%s=1", share->key);
  snprintf(words, sizeof words, "unknown option 'no-%s'", share->key);
  if (lcpbench_solver_create(share->key, NULL, &solver)) ++share->wrong;
  for (int i = 0; i < 50; ++i) {
    lcpbench_solver* none = NULL;
    if (lcpbench_solver_create(share->key, setting, &none) == LCPBENCH_OK) ++share->wrong;
    share->wrong += lcpbench_solve(solver, share->problem, NULL, &answer) ||
                    lcpbench_verify(share->problem, &answer, 1e-9, &verdict, NULL) || !verdict.passes;
    if (strstr(lcpbench_last_error(), words) == NULL) ++share->wrong; /* this thread's mistake, not another's */
  }
  lcpbench_solver_free(solver);
  return NULL;
}

static void ThreadsShareAProblemAndKeepTheirErrors(void) {
  lcpbench_problem* problem = Create(Known());
  Share shares[4] = {{"auto", problem, 0}, {"dantzig", problem, 0}, {"lemke", problem, 0}, {"bpp", problem, 0}};
  pthread_t threads[4];
  for (int i = 0; i < 4; ++i) CHECK(pthread_create(&threads[i], NULL, SolveAndFail, &shares[i]) == 0);
  for (int i = 0; i < 4; ++i) {
    CHECK(pthread_join(threads[i], NULL) == 0);
    CHECK(shares[i].wrong == 0);
  }
}

/* A block on the ground, pushed: sticks for mu = 1 (f_t = -1), slips for mu = 1/2 (w_t = 1/2). */
static void FrictionIsSolvedAndJudged(void) {
  const double A[4] = {1, 0, 0, 1}, b[2] = {-1, 1};
  const double sticking[2][2] = {{1, -1}, {0, 0}}, slipping[2][2] = {{1, -0.5}, {0, 0.5}}; /* f and w */
  lcpbench_friction_row row = {.row = 1, .normal = 0, .mu = 1};
  lcpbench_problem_data data = Dense(2, A, b);
  data.friction = &row;
  data.friction_count = 1;
  for (row.mu = 1; row.mu >= 0.5; row.mu /= 2) {
    Solved solved = Solve("pgs", data, NULL);
    CHECK(solved.answer.status == LCPBENCH_SOLVED && solved.verdict.passes == 1);
    CHECK_NEAR(solved.answer.f, row.mu == 1 ? sticking[0] : slipping[0], 2, 1e-9);
    CHECK_NEAR(solved.w, row.mu == 1 ? sticking[1] : slipping[1], 2, 1e-9);
  }
  row.mu = 0.5;
  Solved refused = Solve("dantzig", data, NULL);
  CHECK(refused.answer.status == LCPBENCH_UNSUPPORTED);
  Solved relaxed = Solve("relaxation", data, NULL); /* slip separates */
  const lcpbench_verdict* const verdict = &relaxed.verdict;
  CHECK(relaxed.answer.status == LCPBENCH_SOLVED && relaxed.answer.relaxed == 1);
  CHECK(verdict->passes == 0 && verdict->false_success == 0);
  CHECK(verdict->model_rho >= 0 && verdict->model_rho < 1e-9 && verdict->separation > 1e-3);
}

/* A ball that pushes with 5 N against what yields at 2 N. */
static void BoundsAreSolved(void) {
  const double A[1] = {1}, b[1] = {-5};
  const lcpbench_bounded_row row = {.row = 0, .lower = -2, .upper = 2};
  lcpbench_problem_data data = Dense(1, A, b);
  data.bounded = &row;
  data.bounded_count = 1;
  lcpbench_solve_options options = {.size = sizeof options};
  for (int wants_least_norm = 0; wants_least_norm < 2; ++wants_least_norm) {
    options.rank_tolerance = wants_least_norm ? 1e-10 : 0;
    Solved solved = Solve("auto", data, &options);
    CHECK(solved.answer.status == LCPBENCH_SOLVED && solved.verdict.passes == 1 && solved.answer.nullity == -1);
    CHECK(fabs(solved.answer.f[0] - 2) < 1e-12 && fabs(solved.w[0] + 3) < 1e-12);
    const int has_detail = strstr(solved.answer.detail, "not of least norm: least norm is for plain problems") != NULL;
    CHECK(has_detail == wants_least_norm);
  }
}

int main(void) {
  CHECK(lcpbench_last_error()[0] == '\0');
  CHECK(strcmp(lcpbench_version(), LCPBENCH_EXPECTED_VERSION) == 0);
  SolvesAKnownProblem();
  FrictionIsSolvedAndJudged();
  BoundsAreSolved();
  LeastNormSharesEqually();
  LayoutsAndFormsAgree();
  AnInfeasibleProblemHasARay();
  AWrongAnswerIsFound();
  EverySolverSolvesWhatItMust();
  OptionsReachTheSolver();
  WrongProblemsAreRefused();
  WrongSolversAreRefused();
  WrongSolvesAndAnswersAreRefused();
  LaterStructsAreUnderstood();
  ThreadsShareAProblemAndKeepTheirErrors();
  return CountFailures();
}
