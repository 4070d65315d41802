/* The step interface from C99: against the solver "auto" on the same problem, judged by the verifier. */
#include <lcpbench.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/c/check.h"

enum { kMostRows = 60, kMostBodies = 64, kMostNumbers = 12 * kMostRows };

/* An engine's arrays. */
typedef struct Arrays {
  int32_t body[2 * kMostRows];
  double J[kMostNumbers];
  float J_single[kMostNumbers];
  double b[kMostRows];
  uint8_t kinds[kMostRows];
  double inverse_mass[6 * kMostBodies];
} Arrays;

static uint64_t state = 1;

/* In [-1, 1), the same everywhere. */
static double Random(void) {
  state = state * 6364136223846793005U + 1442695040888963407U;
  return (double)(int64_t)state / 9223372036854775808.0;
}

/* n rows, each on a body of its own and on the ground or another body: A is positive definite, so that f is unique.
   J is exact in single precision. */
static lcpbench_step_rows MakeRows(Arrays* arrays, int n, int p, int joints, int single) {
  lcpbench_step_rows rows = {.size = sizeof rows};
  memset(arrays, 0, sizeof *arrays);
  rows.rows = n;
  rows.bodies = n + 2;
  rows.columns_per_body = p;
  for (int i = 0; i < n; ++i) {
    const int other = (int)floor((Random() + 1) * 0.5 * (n + 2)); /* n: a body that cannot move; n + 1: the ground */
    const int32_t second = other == i || other == n + 1 ? -1 : other;
    const int swapped = Random() < 0;
    arrays->body[2 * i + swapped] = i;
    arrays->body[2 * i + 1 - swapped] = second;
    for (int c = 0; c < 2 * p; ++c) {
      arrays->J_single[2 * p * i + c] = (float)Random();
      arrays->J[2 * p * i + c] = arrays->J_single[2 * p * i + c];
    }
    for (int c = 0; c < p; ++c) arrays->inverse_mass[p * i + c] = 1.5 + Random();
    arrays->b[i] = Random();
    arrays->kinds[i] = joints && i % 3 == 1 ? LCPBENCH_BILATERAL : LCPBENCH_UNILATERAL;
  }
  rows.body = arrays->body;
  if (single) {
    rows.J_single = arrays->J_single;
    memset(arrays->J, 0xff, sizeof arrays->J); /* not to be read */
  } else {
    rows.J = arrays->J;
  }
  rows.b = arrays->b;
  rows.kinds = joints ? arrays->kinds : NULL;
  rows.inverse_mass = arrays->inverse_mass;
  return rows;
}

/* The same problem from compressed rows. */
static lcpbench_problem* ProblemOf(const lcpbench_step_rows* rows) {
  const int p = rows->columns_per_body;
  const int64_t n = rows->rows;
  int32_t starts[kMostRows + 1], indices[kMostNumbers];
  double values[kMostNumbers];
  int32_t entries = 0;
  starts[0] = 0;
  for (int64_t i = 0; i < n; ++i) {
    for (int64_t side = 0; side < 2; ++side) {
      const int32_t body = rows->body[2 * i + side];
      for (int c = 0; c < p && body >= 0; ++c) {
        const int64_t at = (2 * i + side) * p + c;
        indices[entries] = body * p + c;
        values[entries++] = rows->J != NULL ? rows->J[at] : rows->J_single[at];
      }
    }
    starts[i + 1] = entries;
  }
  const lcpbench_problem_data data = {.size = sizeof data,
                                      .form = LCPBENCH_FACTORS,
                                      .layout = LCPBENCH_ROW_MAJOR,
                                      .rows = n,
                                      .columns = rows->bodies * p,
                                      .columns_per_body = p,
                                      .values = values,
                                      .entries = entries,
                                      .starts = starts,
                                      .indices = indices,
                                      .inverse_mass = rows->inverse_mass,
                                      .b = rows->b,
                                      .kinds = rows->kinds};
  lcpbench_problem* problem = NULL;
  CHECK_OK(lcpbench_problem_create(&data, &problem));
  return problem;
}

