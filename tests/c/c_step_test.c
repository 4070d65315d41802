/* The step interface from C99: against the solver "auto" on the same problem, judged by the verifier. */
#include <lcpbench.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "tests/c/check.h"

/* Of benchmarks/measure/allocation_count.h. */
long AllocationCount(void);
bool AllocationsAreCounted(void);
void CountAllocations(bool on);

enum { kMostBodies = kMostRows + 2 };

/* An engine's arrays. */
static int32_t body[2 * kMostRows];
static double J[12 * kMostRows], b[kMostRows], inverse_mass[6 * kMostBodies];
static float J_single[12 * kMostRows];
static uint8_t kinds[kMostRows];

static uint64_t state = 1;

/* In [-1, 1), the same everywhere. */
static double Random(void) {
  state = state * 6364136223846793005U + 1442695040888963407U;
  return (double)(int64_t)state / 9223372036854775808.0;
}

/* n rows in these arrays, each on a body of its own and on the ground or another body: A is positive definite, so that
   f is unique. J is exact in single precision. */
static lcpbench_problem_data MakeRows(int n, int p, int joints, int single) {
  memset(J, single ? 0xff : 0, sizeof J); /* not to be read in place of J_single */
  for (int i = 0; i < n; ++i) {
    const int other = (int)floor((Random() + 1) * 0.5 * (n + 2)); /* n: a body that cannot move; n + 1: the ground */
    const int32_t second = other == i || other == n + 1 ? -1 : other;
    const int swapped = Random() < 0;
    body[2 * i + swapped] = i;
    body[2 * i + 1 - swapped] = second;
    for (int c = 2 * p * i; c < 2 * p * (i + 1); ++c) {
      J_single[c] = (float)Random();
      if (!single) J[c] = J_single[c];
    }
    for (int c = 0; c < p; ++c) inverse_mass[p * i + c] = 1.5 + Random();
    b[i] = Random();
    kinds[i] = joints && i % 3 == 1 ? LCPBENCH_BILATERAL : LCPBENCH_UNILATERAL;
  }
  memset(inverse_mass + p * n, 0, (size_t)(2 * p) * sizeof(double));
  const lcpbench_problem_data data = {.size = sizeof data,
                                      .form = LCPBENCH_TWO_BODIES,
                                      .rows = n,
                                      .bodies = n + 2,
                                      .columns_per_body = p,
                                      .values = single ? NULL : J,
                                      .values_single = single ? J_single : NULL,
                                      .body = body,
                                      .inverse_mass = inverse_mass,
                                      .b = b,
                                      .kinds = joints ? kinds : NULL};
  return data;
}

static lcpbench_step* MakeStep(void) {
  const lcpbench_step_options options = {.size = sizeof options, .max_rows = kMostRows, .max_bodies = kMostBodies};
  const long before = AllocationCount();
  lcpbench_step* step = CreateStep(&options);
  CHECK(AllocationCount() > before || !AllocationsAreCounted()); /* the library's allocations are counted */
  return step;
}

/* From a cold start. */
static lcpbench_answer SolveStep(lcpbench_step* step, const lcpbench_problem_data* data, double* f, double* w) {
  lcpbench_answer answer = {.size = sizeof answer};
  CHECK_OK(lcpbench_step_solve(step, data, NULL, f, w, &answer));
  CHECK(answer.n == data->rows && (answer.f == f || answer.n == 0) && answer.ray == NULL && answer.detail[0] == '\0');
  return answer;
}

/* Problem k of `count` has the rows starts[k] .. starts[k + 1] - 1. */
static void SolveBatch(lcpbench_step* step, lcpbench_problem_data data, const int32_t* starts, int64_t count, double* f,
                       lcpbench_answer* answers, size_t size) {
  data.starts = starts;
  data.problems = count;
  if (count > 0) answers[0].size = size;
  CHECK_OK(lcpbench_step_solve(step, &data, NULL, f, NULL, answers));
}

