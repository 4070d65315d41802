/* Checks of the tests in C: each prints what failed, and the exit status of a program is the number of failures, at
   most 100. */
#ifndef LCPBENCH_TESTS_C_CHECK_H_
#define LCPBENCH_TESTS_C_CHECK_H_

#include <lcpbench.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;

static inline void Check(int holds, const char* condition, int line) {
  if (holds) return;
  ++failures;
  fprintf(stderr, "line %d: %s does not hold (last error: %s)\n", line, condition, lcpbench_last_error());
}

#define CHECK(condition) Check((condition) != 0, #condition, __LINE__)
#define CHECK_OK(call) CHECK((call) == LCPBENCH_OK)

/* n numbers are as expected but for `tolerance`, relative to 1 or to what is expected where that is larger. */
static inline void CheckNear(const double* found, const double* expected, int64_t n, double tolerance, int line) {
  for (int64_t i = 0; i < n; ++i) {
    if (fabs(found[i] - expected[i]) <= tolerance * fmax(1, fabs(expected[i]))) continue;
    ++failures;
    fprintf(stderr, "line %d: number %d is %.17g, expected %.17g\n", line, (int)i, found[i], expected[i]);
  }
}

#define CHECK_NEAR(found, expected, n, tolerance) CheckNear(found, expected, n, tolerance, __LINE__)

/* The call must be refused, with a message that holds `words`. */
static inline void CheckRefused(lcpbench_error error, const char* words, const char* call, int line) {
  if (error == LCPBENCH_INVALID_ARGUMENT && strstr(lcpbench_last_error(), words) != NULL) return;
  ++failures;
  fprintf(stderr, "line %d: %s: expected a refusal with '%s', found %d: %s\n", line, call, words, (int)error,
          lcpbench_last_error());
}

#define CHECK_REFUSED(call, words) CheckRefused(call, words, #call, __LINE__)

/* CALL(), which a test defines, must be refused while a number or pointer has the value `wrong`. */
#define REFUSED(place, wrong, words)               \
  do {                                             \
    char value_before[sizeof(place)];              \
    memcpy(value_before, &(place), sizeof(place)); \
    (place) = (wrong);                             \
    CHECK_REFUSED(CALL(), words);                  \
    memcpy(&(place), value_before, sizeof(place)); \
  } while (0)

/* A struct as a later version may have it: with a member that this one does not know. */
#define LATER(type) \
  struct {          \
    type known;     \
    double later;   \
  }

/* What the tests have made, until FreeMade. */
static struct {
  lcpbench_problem* problem;
  lcpbench_solver* solver;
  lcpbench_step* step;
} made[2000];
static int made_count = 0;

static inline void FreeMade(void) {
  for (; made_count > 0; --made_count) {
    lcpbench_problem_free(made[made_count].problem);
    lcpbench_solver_free(made[made_count].solver);
    lcpbench_step_free(made[made_count].step);
    memset(&made[made_count], 0, sizeof made[made_count]);
  }
}

/* The exit status of a program. */
static inline int CountFailures(void) {
  FreeMade();
  if (failures > 0) fprintf(stderr, "%d checks failed\n", failures);
  return failures > 100 ? 100 : failures;
}

static inline lcpbench_problem* Create(lcpbench_problem_data data) {
  lcpbench_problem** problem = &made[++made_count].problem;
  data.size = sizeof data;
  CHECK_OK(lcpbench_problem_create(&data, problem));
  return *problem;
}

static inline lcpbench_solver* CreateSolver(const char* key, const char* settings) {
  lcpbench_solver** solver = &made[++made_count].solver;
  CHECK_OK(lcpbench_solver_create(key, settings, solver));
  return *solver;
}

static inline lcpbench_step* CreateStep(const lcpbench_step_options* options) {
  lcpbench_step** step = &made[++made_count].step;
  CHECK_OK(lcpbench_step_create(options, step));
  return *step;
}

static inline lcpbench_verdict Judge(const lcpbench_problem* problem, const lcpbench_answer* answer, double tolerance,
                                     double* w) {
  lcpbench_verdict verdict = {.size = sizeof verdict};
  CHECK_OK(lcpbench_verify(problem, answer, tolerance, &verdict, w));
  return verdict;
}

enum { kMostRows = 1000 };

/* A problem and a solver, its answer and the verdict on it. */
typedef struct Solved {
  lcpbench_problem* problem;
  lcpbench_solver* solver;
  lcpbench_answer answer;
  lcpbench_verdict verdict;
  double w[kMostRows];
} Solved;

static inline Solved Solve(const char* key, lcpbench_problem_data data, const lcpbench_solve_options* options) {
  Solved solved = {
      .problem = Create(data), .solver = CreateSolver(key, NULL), .answer = {.size = sizeof solved.answer}};
  CHECK_OK(lcpbench_solve(solved.solver, solved.problem, options, &solved.answer));
  solved.verdict = Judge(solved.problem, &solved.answer, 1e-6, solved.w);
  return solved;
}

#endif