/* Judges forces at 1e-9. */
static lcpbench_verdict Judge(const lcpbench_problem* problem, const double* f, int64_t n, lcpbench_status claim,
                              double* w) {
  const lcpbench_answer answer = {.size = sizeof answer, .status = claim, .n = n, .f = f};
  lcpbench_verdict verdict;
  CHECK_OK(lcpbench_verify(problem, &answer, 1e-9, &verdict, sizeof verdict, w));
  return verdict;
}

static lcpbench_step* MakeStep(void) {
  lcpbench_step* step = NULL;
  CHECK_OK(lcpbench_step_create(NULL, &step));
  CHECK_OK(lcpbench_step_reserve(step, kMostRows, kMostBodies));
  return step;
}

/* Solves by `step`, verifies, and compares with "auto". */
static void ExpectSolved(lcpbench_step* step, const lcpbench_step_rows* rows) {
  const int64_t n = rows->rows;
  double f[kMostRows], w[kMostRows], again[kMostRows], start[kMostRows], expected_w[kMostRows];
  lcpbench_step_answer answer;
  memset(f, 0xff, sizeof f);
  memset(w, 0xff, sizeof w);
  memset(&answer, 0xff, sizeof answer);
  CHECK_OK(lcpbench_step_solve(step, rows, NULL, f, w, &answer, sizeof answer));
  CHECK(answer.status == LCPBENCH_SOLVED && answer.infeasible_proved == 0 && answer.force_min == 0 &&
        answer.iterations >= 0);

  lcpbench_problem* problem = ProblemOf(rows);
  const lcpbench_verdict verdict = Judge(problem, f, n, answer.status, expected_w);
  CHECK(verdict.passes == 1 && verdict.false_success == 0);
  CHECK(verdict.rho <= answer.rho + 1e-13 && answer.rho <= 1e-9);

  lcpbench_solver* solver = NULL;
  lcpbench_answer expected = {.size = sizeof expected};
  CHECK_OK(lcpbench_solver_create("auto", NULL, 0, &solver));
  CHECK_OK(lcpbench_solve(solver, problem, NULL, &expected));
  CHECK(expected.n == n);
  for (int64_t i = 0; i < n; ++i) {
    CHECK(fabs(f[i] - expected.f[i]) < 1e-9 * (1 + fabs(expected.f[i])));
    CHECK(fabs(w[i] - expected_w[i]) < 1e-12 * (1 + fabs(f[i])));
    start[i] = f[i];
  }

  /* From the answer the answer in no more pivots, also without w. */
  const int64_t cold = answer.iterations;
  CHECK_OK(lcpbench_step_solve(step, rows, start, again, NULL, &answer, sizeof answer));
  CHECK(answer.status == LCPBENCH_SOLVED && answer.iterations <= (cold > 1 ? cold : 1));
  for (int64_t i = 0; i < n; ++i) CHECK(fabs(again[i] - f[i]) < 1e-9 * (1 + fabs(f[i])));
  lcpbench_solver_free(solver);
  lcpbench_problem_free(problem);
}

static void StepsAreSolvedAsTheirProblems(void) {
  static const int sizes[] = {1, 2, 3, 6, 12, 17, 40, kMostRows};
  static Arrays arrays;
  lcpbench_step* step = MakeStep();
  for (int p = 3; p <= 6; p += 3) {
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; ++k) {
      for (int form = 0; form < 4; ++form) {
        for (int times = 0; times < 5; ++times) {
          const lcpbench_step_rows rows = MakeRows(&arrays, sizes[k], p, form & 1, form >> 1);
          ExpectSolved(step, &rows);
        }
      }
    }
  }
  int64_t fallbacks = -1;
  CHECK_OK(lcpbench_step_fallbacks(step, &fallbacks));
  CHECK(fallbacks == 0);
  lcpbench_step_free(step);
}