/* Solves by `step`, which allocates nothing, verifies, and compares with "auto". */
static void ExpectSolved(lcpbench_step* step, const lcpbench_problem_data* data) {
  double f[kMostRows], w[kMostRows], again[kMostRows];
  memset(f, 0xff, sizeof f);
  memset(w, 0xff, sizeof w);
  const long before = AllocationCount();
  const lcpbench_answer cold = SolveStep(step, data, f, w);
  CHECK(cold.status == LCPBENCH_SOLVED && cold.infeasible_proved == 0 && cold.force_min == 0 && cold.iterations >= 0);
  /* From the answer the answer in no more pivots, also without w. */
  lcpbench_answer warm = {.size = sizeof warm};
  CHECK_OK(lcpbench_step_solve(step, data, f, again, NULL, &warm));
  CHECK(warm.status == LCPBENCH_SOLVED && warm.iterations <= (cold.iterations > 1 ? cold.iterations : 1));
  CHECK_NEAR(again, f, data->rows, 1e-9);
  CHECK(AllocationCount() == before);

  Solved expected = Solve("auto", *data, NULL);
  CHECK_NEAR(f, expected.answer.f, data->rows, 1e-9);
  const lcpbench_verdict verdict = Judge(expected.problem, &cold, 1e-9, expected.w);
  CHECK(verdict.passes == 1 && verdict.false_success == 0);
  CHECK(verdict.rho <= cold.rho + 1e-13 && cold.rho <= 1e-9);
  for (int64_t i = 0; i < data->rows; ++i) CHECK(fabs(w[i] - expected.w[i]) < 1e-12 * (1 + fabs(f[i])));
}

static void StepsAreSolvedAsTheirProblems(void) {
  static const int sizes[] = {1, 2, 3, 6, 12, 17, 40, 60, kMostRows};
  lcpbench_step* step = MakeStep();
  for (int k = 0; k < 9 * 8 * 5; ++k) {
    const int size = sizes[k / 8 / 5];
    if (size == kMostRows && k % 5 > 0) continue;
    const lcpbench_problem_data data = MakeRows(size, k / 5 & 4 ? 6 : 3, k / 5 & 1, k / 5 >> 1 & 1);
    ExpectSolved(step, &data);
  }
  const lcpbench_problem_data none = {.size = sizeof none, .form = LCPBENCH_TWO_BODIES};
  const lcpbench_answer answer = SolveStep(step, &none, NULL, NULL);
  CHECK(answer.status == LCPBENCH_SOLVED && answer.iterations == 0 && answer.rho == 0 && answer.fallbacks == 0);
}

/* A ball of 2 kg on the ground, and upon it one of 1 kg that a joint pulls against a wind of 3 N: by hand. The ground
   carries both, the lower ball the upper one. */
