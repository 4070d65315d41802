#include <gtest/gtest.h>

#include "tests/benchmarks/command_fixture.h"

namespace lcpbench {
namespace {

class SceneCommand : public CommandTest {
 protected:
  /// One line that says what was expected, and status 2.
  void ExpectRefusal(const std::string& arguments, const std::string& words) {
    const CommandOutcome outcome = Run("scene " + arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
    EXPECT_NE(outcome.error.find(words), std::string::npos) << arguments << ": " << outcome.error;
    EXPECT_EQ(outcome.error.find('\n'), outcome.error.size() - 1) << outcome.error;
  }
};

TEST_F(SceneCommand, WritesTheSamePictureToStandardOutputAndToAFile) {
  const CommandOutcome outcome = Run("scene rockers --size 12 --seed 3");
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_EQ(outcome.out.find("<svg "), 0U);
  EXPECT_NE(outcome.out.find("rockers-12-s3"), std::string::npos);
  EXPECT_EQ(Run("scene rockers --size 12 --seed 3 -o " + Path("x.svg")).status, 0);
  EXPECT_EQ(ReadFile(folder_ / "x.svg"), outcome.out);
  EXPECT_NE(Run("scene rockers --size 12 --seed 4").out, outcome.out);
}

TEST_F(SceneCommand, NamesTheSolverWhoseForcesItDraws) {
  const CommandOutcome outcome = Run("scene disc-pile --size 6 --solver pgs");
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("pgs"), std::string::npos);
  EXPECT_NE(outcome.out.find(" N<"), std::string::npos);
}

TEST_F(SceneCommand, ReadsSceneFilesAndFindsTheirContacts) {
  Write("two.json", R"({"lcpbench_scene": 1, "gravity": [0, -9.81], "bodies": [
      {"name": "floor", "fixed": true, "shape": {"box": {"width": 4, "height": 1}}, "position": [0, -0.5]},
      {"name": "ball", "density": 1, "shape": {"disc": {"radius": 1}}, "position": [0, 1]}]})");
  const CommandOutcome outcome = Run("scene " + Path("two.json"));
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("active, f &gt; 0 (1)"), std::string::npos);
  // The ball's weight.
  EXPECT_NE(outcome.out.find(">30.8 N<"), std::string::npos);
}

TEST_F(SceneCommand, WritesASceneFileOfWhatMovesFromThenOn) {
  ASSERT_EQ(Run("scene rockers --size 12 --seed 3 --time 0.05 -o " + Path("x.json")).status, 0);
  const std::string all = Run("sequence rockers --size 12 --seed 3 --steps 53").out;
  const std::string rest = Run("sequence " + Path("x.json") + " --steps 3").out;
  // The problem of step 50 is the file's first; names and what is told of the motion differ.
  const auto problem = [](const std::string& text, int line) {
    std::size_t begin = 0;
    for (int k = 0; k < line; ++k) begin = text.find('\n', begin) + 1;
    const std::size_t from = text.find("\"n\":", begin);
    return text.substr(from, text.find("\"motion\"", from) - from);
  };
  EXPECT_GT(problem(rest, 0).size(), 100U);
  EXPECT_EQ(problem(rest, 0), problem(all, 50));
  EXPECT_EQ(Run("scene " + Path("x.json") + " -o " + Path("x.svg")).status, 0);
}

TEST_F(SceneCommand, WritesAnAnimationPage) {
  const CommandOutcome outcome =
      Run("scene disc-pile --size 6 --level velocity --duration 0.1 --fps 30 --animate " + Path("x.html"));
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  const std::string page = ReadFile(folder_ / "x.html");
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  EXPECT_NE(page.find("\"frameCount\":4"), std::string::npos);
}

TEST_F(SceneCommand, RefusesWithOneLine) {
  ExpectRefusal("no-such-scene", "disc-pile");
  ExpectRefusal("disc-pile --size 0", "rows >= 1");
  ExpectRefusal("disc-pile --solver no-such-solver", "dantzig");
  ExpectRefusal("disc-pile -o " + Path("x.png"), ".svg");
  ExpectRefusal("disc-pile -o " + Path("no/such/folder/x.svg"), "cannot be written");
  ExpectRefusal("disc-pile --time -1", "seconds >= 0");
  ExpectRefusal("disc-pile --level fast", "acceleration or velocity");
  ExpectRefusal("disc-pile --duration 2", "--animate");
  ExpectRefusal("disc-pile --animate " + Path("x.svg"), ".html");
  ExpectRefusal("disc-pile --duration 0 --animate " + Path("x.html"), "--duration");
  ExpectRefusal(Path("missing.json"), "missing.json");
  Write("wrong.json", "{}");
  ExpectRefusal(Path("wrong.json"), "wrong.json");
}

}  // namespace
}  // namespace lcpbench
