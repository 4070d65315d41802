#include "support/cancellation.h"

#include <thread>

#include "support/clock.h"
#include "tests/support/test.h"

namespace lcpbench {
namespace {

struct Asked {
  int times = 0;
  bool answer = false;
};
bool Ask(void* asked) {
  ++static_cast<Asked*>(asked)->times;
  return static_cast<Asked*>(asked)->answer;
}

void CheckFor(double seconds) {
  for (const double end = SteadyNow() + seconds; SteadyNow() < end;) Cancellation::Check();
}

TEST(Cancellation, IsImpossibleWhereNobodyMay) {
  EXPECT_FALSE(Cancellation::IsPossible());
  const Cancellation::Scope scope(nullptr, nullptr);
  EXPECT_FALSE(Cancellation::IsPossible());
  Cancellation::Check();
}

TEST(Cancellation, AsksOnceAPeriodAndNotAtOnce) {
  Asked asked;
  const Cancellation::Scope scope(&Ask, &asked);
  Cancellation::Check();
  EXPECT_EQ(asked.times, 0);
  CheckFor(5.5 * Cancellation::kPeriod);
  EXPECT_GE(asked.times, 1);
  EXPECT_LE(asked.times, 5);
}

TEST(Cancellation, GoesOnOnceItHappened) {
  Asked asked{0, true};
  {
    const Cancellation::Scope scope(&Ask, &asked);
    EXPECT_THROW(CheckFor(10), Cancelled);
    EXPECT_THROW(Cancellation::Check(), Cancelled);
    EXPECT_EQ(asked.times, 1);
    const Cancellation::Scope inner(nullptr, nullptr);
    Cancellation::Check();
  }
  Cancellation::Check();
}

TEST(Cancellation, IsOfOneThread) {
  Asked asked{0, true};
  const Cancellation::Scope scope(&Ask, &asked);
  std::thread([] { EXPECT_FALSE(Cancellation::IsPossible()); }).join();
}

}  // namespace
}  // namespace lcpbench
