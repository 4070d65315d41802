#include "benchmarks/drawing/animation.h"

#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "benchmarks/drawing/animation_page.h"
#include "model/shape/shapes.h"
#include "support/input_error.h"
#include "tests/benchmarks/command_fixture.h"
#include "tests/benchmarks/free_flight.h"

namespace lcpbench {
namespace {

/// Reads a page's frames as animation_page.h describes them, independently of the page's script.
class Unpacker {
 public:
  Unpacker(const AnimationData& data, std::size_t frames) : frames_(frames) {
    std::vector<unsigned char> packed(data.frames.size());
    EXPECT_GT(EVP_DecodeBlock(packed.data(), reinterpret_cast<const unsigned char*>(data.frames.data()),
                              static_cast<int>(data.frames.size())),
              0);
    std::vector<unsigned char> bytes(std::size_t{1} << 26U);
    uLongf size = bytes.size();
    EXPECT_EQ(uncompress(bytes.data(), &size, packed.data(), packed.size()), Z_OK);
    for (std::size_t i = 0; i < size / 2; ++i) words_.push_back(bytes[i] + 256U * bytes[size / 2 + i]);
  }

  std::vector<unsigned> Track() {
    std::vector<unsigned> track;
    unsigned slope = 0;
    unsigned word = 0;
    for (std::size_t k = 0; k < frames_; ++k) {
      slope = (slope + words_[at_++]) & 0xFFFFU;
      word = (word + slope) & 0xFFFFU;
      track.push_back(word);
    }
    return track;
  }

  /// [frame][element][column].
  std::vector<std::vector<std::vector<double>>> Lists(const nlohmann::ordered_json& columns) {
    std::vector<std::vector<std::vector<double>>> lists(frames_);
    for (auto& list : lists) list.assign(words_[at_++], {});
    for (const auto& column : columns) {
      std::vector<unsigned> before;
      for (auto& list : lists) {
        std::vector<unsigned> now;
        for (std::size_t i = 0; i < list.size(); ++i) {
          now.push_back((words_[at_++] + (i < before.size() ? before[i] : 0U)) & 0xFFFFU);
          list[i].push_back(column[0].get<double>() + column[1].get<double>() * now[i]);
        }
        before = now;
      }
    }
    return lists;
  }

  bool finished() const { return at_ == words_.size(); }