/* A ball of 2 kg on the ground, and upon it one of 1 kg that a joint holds against a wind of 3 N: by hand. */
static void AKnownStep(void) {
  const int32_t body[6] = {0, -1, 1, 0, 1, -1};
  const double J[18] = {0, 1, 0, 9, 9, 9, 0, 1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 0}; /* nines act on nothing */
  const double b[3] = {-10, 0, -3}, inverse_mass[6] = {0.5, 0.5, 1, 1, 1, 1};
  const uint8_t kinds[3] = {LCPBENCH_UNILATERAL, LCPBENCH_UNILATERAL, LCPBENCH_BILATERAL};
  const lcpbench_step_rows rows = {.size = sizeof rows, /* columns_per_body 0: in the plane */
                                   .rows = 3,
                                   .bodies = 2,
                                   .body = body,
                                   .J = J,
                                   .b = b,
                                   .kinds = kinds,
                                   .inverse_mass = inverse_mass};
  double f[3], w[3];
  lcpbench_step_answer answer;
  lcpbench_step* step = NULL; /* without a reservation */
  CHECK_OK(lcpbench_step_create(NULL, &step));
  CHECK_OK(lcpbench_step_solve(step, &rows, NULL, f, w, &answer, sizeof answer));
  /* The ground carries both, the lower ball the upper one. */
  CHECK(answer.status == LCPBENCH_SOLVED && answer.rho < 1e-15);
  CHECK(fabs(f[0] - 30) < 1e-12 && fabs(f[1] - 10) < 1e-12 && fabs(f[2] - 3) < 1e-12);
  for (int i = 0; i < 3; ++i) CHECK(fabs(w[i]) < 1e-13);
  lcpbench_step_free(step);
}

/* Two joints of one body in the plane; b = (1, -1). */
static lcpbench_step_answer SolveTwoJoints(lcpbench_step* step, double first_x, double first_y, double second_x,
                                           double second_y) {
  const int32_t body[4] = {0, -1, 0, -1};
  const double J[12] = {first_x, first_y, 0, 0, 0, 0, second_x, second_y, 0, 0, 0, 0};
  const double b[2] = {1, -1}, inverse_mass[3] = {1, 1, 1};
  const uint8_t kinds[2] = {LCPBENCH_BILATERAL, LCPBENCH_BILATERAL};
  const lcpbench_step_rows rows = {.size = sizeof rows,
                                   .rows = 2,
                                   .bodies = 1,
                                   .body = body,
                                   .J = J,
                                   .b = b,
                                   .kinds = kinds,
                                   .inverse_mass = inverse_mass};
  double f[2] = {NAN, NAN};
  lcpbench_step_answer answer;
  CHECK_OK(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer));
  CHECK(isfinite(f[0]) && isfinite(f[1]));
  return answer;
}

/* Joints that contradict each other: an answer that says how surely, and the object goes on. */
static void AnImpossibleStepIsNotSolved(void) {
  static Arrays arrays;
  lcpbench_step* step = MakeStep();
  lcpbench_step_answer answer = SolveTwoJoints(step, 1, 0, 1, 0);
  CHECK(answer.status == LCPBENCH_INFEASIBLE && answer.infeasible_proved == 1 && isinf(answer.force_min));
  int64_t fallbacks = 0;
  CHECK_OK(lcpbench_step_fallbacks(step, &fallbacks));
  CHECK(fallbacks == 1);
  /* The second joint is three times the first, but for the last digits. */
  answer = SolveTwoJoints(step, 0.3, 0.1, 0.9, 0.3);
  CHECK(answer.status == LCPBENCH_INFEASIBLE && answer.infeasible_proved == 0);
  CHECK(answer.force_min > 1e12 && isfinite(answer.force_min));
  /* From an angle of 1e-13 on there is a solution. */
  for (double angle = 1e-12; angle < 0.1; angle *= 7) {
    answer = SolveTwoJoints(step, 0.6, 0.8, 0.6 - 0.8 * angle, 0.8 + 0.6 * angle);
    CHECK(answer.status != LCPBENCH_INFEASIBLE && answer.infeasible_proved == 0 && answer.force_min == 0);
  }
  lcpbench_step_rows rows = MakeRows(&arrays, 9, 3, 1, 0);
  ExpectSolved(step, &rows);
  lcpbench_step_free(step);
}