static void EveryFormIsTheSameProblem(void) {
  const double loads[3] = {-10, 0, 3}, masses[6] = {0.5, 0.5, 1, 1, 1, 1};
  const double f[3] = {30, 10, -3}, w[3] = {0, 0, 0};
  const uint8_t joint_last[3] = {LCPBENCH_UNILATERAL, LCPBENCH_UNILATERAL, LCPBENCH_BILATERAL};
  const int32_t row_starts[4] = {0, 1, 3, 4}, columns[4] = {1, 4, 1, 3};
  const int32_t column_starts[7] = {0, 0, 2, 2, 3, 4, 4}, rows[4] = {1, 0, 2, 1};
  const double by_rows[4] = {1, 1, -1, 1}, by_columns[4] = {-1, 1, 1, 1};
  const int32_t of_rows[6] = {0, -1, 1, 0, 1, -1};
  const double sides[18] = {0, 1, 0, 9, 9, 9, 0, 1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 0}; /* nines act on nothing */
  float sides_single[18];
  for (int i = 0; i < 18; ++i) sides_single[i] = (float)sides[i];
  const double* const values[4] = {by_columns, by_rows, sides, NULL};
  const int32_t* const starts[4] = {column_starts, row_starts, NULL, NULL};
  lcpbench_step* step = CreateStep(NULL); /* without workspace */
  for (int k = 0; k < 4; ++k) {
    const lcpbench_problem_data data = {.size = sizeof data, /* columns_per_body 0: in the plane */
                                        .form = k < 2 ? LCPBENCH_FACTORS : LCPBENCH_TWO_BODIES,
                                        .by_rows = k,
                                        .rows = 3,
                                        .columns = 6,
                                        .bodies = 2,
                                        .values = values[k],
                                        .values_single = k == 3 ? sides_single : NULL,
                                        .body = of_rows,
                                        .entries = 4,
                                        .starts = starts[k],
                                        .indices = k == 0 ? rows : columns,
                                        .inverse_mass = masses,
                                        .b = loads,
                                        .kinds = joint_last};
    Solved found = Solve("auto", data, NULL);
    CHECK(found.answer.status == LCPBENCH_SOLVED && found.verdict.best_tier == 1e-9);
    CHECK_NEAR(found.answer.f, f, 3, 3e-14);
    CHECK_NEAR(found.w, w, 3, 1e-13);
    if (data.form != LCPBENCH_TWO_BODIES) continue;
    double f_of_step[3], w_of_step[3];
    const lcpbench_answer answer = SolveStep(step, &data, f_of_step, w_of_step);
    CHECK(answer.status == LCPBENCH_SOLVED && answer.rho < 1e-15);
    CHECK_NEAR(f_of_step, f, 3, 3e-14);
    CHECK_NEAR(w_of_step, w, 3, 1e-13);
  }
}

/* Two joints of one body that contradict each other: an answer that says how surely, and the object goes on. */
static void AnImpossibleStepIsNotSolved(void) {
  lcpbench_step* step = MakeStep();
  /* The second joint is one, or three times the first but for the last digits. */
  for (int is_near = 0; is_near < 2; ++is_near) {
    const lcpbench_problem_data data = MakeRows(2, 3, 1, 0);
    const double exact[12] = {1, 0, 0, 0, 0, 0, 1}, near[12] = {0.3, 0.1, 0, 0, 0, 0, 0.9, 0.3};
    memcpy(J, is_near ? near : exact, sizeof exact);
    for (int i = 0; i < 2; ++i) {
      body[2 * i] = 0;
      body[2 * i + 1] = -1;
      b[i] = 1 - 2 * i;
      inverse_mass[i] = 1;
      kinds[i] = LCPBENCH_BILATERAL;
    }
    double f[2] = {NAN, NAN};
    const lcpbench_answer answer = SolveStep(step, &data, f, NULL);
    CHECK(answer.status == LCPBENCH_INFEASIBLE && answer.infeasible_proved == !is_near);
    CHECK(answer.force_min > 1e12 && isinf(answer.force_min) == !is_near);
    CHECK(answer.fallbacks == 1 + is_near && isfinite(f[0]) && isfinite(f[1]));
  }
  const lcpbench_problem_data data = MakeRows(9, 3, 1, 0);
  ExpectSolved(step, &data);
}

/* No rows at all, one, two, ... and what is left; every row on its own body, and the one that cannot move or the row
   before. */
