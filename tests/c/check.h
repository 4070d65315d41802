/* Checks of the tests in C: each prints what failed, and the exit status of a program is the number of failures, at
   most 100. */
#ifndef LCPBENCH_TESTS_C_CHECK_H_
#define LCPBENCH_TESTS_C_CHECK_H_

#include <lcpbench.h>
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

/* The call must be refused, with a message that holds `words`. */
static inline void CheckRefused(lcpbench_error error, const char* words, const char* call, int line) {
  if (error == LCPBENCH_INVALID_ARGUMENT && strstr(lcpbench_last_error(), words) != NULL) return;
  ++failures;
  fprintf(stderr, "line %d: %s: expected a refusal with '%s', found %d: %s\n", line, call, words, (int)error,
          lcpbench_last_error());
}

#define CHECK_REFUSED(call, words) CheckRefused(call, words, #call, __LINE__)

/* The exit status of a program. */
static inline int CountFailures(void) {
  if (failures > 0) fprintf(stderr, "%d checks failed\n", failures);
  return failures > 100 ? 100 : failures;
}

#endif