static void ABatchIsItsProblems(void) {
  enum { kProblems = 12 };
  static Arrays arrays;
  lcpbench_step* step = MakeStep();
  for (int form = 0; form < 8; ++form) {
    const int p = form & 4 ? 6 : 3;
    lcpbench_step_rows rows = MakeRows(&arrays, kMostRows, p, form & 1, form >> 1 & 1);
    int32_t starts[kProblems + 1] = {0};
    /* No rows at all, one, two, ... and what is left; every row on its own body and the one that cannot move. */
    for (int k = 0; k < kProblems; ++k) starts[k + 1] = k + 1 < kProblems ? starts[k] + k % 9 : kMostRows;
    for (int i = 0; i < kMostRows; ++i) {
      for (int side = 0; side < 2; ++side) {
        if (arrays.body[2 * i + side] != i) arrays.body[2 * i + side] = i % 2 ? kMostRows : -1;
      }
    }
    for (int k = 0; k < kProblems; ++k) {
      for (int32_t i = starts[k] + 1; i < starts[k + 1]; i += 2) {
        arrays.body[2 * i] = i;
        arrays.body[2 * i + 1] = i - 1;
      }
    }
    double f[kMostRows], alone[kMostRows];
    lcpbench_step_answer answers[kProblems];
    CHECK_OK(lcpbench_step_solve_batch(step, &rows, starts, kProblems, f, answers, sizeof answers[0]));
    for (int k = 0; k < kProblems; ++k) {
      const int32_t first = starts[k];
      lcpbench_step_rows part = rows;
      part.rows = starts[k + 1] - first;
      part.body += 2 * first;
      if (part.J != NULL) part.J += 2 * p * first;
      if (part.J_single != NULL) part.J_single += 2 * p * first;
      part.b += first;
      if (part.kinds != NULL) part.kinds += first;
      lcpbench_problem* problem = ProblemOf(&part);
      CHECK(answers[k].status == LCPBENCH_SOLVED && answers[k].iterations >= 0 && answers[k].rho <= 1e-9);
      CHECK(Judge(problem, f + first, part.rows, answers[k].status, NULL).passes == 1);
      lcpbench_step_answer answer;
      CHECK_OK(lcpbench_step_solve(step, &part, NULL, alone, NULL, &answer, sizeof answer));
      for (int32_t i = 0; i < part.rows; ++i) {
        CHECK(fabs(alone[i] - f[first + i]) < 1e-9 * (1 + fabs(alone[i])));
      }
      lcpbench_problem_free(problem);
    }
  }
  const int32_t none[1] = {0};
  const lcpbench_step_rows rows = {.size = sizeof rows};
  CHECK_OK(lcpbench_step_solve_batch(step, &rows, none, 0, NULL, NULL, sizeof(lcpbench_step_answer)));
  lcpbench_step_free(step);
}

static void NoRowsAreSolved(void) {
  lcpbench_step* step = MakeStep();
  const lcpbench_step_rows rows = {.size = sizeof rows};
  lcpbench_step_answer answer;
  CHECK_OK(lcpbench_step_solve(step, &rows, NULL, NULL, NULL, &answer, sizeof answer));
  CHECK(answer.status == LCPBENCH_SOLVED && answer.iterations == 0 && answer.rho == 0);
  const int32_t starts[4] = {0, 0, 0, 0};
  lcpbench_step_answer answers[3];
  CHECK_OK(lcpbench_step_solve_batch(step, &rows, starts, 3, NULL, answers, sizeof *answers));
  for (int k = 0; k < 3; ++k) CHECK(answers[k].status == LCPBENCH_SOLVED && answers[k].rho == 0);
  lcpbench_step_free(step);
}

/* Rows of numbers up to the ends of double's range, solvable or not, and also without time: rho is a number or
   infinite, and that of the verifier where the solver failed. */
