#include <gtest/gtest.h>

#include <utility>

#include "tests/benchmarks/command_fixture.h"

namespace lcpbench {
namespace {

class SceneCommand : public CommandTest {};

TEST_F(SceneCommand, WritesTheSamePictureToStandardOutputAndToAFile) {
  const CommandOutcome outcome = Succeed("scene rockers --size 12 --seed 3");
  EXPECT_EQ(outcome.out.find("<svg "), 0U);
  EXPECT_NE(outcome.out.find("rockers-12-s3"), std::string::npos);
  Succeed("scene rockers --size 12 --seed 3 -o " + Path("x.svg"));
  EXPECT_EQ(ReadFile(folder_ / "x.svg"), outcome.out);
  EXPECT_NE(Run("scene rockers --size 12 --seed 4").out, outcome.out);
}

TEST_F(SceneCommand, NamesTheSolverWhoseForcesItDraws) {
  const CommandOutcome outcome = Succeed("scene disc-pile --size 6 --solver pgs");
  EXPECT_NE(outcome.out.find("pgs"), std::string::npos);
  EXPECT_NE(outcome.out.find(" N<"), std::string::npos);
}

TEST_F(SceneCommand, ReadsSceneFilesAndFindsTheirContacts) {
  Write("two.json", R"({"lcpbench_scene": 1, "gravity": [0, -9.81], "bodies": [
      {"name": "floor", "fixed": true, "shape": {"box": {"width": 4, "height": 1}}, "position": [0, -0.5]},
      {"name": "ball", "density": 1, "shape": {"disc": {"radius": 1}}, "position": [0, 1]}]})");
  const CommandOutcome outcome = Succeed("scene " + Path("two.json"));
  EXPECT_NE(outcome.out.find("active, f &gt; 0 (1)"), std::string::npos);
  // The ball's weight.
  EXPECT_NE(outcome.out.find(">30.8 N<"), std::string::npos);
}

TEST_F(SceneCommand, WritesASceneFileOfWhatMovesFromThenOn) {
  Succeed("scene rockers --size 12 --seed 3 --time 0.05 -o " + Path("x.json"));
  const std::string all = Run("sequence rockers --size 12 --seed 3 --steps 53").out;
  const std::string rest = Run("sequence " + Path("x.json") + " --steps 3").out;
  // The problem of step 50 is the file's first; names and what is told of the motion differ.
  const auto problem = [](const std::string& text, std::size_t line) {
    nlohmann::json record = Records(text).at(line);
    record.erase("id");
    record.erase("motion");
    return record.dump();
  };
  EXPECT_GT(problem(rest, 0).size(), 100U);
  EXPECT_EQ(problem(rest, 0), problem(all, 50));
  Succeed("scene " + Path("x.json") + " -o " + Path("x.svg"));
}

TEST_F(SceneCommand, WritesAnAnimationPage) {
  const CommandOutcome outcome =
      Succeed("scene disc-pile --size 6 --level velocity --duration 0.1 --fps 30 --animate " + Path("x.html"));
  const std::string page = ReadFile(folder_ / "x.html");
  EXPECT_EQ(page.find("<!DOCTYPE html>"), 0U);
  EXPECT_NE(page.find("\"frameCount\":4"), std::string::npos);
}

TEST_F(SceneCommand, RefusesWithOneLine) {
  Write("wrong.json", "{}");
  const std::pair<std::string, std::string> mistakes[] = {
      {"no-such-scene", "disc-pile"},
      {"disc-pile --size 0", "rows >= 1"},
      {"disc-pile --solver no-such-solver", "dantzig"},
      {"disc-pile -o " + Path("x.png"), ".svg"},
      {"disc-pile -o " + Path("no/such/folder/x.svg"), "cannot be written"},
      {"disc-pile --time -1", "seconds >= 0"},
      {"disc-pile --level fast", "acceleration or velocity"},
      {"disc-pile --duration 2", "--animate"},
      {"disc-pile --animate " + Path("x.svg"), ".html"},
      {"disc-pile --duration 0 --animate " + Path("x.html"), "--duration"},
      {Path("missing.json"), "missing.json"},
      {Path("wrong.json"), "wrong.json"}};
  for (const auto& [arguments, words] : mistakes) ExpectMistake("scene " + arguments, words);
}

}  // namespace
}  // namespace lcpbench
