#include "support/interruption.h"

#include <gtest/gtest.h>

#include <thread>

#include "support/clock.h"

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
  for (const double end = SteadyNow() + seconds; SteadyNow() < end;) Interruption::Check();
}

TEST(Interruption, IsImpossibleWhereNobodyMay) {
  EXPECT_FALSE(Interruption::IsPossible());
  const Interruption::Scope scope(nullptr, nullptr);
  EXPECT_FALSE(Interruption::IsPossible());
  Interruption::Check();
}

TEST(Interruption, AsksOnceAPeriodAndNotAtOnce) {
  Asked asked;
  const Interruption::Scope scope(&Ask, &asked);
  Interruption::Check();
  EXPECT_EQ(asked.times, 0);
  CheckFor(5.5 * Interruption::kPeriod);
  EXPECT_GE(asked.times, 1);
  EXPECT_LE(asked.times, 5);
}

TEST(Interruption, GoesOnOnceItHappened) {
  Asked asked{0, true};
  {
    const Interruption::Scope scope(&Ask, &asked);
    EXPECT_THROW(CheckFor(10), Interrupted);
    EXPECT_THROW(Interruption::Check(), Interrupted);
    EXPECT_EQ(asked.times, 1);
    const Interruption::Scope inner(nullptr, nullptr);
    Interruption::Check();
  }
  Interruption::Check();
}

TEST(Interruption, IsOfOneThread) {
  Asked asked{0, true};
  const Interruption::Scope scope(&Ask, &asked);
  std::thread([] { EXPECT_FALSE(Interruption::IsPossible()); }).join();
}

}  // namespace
}  // namespace lcpbench