static void RhoIsNeverNan(void) {
  static const double sizes[] = {0, 1, 1e-320, 1e-170, 1e100, 1e150},
                      loads[] = {0, -1, 1, -1e-320, -1e-170, 1e170, -1e308};
  static Arrays arrays;
  for (int k = 0; k < 6 * 7 * 2 * 3; ++k) {
    const int n = k % 3 == 0 ? 1 : k % 3 == 1 ? 4 : 30;
    const double size = sizes[k / 3 % 6];
    lcpbench_step_rows rows = MakeRows(&arrays, n, 3, 1, 0);
    for (int i = 0; i < n; ++i) {
      for (int c = 0; c < 6; ++c) arrays.J[6 * i + c] *= size;
      arrays.b[i] = loads[k / 18 % 7] * (i % 3 == 2 ? -0.5 : 1);
    }
    lcpbench_step_options options = {.size = sizeof options};
    if (k >= 6 * 7 * 3) options.time_limit_s = 1e-12;
    lcpbench_step* step = NULL;
    CHECK_OK(lcpbench_step_create(&options, &step));
    double f[30];
    lcpbench_step_answer answer;
    CHECK_OK(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer));
    CHECK(!isnan(answer.rho));
    lcpbench_problem* problem = ProblemOf(&rows);
    const lcpbench_verdict verdict = Judge(problem, f, n, answer.status, NULL);
    CHECK(!isnan(verdict.rho));
    const int is_below_double = size > 0 && size * size == 0; /* A: 0 in double, not so for the verifier */
    const int agrees = answer.rho == verdict.rho || fabs(answer.rho - verdict.rho) <= 1e-9 * (1 + verdict.rho);
    CHECK(answer.status == LCPBENCH_SOLVED || is_below_double || agrees);
    const int32_t starts[2] = {0, n};
    CHECK_OK(lcpbench_step_solve_batch(step, &rows, starts, 1, f, &answer, sizeof answer));
    CHECK(!isnan(answer.rho));
    lcpbench_problem_free(problem);
    lcpbench_step_free(step);
  }
}

/* As MistakesAreRefused, of five rows. */
static void WrongBatchesAreRefused(lcpbench_step* step, const lcpbench_step_rows* rows, double* f) {
  const int32_t starts[3] = {0, 2, 5}, falling[3] = {0, 6, 5}, late[3] = {1, 2, 5}, early[3] = {0, 2, 4};
  lcpbench_step_answer answers[2];
#define BATCH(starts, count, f, answers, size) lcpbench_step_solve_batch(step, rows, starts, count, f, answers, size)
  CHECK_REFUSED(BATCH(NULL, 2, f, answers, sizeof answers[0]), "starts is NULL");
  CHECK_REFUSED(BATCH(starts, -1, f, answers, sizeof answers[0]), "count is -1");
  CHECK_REFUSED(BATCH(falling, 2, f, answers, sizeof answers[0]), "starts[2] is 5, less than the 6 before it");
  CHECK_REFUSED(BATCH(late, 2, f, answers, sizeof answers[0]), "starts[0] is 1, expected 0");
  CHECK_REFUSED(BATCH(early, 2, f, answers, sizeof answers[0]), "starts[2] is 4, expected rows.rows = 5");
  CHECK_REFUSED(BATCH(starts, 2, NULL, answers, sizeof answers[0]), "f is NULL");
  CHECK_REFUSED(BATCH(starts, 2, f, NULL, sizeof answers[0]), "answers is NULL");
  CHECK_REFUSED(BATCH(starts, 2, f, answers, 4), "size is 4");
  CHECK_REFUSED(lcpbench_step_solve_batch(NULL, rows, starts, 2, f, answers, sizeof answers[0]), "step is NULL");
  CHECK_REFUSED(lcpbench_step_solve_batch(step, NULL, starts, 2, f, answers, sizeof answers[0]), "rows is NULL");
}

static void WrongOptionsAreRefused(void) {
  lcpbench_step* other = NULL;
  const lcpbench_step_options right = {.size = sizeof right, .tolerance = 1e-6, .time_limit_s = 1, .threads = 2};
  lcpbench_step_options options = right;
  CHECK_REFUSED(lcpbench_step_create(&options, NULL), "step is NULL");
#define OPTION(member, value, words)                              \
  do {                                                            \
    options = right;                                              \
    options.member = value;                                       \
    CHECK_REFUSED(lcpbench_step_create(&options, &other), words); \
  } while (0)
  OPTION(tolerance, 1, "tolerance must be in (0, 1)");
  OPTION(tolerance, -1, "tolerance must be in (0, 1)");
  OPTION(tolerance, NAN, "tolerance must be in (0, 1)");
  OPTION(time_limit_s, -1, "time limit must be > 0");
  OPTION(time_limit_s, NAN, "time limit must be > 0");
  OPTION(threads, -1, "threads must be from 1");
  OPTION(reserved, 1, "reserved is 1, expected 0");
  OPTION(size, 0, "size is 0, expected sizeof(lcpbench_step_options)");
  OPTION(size, 4, "size is 4");
  CHECK(other == NULL);
  const lcpbench_step_options zeros = {.size = sizeof zeros};
  CHECK_OK(lcpbench_step_create(&zeros, &other));
  lcpbench_step_free(other);
}