static void ABatchIsItsProblems(void) {
  enum { kProblems = 12, kRows = 60 };
  lcpbench_step* step = MakeStep();
  for (int form = 0; form < 8; ++form) {
    const int p = form & 4 ? 6 : 3;
    const lcpbench_problem_data data = MakeRows(kRows, p, form & 1, form >> 1 & 1);
    int32_t starts[kProblems + 1] = {0};
    for (int k = 0; k < kProblems; ++k) {
      starts[k + 1] = k + 1 < kProblems ? starts[k] + k % 9 : kRows;
      for (int32_t i = starts[k]; i < starts[k + 1]; ++i) {
        const int is_on_another = (i - starts[k]) % 2 == 1;
        const int own = !is_on_another && body[2 * i] != i;
        body[2 * i + own] = i;
        body[2 * i + 1 - own] = is_on_another ? i - 1 : i % 2 ? kRows : -1;
      }
    }
    double f[kRows];
    lcpbench_answer answers[kProblems];
    SolveBatch(step, data, starts, kProblems, f, answers, sizeof answers[0]);
    for (int k = 0; k < kProblems; ++k) {
      const lcpbench_answer* const answer = &answers[k];
      CHECK(answer->size == sizeof *answer && answer->n == starts[k + 1] - starts[k]);
      CHECK(answer->f == f + starts[k] || answer->n == 0);
      CHECK(answer->status == LCPBENCH_SOLVED && answer->iterations >= 0 && answer->rho <= 1e-9);
    }
    Solved together = Solve("auto", data, NULL);
    CHECK_NEAR(f, together.answer.f, kRows, 1e-9);
    together.answer.f = f;
    CHECK(Judge(together.problem, &together.answer, 1e-9, NULL).passes == 1);
  }
  const int32_t none[4] = {0, 0, 0, 0};
  const lcpbench_problem_data data = {.size = sizeof data, .form = LCPBENCH_TWO_BODIES};
  SolveBatch(step, data, none, 0, NULL, NULL, 0);
  LATER(lcpbench_answer) answers[3] = {{.later = 0}, {.later = 1}, {.later = 1}};
  SolveBatch(step, data, none, 3, NULL, &answers[0].known, sizeof answers[0]);
  for (int k = 0; k < 3; ++k) {
    const lcpbench_answer* const answer = &answers[k].known;
    CHECK(answer->status == LCPBENCH_SOLVED && answer->rho == 0);
    CHECK(answer->size == sizeof answers[k] && answers[k].later == 0);
  }
}

static void WrongOptionsAreRefused(void) {
  lcpbench_step* step = NULL;
  lcpbench_step_options options = {.size = sizeof options, .tolerance = 1e-6, .time_limit_s = 1, .threads = 2};
  CHECK_REFUSED(lcpbench_step_create(&options, NULL), "step is NULL");
#define CALL() lcpbench_step_create(&options, &step)
  REFUSED(options.tolerance, -1, "tolerance must be in (0, 1)");
  REFUSED(options.time_limit_s, NAN, "time limit must be > 0");
  REFUSED(options.threads, -1, "threads is -1");
  REFUSED(options.threads, 1025, "threads must be from 1 to 1024, found 1025");
  REFUSED(options.threads, (int64_t)1 << 32, "threads is 4294967296");
  REFUSED(options.max_rows, -1, "max_rows is -1");
  REFUSED(options.max_bodies, (int64_t)1 << 31, "max_bodies is 2147483648");
  REFUSED(options.size, 4, "size is 4, expected sizeof(lcpbench_step_options)");
  CHECK(step == NULL);
#undef CALL
  CreateStep(&options); /* nothing else was wrong */
}

/* What is wrong within the arrays: step_solver_test.cc, and of problems c_interface_test.c. Nothing is written. */
static void MistakesAreRefused(void) {
  lcpbench_problem_data data = MakeRows(5, 3, 1, 0);
  lcpbench_step* step = MakeStep();
  double f[5], w[5], start[5] = {0, 0, 0, 0, 0};
  int32_t starts[3] = {0, 2, 5};
  lcpbench_answer answer = {.size = sizeof answer, .status = 77};
  memset(f, 0x5a, sizeof f);
  memset(w, 0x5a, sizeof w);
  const double untouched = f[0];
#define CALL() lcpbench_step_solve(step, &data, start, f, w, &answer)
  REFUSED(data.size, 8, "size is 8, expected sizeof(lcpbench_problem_data), ");
  REFUSED(data.form, LCPBENCH_FACTORS, "form is 3, expected LCPBENCH_TWO_BODIES");
  REFUSED(data.columns_per_body, 5, "columns per body must be 3 or 6, found 5");
  REFUSED(data.rows, (int64_t)1 << 31, "rows is 2147483648");
  REFUSED(data.body, NULL, "body is missing");
  REFUSED(data.values_single, J_single, "values and values_single are both given");
  REFUSED(kinds[2], 7, "kinds[2] is 7, expected LCPBENCH_UNILATERAL (0) or LCPBENCH_BILATERAL (1)");
  REFUSED(start[4], NAN, "initial f of row 4 is nan, expected a finite number");
  REFUSED(answer.size, 4, "size is 4");
  data = MakeRows(5, 3, 1, 1);
  REFUSED(J_single[6 * 3], NAN, "J of row 3 is nan, expected a finite number");
#undef CALL
  CHECK_REFUSED(lcpbench_step_solve(NULL, &data, start, f, w, &answer), "step is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, NULL, start, f, w, &answer), "data is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, &data, start, NULL, w, &answer), "f is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, &data, start, f, w, NULL), "answers is NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, &data, start, start, w, &answer), "initial_f is f");

  data.starts = starts;
  data.problems = 2;