 private:
  std::size_t frames_;
  std::vector<unsigned> words_;
  std::size_t at_ = 0;
};

Animation Fly(int discs, const AnimationOptions& options) {
  FreeFlight flight(ThrownDiscs(discs));
  return RecordAnimation(&flight, options);
}

TEST(AnimationRecording, TakesAFrameAtTheStartAndAfterEveryFrameTime) {
  const Animation animation = Fly(3, {.duration = 0.5, .fps = 30});
  ASSERT_EQ(animation.frames.size(), 16U);
  for (std::size_t k = 0; k < animation.frames.size(); ++k) {
    const AnimationFrame& frame = animation.frames[k];
    const double t = static_cast<double>(k) / 30;
    EXPECT_NEAR(frame.time, t, 1e-14);
    EXPECT_NEAR(frame.poses[2].x.y, 1 + 5 * t - kGravity / 2 * t * t, 1e-12);
    EXPECT_NEAR(frame.poses[3].theta, 3 * t, 1e-12);
    EXPECT_NEAR(frame.kinetic + frame.potential, animation.frames[0].kinetic + animation.frames[0].potential, 1e-10);
  }
  EXPECT_EQ(animation.statistics.steps, 15);
  EXPECT_EQ(animation.stopped, "");
}

TEST(AnimationRecording, EndsWhereTheMotionStops) {
  FreeFlight flight(ThrownDiscs(1));
  const Animation animation = RecordAnimation(&flight, {.duration = 1, .fps = 10}, [&](double share) {
    if (share > 0.35) flight.Stop("too many events");
  });
  EXPECT_EQ(animation.frames.size(), 5U);
  EXPECT_EQ(animation.stopped, "too many events");
}

TEST(AnimationRecording, RefusesImpossibleOptions) {
  FreeFlight flight(ThrownDiscs(1));
  EXPECT_THROW(RecordAnimation(&flight, {.duration = 0, .fps = 60}), InputError);
  EXPECT_THROW(RecordAnimation(&flight, {.duration = NAN, .fps = 60}), InputError);
  EXPECT_THROW(RecordAnimation(&flight, {.duration = 1, .fps = -1}), InputError);
  EXPECT_THROW(RecordAnimation(&flight, {.duration = 1000, .fps = 60}), InputError);
}

/// A motion that reports one contact, force 3 N upwards on disc 1.
FreeFlight Touching(MotionProblemKind kind) {
  FreeFlight flight(ThrownDiscs(2));
  flight.kind = kind;
  Constraint contact;
  contact.body1 = 1;
  contact.body2 = 0;
  flight.system.bodies = flight.world().bodies;
  flight.system.constraints = {contact};
  RowInfo row;
  row.p1 = row.p2 = {0.25, 0.5};
  row.n = {0, 1};
  flight.rows = {row};
  flight.result.f = Eigen::VectorXd::Constant(1, 3);
  return flight;
}

TEST(AnimationRecording, ShowsForcesAsTheyAreAndImpulsesOfTimeStepsDividedByTheStep) {
  for (const MotionProblemKind kind : {MotionProblemKind::kAcceleration, MotionProblemKind::kTimeStep}) {
    FreeFlight flight = Touching(kind);
    const Animation animation = RecordAnimation(&flight, {.duration = 0.2, .fps = 10});
    const double step = kind == MotionProblemKind::kTimeStep ? FreeFlight::kStep : 1;
    ASSERT_EQ(animation.frames.size(), 3U);
    for (const AnimationFrame& frame : animation.frames) {
      ASSERT_EQ(frame.forces.size(), 1U);
      EXPECT_NEAR(frame.forces[0].force.y, 3 / step, 1e-9 / step);
      EXPECT_EQ(frame.forces[0].force.x, 0);
      EXPECT_EQ(frame.forces[0].at.x, 0.25);
      EXPECT_TRUE(frame.impacts.empty());
    }
  }
}

TEST(AnimationRecording, ShowsImpactsInTheFrameAfterThem) {
  FreeFlight flight = Touching(MotionProblemKind::kImpact);
  const Animation animation = RecordAnimation(&flight, {.duration = 0.2, .fps = 10});
  EXPECT_TRUE(animation.frames[0].impacts.empty());
  for (std::size_t k = 1; k < 3; ++k) {
    ASSERT_EQ(animation.frames[k].impacts.size(), 1U);
    EXPECT_EQ(animation.frames[k].impacts[0].force, (Vec2{0, 3}));
    EXPECT_TRUE(animation.frames[k].forces.empty());
  }
}

TEST(AnimationData, KeepsPositionsToTheirOwnTravelAndAnglesToATenthOfAMilliradian) {
  const Animation animation = Fly(7, {.duration = 2, .fps = 60});
  const AnimationData data = PackAnimation(animation);
  Unpacker unpacker(data, animation.frames.size());
  int tracks = 0;
  for (std::size_t i = 0; i < animation.world.bodies.size(); ++i) {
    const auto& body = data.scene["bodies"][i];
    ASSERT_EQ(body.contains("track"), i > 0) << "the floor rests";
    if (i == 0) continue;
    ++tracks;
    const std::vector<double> track = body["track"];
    const std::vector<unsigned> x = unpacker.Track();
    const std::vector<unsigned> y = unpacker.Track();
    const std::vector<unsigned> theta = unpacker.Track();
    for (std::size_t k = 0; k < animation.frames.size(); ++k) {
      const BodyPose& pose = animation.frames[k].poses[i];
      EXPECT_NEAR(track[0] + track[1] * x[k], pose.x.x, 2 * 0.1 * 7 / 65535);
      EXPECT_NEAR(track[2] + track[3] * y[k], pose.x.y, 20.0 / 65535);
      EXPECT_NEAR(std::remainder(theta[k] * 2 * kPi / 65536 - pose.theta, 2 * kPi), 0, 1e-4);
    }
  }
  EXPECT_EQ(tracks, 7);
  for (const auto& list : unpacker.Lists(data.scene["forces"])) EXPECT_TRUE(list.empty());
  for (const auto& list : unpacker.Lists(data.scene["impacts"])) EXPECT_TRUE(list.empty());
  EXPECT_TRUE(unpacker.finished());
}

TEST(AnimationData, KeepsForcesThatChangeInNumberAndLeavesOutFaintOnes) {
  Animation animation = Fly(1, {.duration = 0.5, .fps = 10});
  Random random(4);
  for (std::size_t k = 0; k < animation.frames.size(); ++k) {
    for (std::size_t i = 0; i < (5 * k) % 7; ++i) {
      const Vec2 at = random.InUnitDisc();
      animation.frames[k].forces.push_back({at, 10 * random.UnitVector()});
      animation.frames[k].impacts.push_back({at, {random.Uniform(1, 2), 0}});
    }
    animation.frames[k].forces.push_back({{}, {1e-3, 0}});
  }
  const AnimationData data = PackAnimation(animation);
  Unpacker unpacker(data, animation.frames.size());
  for (int track = 0; track < 3; ++track) unpacker.Track();
  const auto forces = unpacker.Lists(data.scene["forces"]);
  const auto impacts = unpacker.Lists(data.scene["impacts"]);
  EXPECT_TRUE(unpacker.finished());
  const double place = 0.6 * kVisiblePlace;  // of discs of that diameter
  for (std::size_t k = 0; k < animation.frames.size(); ++k) {
    const AnimationFrame& frame = animation.frames[k];
    ASSERT_EQ(forces[k].size(), frame.forces.size() - 1);
    ASSERT_EQ(impacts[k].size(), frame.impacts.size());
    for (std::size_t i = 0; i < forces[k].size(); ++i) {
      EXPECT_NEAR(forces[k][i][0], frame.forces[i].at.x, place);
      EXPECT_NEAR(forces[k][i][1], frame.forces[i].at.y, place);
      EXPECT_NEAR(forces[k][i][2], frame.forces[i].force.x, 10 * kVisibleForce);
      EXPECT_NEAR(forces[k][i][3], frame.forces[i].force.y, 10 * kVisibleForce);
      EXPECT_NEAR(impacts[k][i][2], frame.impacts[i].force.x, 2 * kVisibleForce);
    }
  }
}

/// Bodies and frames that nothing makes easy to compress: what a crowded pile gives.
Animation Crowd(int bodies, int frames) {
  Animation animation;
  animation.world = ThrownDiscs(bodies);
  Random random(9);
  AnimationFrame frame;
  for (const Body& body : animation.world.bodies) frame.poses.push_back({body.x, body.theta});
  for (int i = 0; i < 2 * bodies; ++i) frame.forces.push_back({{0.5 * i, random.Uniform()}, random.UnitVector()});
  for (int k = 0; k < frames; ++k) {
    for (std::size_t i = 1; i < frame.poses.size(); ++i) {
      frame.poses[i].x = frame.poses[i].x + 1e-2 * random.InUnitDisc();
      frame.poses[i].theta += 1e-2 * random.Uniform(-1, 1);
    }
    for (DrawnForce& force : frame.forces) {
      force.at = force.at + 1e-3 * random.InUnitDisc();
      force.force = force.force + 1e-2 * random.InUnitDisc();
    }
    frame.time = k / animation.fps;
    animation.frames.push_back(frame);
  }
  return animation;
}

// A tenth of a thousand bodies in 600 frames, which then stay below 10 MB.
TEST(AnimationPage, OfAHundredJitteringBodiesStaysBelowAMegabyte) {
  const std::size_t size = RenderAnimationPage(Crowd(100, 600)).size();
  RecordProperty("bytes", static_cast<int>(size));
  EXPECT_LT(size, 1'000'000U);
}

TEST(AnimationPage, NeedsNothingElseAndEscapesNames) {
  Animation animation = Fly(2, {.duration = 0.2, .fps = 10});
  animation.world.name = "a <b> & \"c\"";
  animation.world.bodies[1].name = "</script><script>alert(1)</script>";
  const std::string page = RenderAnimationPage(animation);
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find(" src="), std::string::npos);
  EXPECT_EQ(page.find("{{"), std::string::npos);
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  EXPECT_NE(page.find("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"), std::string::npos);
}

/// What a headless Chromium makes of a page.
class AnimationInBrowser : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
      if (browser_.empty() && std::system(("command -v " + std::string(name) + " > /dev/null 2>&1").c_str()) == 0) {
        browser_ = name;
      }
    }
    if (browser_.empty()) GTEST_SKIP() << "no Chromium on this machine: the page is not opened";
  }

  struct Outcome {
    std::string verdict;            ///< of the page's self-test
    std::string sample;             ///< the poses that it read
    std::vector<std::string> said;  ///< everything else on the console
  };

  /// What animation_selftest.js finds at a window size. Not by --dump-dom, which does not wait for animation frames:
  /// the browser runs until the verdict is on the console.
  Outcome SelfTest(std::string page, const std::string& size) const {
    page.insert(page.rfind("})();"), ReadFile(LCPBENCH_SOURCE_DIR "/tests/benchmarks/drawing/animation_selftest.js"));
    Write("page.html", page);
    const std::string command = browser_ + " --headless --no-sandbox --disable-gpu --user-data-dir=" + Path("profile") +
                                " --enable-logging=stderr --window-size=" + size + " 'file://" + Path("page.html") +
                                "' > " + Path("log") +
                                " 2>&1 & browser=$!; for i in $(seq 900); do grep -Eq '\"selftest (passed|failed)' " +
                                Path("log") + " && break; sleep 0.1; done; kill $browser; wait $browser; true";
    EXPECT_EQ(std::system(command.c_str()), 0);
    Outcome outcome;
    std::istringstream lines(ReadFile(Path("log")));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t at = line.find("CONSOLE");
      if (at == std::string::npos) continue;
      const std::size_t begin = line.find('"', at) + 1;
      const std::string text = line.substr(begin, line.rfind("\", source:") - begin);
      if (text.starts_with("selftest sample ")) {
        outcome.sample = text.substr(16);
      } else if (text.starts_with("selftest ")) {
        outcome.verdict = text.substr(9);
      } else {
        outcome.said.push_back(text);
      }
    }
    return outcome;
  }

  std::string browser_;
};