/* What is wrong within the arrays: step_solver_test.cc. Nothing is written. */
static void MistakesAreRefused(void) {
  static Arrays arrays;
  const lcpbench_step_rows right = MakeRows(&arrays, 5, 3, 1, 0);
  lcpbench_step* step = MakeStep();
  double f[5], w[5], start[5] = {0, 0, 0, 0, 0};
  lcpbench_step_answer answer;
  memset(f, 0x5a, sizeof f);
  memset(w, 0x5a, sizeof w);
  memset(&answer, 0x5a, sizeof answer);
  const double untouched = f[0];
  lcpbench_step_rows rows;
#define SOLVE() lcpbench_step_solve(step, &rows, start, f, w, &answer, sizeof answer)
#define WITH(member, value, words) \
  do {                             \
    rows = right;                  \
    rows.member = value;           \
    CHECK_REFUSED(SOLVE(), words); \
  } while (0)
  WITH(size, 8, "size is 8, expected sizeof(lcpbench_step_rows), ");
  WITH(columns_per_body, 5, "columns per body must be 3 or 6, found 5");
  WITH(rows, -1, "rows.rows is -1");
  WITH(rows, (int64_t)1 << 31, "rows.rows is 2147483648");
  WITH(bodies, -1, "rows.bodies is -1");
  WITH(bodies, (int64_t)1 << 31, "rows.bodies is 2147483648");
  WITH(reserved, 1, "rows.reserved is 1, expected 0");
  WITH(body, NULL, "body is missing");
  WITH(J_single, arrays.J_single, "rows.J and rows.J_single are both given");
  rows = right;
  arrays.kinds[2] = 7;
  CHECK_REFUSED(SOLVE(), "rows.kinds[2] is 7, expected LCPBENCH_UNILATERAL (0) or LCPBENCH_BILATERAL (1)");
  rows = MakeRows(&arrays, 5, 3, 1, 1);
  arrays.J_single[6 * 3] = NAN;
  CHECK_REFUSED(SOLVE(), "J of row 3 is nan, expected a finite number");

  rows = MakeRows(&arrays, 5, 3, 1, 0);
  start[4] = NAN;
  CHECK_REFUSED(SOLVE(), "initial f of row 4 is nan, expected a finite number");
  start[4] = 0;
  CHECK_REFUSED(lcpbench_step_solve(NULL, &rows, NULL, f, w, &answer, sizeof answer), "step is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, NULL, NULL, f, w, &answer, sizeof answer), "rows is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, NULL, w, &answer, sizeof answer), "f is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, f, w, NULL, sizeof answer), "answer is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, f, w, &answer, 4), "size is 4");
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, f, f, w, &answer, sizeof answer), "initial_f is f");
  CHECK(memcmp(&f[0], &untouched, sizeof untouched) == 0 && memcmp(&f[4], &untouched, sizeof untouched) == 0);
  CHECK(memcmp(&w[0], &untouched, sizeof untouched) == 0 && answer.status == 0x5a5a5a5a);

  WrongBatchesAreRefused(step, &rows, f);

  CHECK_REFUSED(lcpbench_step_reserve(step, -1, 0), "max_rows is -1");
  CHECK_REFUSED(lcpbench_step_reserve(step, 0, (int64_t)1 << 31), "max_bodies is 2147483648");
  CHECK_REFUSED(lcpbench_step_reserve(NULL, 0, 0), "step is NULL");
  int64_t fallbacks = 0;
  CHECK_REFUSED(lcpbench_step_fallbacks(NULL, &fallbacks), "step is NULL");
  CHECK_REFUSED(lcpbench_step_fallbacks(step, NULL), "fallbacks is NULL");

  rows = MakeRows(&arrays, 5, 3, 1, 0);
  ExpectSolved(step, &rows); /* none of these did harm */
  lcpbench_step_free(step);
  lcpbench_step_free(NULL);
}