#define CALL() lcpbench_step_solve(step, &data, NULL, f, NULL, &answer)
  REFUSED(starts[1], 6, "starts[2] is 5, less than the 6 before it");
  REFUSED(starts[0], 1, "starts[0] is 1, expected 0");
  REFUSED(starts[2], 4, "starts[2] is 4, expected rows = 5");
  REFUSED(data.problems, -1, "problems is -1");
#undef CALL
  CHECK_REFUSED(lcpbench_step_solve(step, &data, start, f, NULL, &answer),
                "initial_f and w are for one problem, expected NULL");
  CHECK_REFUSED(lcpbench_step_solve(step, &data, NULL, f, w, &answer),
                "initial_f and w are for one problem, expected NULL");
  for (int i = 0; i < 5; ++i) CHECK(f[i] == untouched && w[i] == untouched && start[i] == 0);
  CHECK(answer.status == 77);
  data.starts = NULL;
  ExpectSolved(step, &data); /* none of these did harm */
}

/* Solved one by one, with forces that obey their bounds. */
static void FrictionAndBoundsAreSolved(void) {
  const lcpbench_problem_data plain = MakeRows(5, 3, 0, 0);
  lcpbench_friction_row friction = {.row = 1, .normal = 0, .mu = 0.5};
  lcpbench_bounded_row bounded = {.row = 2, .lower = -1, .upper = 1};
  const int32_t starts[2] = {0, 5};
  double f[5], in_batch[5];
  lcpbench_step* step = MakeStep();
  lcpbench_problem_data data = plain;
  data.bounded = &bounded;
  data.bounded_count = 1;
  data.friction = &friction;
  for (data.friction_count = 0; data.friction_count < 2; ++data.friction_count) {
    const lcpbench_answer answer = SolveStep(step, &data, f, NULL);
    CHECK(answer.status == LCPBENCH_SOLVED && f[2] >= -1 && f[2] <= 1);
    CHECK(data.friction_count == 0 || (f[1] <= 0.5 * f[0] && f[1] >= -0.5 * f[0]));
  }
  data.friction_count = 1;
  lcpbench_answer answer = {.size = sizeof answer};
  SolveBatch(step, data, starts, 1, in_batch, &answer, sizeof answer);
  CHECK(answer.status == LCPBENCH_SOLVED && memcmp(in_batch, f, sizeof f) == 0);
#define CALL() lcpbench_step_solve(step, &data, NULL, f, NULL, &answer)
  REFUSED(bounded.lower, 2, "bounded: row 2: lower is 2 and upper 1, expected a number between them");
  REFUSED(friction.mu, -1, "friction: row 1: mu is -1, expected a finite number >= 0");
#undef CALL
  ExpectSolved(step, &plain);
}

int main(void) {
  CountAllocations(true);
  StepsAreSolvedAsTheirProblems();
  EveryFormIsTheSameProblem();
  AnImpossibleStepIsNotSolved();
  ABatchIsItsProblems();
  MistakesAreRefused();
  FrictionAndBoundsAreSolved();
  WrongOptionsAreRefused();
  return CountFailures();
}
