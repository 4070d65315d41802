#include "model/geometry/double_double.h"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "tests/model/contact/random_contacts.h"

namespace lcpbench::testing {
namespace {

using Exact = boost::multiprecision::cpp_bin_float_100;

Exact Value(DoubleDouble a) { return Exact(a.hi) + Exact(a.lo); }

DoubleDouble RandomNumber(Random* random) {
  const double high = random->Uniform(-1, 1) * std::pow(10, random->Uniform(-12, 12));
  return TwoSum(high, high * random->Uniform(-1e-16, 1e-16));
}

void ExpectRelative(DoubleDouble found, const Exact& expected, double scale, const char* what) {
  const auto error = static_cast<double>(abs(Value(found) - expected));
  EXPECT_LE(error, 1e-31 * scale) << what;
}

TEST(DoubleDouble, ArithmeticHasThirtyOneDigits) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const DoubleDouble a = RandomNumber(&random);
    const DoubleDouble b = RandomNumber(&random);
    ExpectRelative(a + b, Value(a) + Value(b), std::abs((a + b).hi), "sum");
    ExpectRelative(a - b, Value(a) - Value(b), std::abs((a - b).hi), "difference");
    ExpectRelative(a * b, Value(a) * Value(b), std::abs((a * b).hi), "product");
    ExpectRelative(a / b, Value(a) / Value(b), std::abs((a / b).hi), "quotient");
    const DoubleDouble positive = Absolute(a);
    ExpectRelative(SquareRoot(positive), sqrt(Value(positive)), std::sqrt(positive.hi), "square root");
  }
}

TEST(DoubleDouble, SumsAndProductsOfDoublesAreExact) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const double a = RandomNumber(&random).hi;
    const double b = RandomNumber(&random).hi;
    EXPECT_EQ(Value(TwoSum(a, b)), Exact(a) + Exact(b));
    EXPECT_EQ(Value(TwoProduct(a, b)), Exact(a) * Exact(b));
  }
}

TEST(DoubleDouble, IsNeverSilentlyWrongOutsideItsRange) {
  EXPECT_FALSE(std::isfinite((DoubleDouble(1e300) * DoubleDouble(1e300)).hi));
  EXPECT_FALSE(std::isfinite((DoubleDouble(1) / DoubleDouble(0)).hi));
  EXPECT_FALSE(std::isfinite((DoubleDouble(kInfinity) + DoubleDouble(1)).hi));
  EXPECT_TRUE(std::isnan(SquareRoot(DoubleDouble(-1)).hi));
  EXPECT_EQ(SquareRoot(DoubleDouble(0)).hi, 0);
}

TEST(DoubleDouble, RotationsAreUnitVectorsToAllDigits) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const VecOf<DoubleDouble> r = LiftRotation<DoubleDouble>(SinCos(random.Uniform(-10, 10)));
    EXPECT_LE(std::abs(static_cast<double>(Value(Dot(r, r)) - 1)), 1e-31);
  }
}

}  // namespace
}  // namespace lcpbench::testing