/* Solved one by one, with forces that obey their bounds; what is no friction row is a mistake. */
static void FrictionAndBoundsAreSolved(void) {
  static Arrays arrays;
  const lcpbench_step_rows plain = MakeRows(&arrays, 5, 3, 0, 0);
  lcpbench_friction_row friction = {1, 0, 0.5, 0, 0};
  lcpbench_bounded_row bounded = {2, -1, 1};
  const int32_t starts[2] = {0, 5};
  double f[5];
  double in_batch[5];
  lcpbench_step_answer answer;
  lcpbench_step* step = MakeStep();
  CHECK(plain.friction == NULL && plain.friction_count == 0 && plain.bounded == NULL && plain.bounded_count == 0);
  lcpbench_step_rows rows = plain;
  rows.bounded = &bounded;
  rows.bounded_count = 1;
  CHECK_OK(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer));
  CHECK(answer.status == LCPBENCH_SOLVED && f[2] >= -1 && f[2] <= 1);
  rows.friction = &friction;
  rows.friction_count = 1;
  CHECK_OK(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer));
  CHECK(answer.status == LCPBENCH_SOLVED && f[2] >= -1 && f[2] <= 1);
  CHECK(f[1] <= 0.5 * f[0] && f[1] >= -0.5 * f[0]);
  CHECK_OK(lcpbench_step_solve_batch(step, &rows, starts, 1, in_batch, &answer, sizeof answer));
  CHECK(answer.status == LCPBENCH_SOLVED && memcmp(in_batch, f, sizeof f) == 0);
  bounded.lower = 2;
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer),
                "bounded: row 2: lower is 2 and upper 1, expected a number between them");
  friction.mu = -1;
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer),
                "friction: row 1: mu is -1, expected a finite number >= 0");
  friction.slip = 2;
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer),
                "friction[0].slip is 2, expected -1, 0 or 1");
  rows.friction = NULL;
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer), "friction is NULL");
  rows.friction_count = -1;
  CHECK_REFUSED(lcpbench_step_solve(step, &rows, NULL, f, NULL, &answer, sizeof answer), "friction_count is -1");
  rows = plain;
  ExpectSolved(step, &rows);
  lcpbench_step_free(step);
}

/* Programs of a later version have larger structs. */
static void LaterStructsAreUnderstood(void) {
  static Arrays arrays;
  struct {
    lcpbench_step_rows rows;
    double later;
  } rows;
  struct {
    lcpbench_step_answer answer;
    double later;
  } answers[2];
  const int32_t starts[3] = {0, 2, 2};
  double f[2];
  lcpbench_step* step = MakeStep();
  memset(&rows, 0xff, sizeof rows);
  rows.later = 0;
  rows.rows = MakeRows(&arrays, 2, 6, 0, 0);
  rows.rows.size = sizeof rows;
  memset(answers, 0xff, sizeof answers);
  CHECK_OK(lcpbench_step_solve_batch(step, &rows.rows, starts, 2, f, &answers[0].answer, sizeof answers[0]));
  for (int k = 0; k < 2; ++k) CHECK(answers[k].answer.status == LCPBENCH_SOLVED && answers[k].later == 0);
  memset(answers, 0xff, sizeof answers);
  CHECK_OK(lcpbench_step_solve(step, &rows.rows, NULL, f, NULL, &answers[0].answer, sizeof answers[0]));
  CHECK(answers[0].answer.status == LCPBENCH_SOLVED && answers[0].later == 0);
  rows.later = 1;
  CHECK_REFUSED(lcpbench_step_solve(step, &rows.rows, NULL, f, NULL, &answers[0].answer, sizeof answers[0]),
                "rows has members that this version of the library does not know");
  lcpbench_step_free(step);
}

int main(void) {
  StepsAreSolvedAsTheirProblems();
  AKnownStep();
  AnImpossibleStepIsNotSolved();
  ABatchIsItsProblems();
  NoRowsAreSolved();
  RhoIsNeverNan();
  MistakesAreRefused();
  FrictionAndBoundsAreSolved();
  WrongOptionsAreRefused();
  LaterStructsAreUnderstood();
  return CountFailures();
}