/// One of everything that the page draws.
World Exhibition() {
  World world = ThrownDiscs(3);
  int place = 0;
  for (const Outline& outline : {Ring(0.5, 0.3), Gear({}), Superellipse(0.5, 0.3, 6), Ellipse(0.5, 0.3)}) {
    Body body = MakeBody(outline, 1);
    body.x = {1.5 * place++, 3};
    body.omega = 2;
    world.bodies.push_back(body);
  }
  Body drum = MakeFixed("drum");
  for (const OutlinePiece& piece : AllPieces(Ring(1, 0.9))) drum.outline.push_back(piece);
  drum.x = {6, 3};
  drum.omega = 1;
  world.bodies.push_back(drum);
  Body point;
  point.name = "point";
  point.x = {-1, 2};
  world.bodies.push_back(point);
  const auto joint = [&](ConstraintType type, int body1, int body2) {
    Constraint constraint{type, body1, body2, Vertex{{0.1, 0}}, Vertex{{0, 0.1}}, {}, {}, 0, 3};
    if (type == ConstraintType::kPathJoint) constraint.feature2 = EllipseEdge{{}, 2, 1, 0.3, Side::kConvex};
    world.joints.push_back(constraint);
  };
  joint(ConstraintType::kPin, 1, 2);
  joint(ConstraintType::kPathJoint, 4, 0);
  joint(ConstraintType::kRod, 2, 3);
  joint(ConstraintType::kRope, 5, 6);
  world.loads.springs.push_back({{6, {}}, {7, {}}, 1, 1});
  world.loads.dampers.push_back({{6, {}}, {8, {}}, 1});
  return world;
}

TEST_F(AnimationInBrowser, PlaysPausesScrubsAndListensToKeysWithoutErrors) {
  FreeFlight flight(Exhibition());
  const Animation animation = RecordAnimation(&flight, {.duration = 1, .fps = 60});
  const std::string page = RenderAnimationPage(animation);
  for (const char* size : {"1280,900", "500,800"}) {
    const Outcome outcome = SelfTest(page, size);
    EXPECT_EQ(outcome.said, std::vector<std::string>());
    ASSERT_EQ(outcome.verdict, "passed") << size;
    // The page's own reading of the frames against the motion.
    const auto poses = nlohmann::json::parse(outcome.sample);
    const std::size_t last = animation.frames.size() - 1;
    for (std::size_t s = 0; s < 3; ++s) {
      const AnimationFrame& frame = animation.frames[s * last / 2];
      for (std::size_t i = 0; i < frame.poses.size(); ++i) {
        EXPECT_NEAR(poses[s][i][0].get<double>(), frame.poses[i].x.x, 1e-4);
        EXPECT_NEAR(poses[s][i][1].get<double>(), frame.poses[i].x.y, 1e-4);
        EXPECT_NEAR(std::remainder(poses[s][i][2].get<double>() - frame.poses[i].theta, 2 * kPi), 0, 1e-4);
      }
    }
  }
}

TEST_F(AnimationInBrowser, ShowsAThousandBodies) {
  const Outcome outcome = SelfTest(RenderAnimationPage(Crowd(1000, 60)), "1280,900");
  EXPECT_EQ(outcome.said, std::vector<std::string>());
  EXPECT_EQ(outcome.verdict, "passed");
}

}  // namespace
}  // namespace lcpbench
