#include "benchmarks/drawing/animation.h"

#include <openssl/evp.h>
#include <zlib.h>

#include "tests/benchmarks/command/command_fixture.h"
#include "tests/benchmarks/drawing/free_flight.h"

namespace lcpbench {
namespace {

/// Reads a page's frames as animation.h describes them, independently of the page's script.
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
  for (const auto& [duration, fps] : {std::pair{0.0, 60.0}, {NAN, 60.0}, {1.0, -1.0}, {1000.0, 60.0}}) {
    EXPECT_THROW(RecordAnimation(&flight, {duration, fps}), InputError) << duration << " " << fps;
  }
}

// One contact, 3 N or N s upwards on disc 1: forces are shown as they are, impulses of time steps divided by the step,
// impacts in the frame after them.
TEST(AnimationRecording, ShowsForcesAndImpacts) {
  for (const auto kind : {MotionProblemKind::kAcceleration, MotionProblemKind::kTimeStep, MotionProblemKind::kImpact}) {
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
    const std::vector<AnimationFrame> frames = RecordAnimation(&flight, {.duration = 0.2, .fps = 10}).frames;
    const double step = kind == MotionProblemKind::kTimeStep ? FreeFlight::kStep : 1;
    const bool is_impact = kind == MotionProblemKind::kImpact;
    ASSERT_EQ(frames.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(frames[k].forces.size(), is_impact ? 0U : 1U);
      EXPECT_EQ(frames[k].impacts.size(), is_impact && k > 0 ? 1U : 0U);
      for (const auto& [at, force, slides] : is_impact ? frames[k].impacts : frames[k].forces) {
        EXPECT_FALSE(slides);
        EXPECT_EQ(at, (Vec2{0.25, 0.5}));
        EXPECT_EQ(force.x, 0);
        EXPECT_NEAR(force.y, 3 / step, 1e-9 / step);
      }
    }
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
  for (const char* name : {"forces", "slides", "cones", "impacts"}) {
    for (const auto& list : unpacker.Lists(data.scene[name])) EXPECT_TRUE(list.empty());
  }
  EXPECT_TRUE(unpacker.finished());
}

TEST(AnimationData, KeepsForcesThatChangeInNumberAndLeavesOutFaintOnes) {
  Animation animation = Fly(1, {.duration = 0.5, .fps = 10});
  Random random(4);
  for (std::size_t k = 0; k < animation.frames.size(); ++k) {
    for (std::size_t i = 0; i < (5 * k) % 7; ++i) {
      const Vec2 at = random.InUnitDisc();
      const Vec2 force = 10 * random.UnitVector();
      animation.frames[k].forces.push_back({at, force});
      animation.frames[k].forces.push_back({at, -force, true});
      for (const double size : {1e-4, 1.0}) animation.frames[k].cones.push_back({at, size * force});
      animation.frames[k].impacts.push_back({at, {random.Uniform(1, 2), 0}});
    }
    animation.frames[k].forces.push_back({{}, {1e-3, 0}});
  }
  const AnimationData data = PackAnimation(animation);
  Unpacker unpacker(data, animation.frames.size());
  for (int track = 0; track < 3; ++track) unpacker.Track();
  const auto forces = unpacker.Lists(data.scene["forces"]);
  const auto slides = unpacker.Lists(data.scene["slides"]);
  const auto cones = unpacker.Lists(data.scene["cones"]);
  const auto impacts = unpacker.Lists(data.scene["impacts"]);
  EXPECT_TRUE(unpacker.finished());
  const double place = 0.6 * kVisiblePlace;  // of discs of that diameter
  for (std::size_t k = 0; k < animation.frames.size(); ++k) {
    const AnimationFrame& frame = animation.frames[k];
    ASSERT_EQ(2 * forces[k].size(), frame.forces.size() - 1);
    ASSERT_EQ(slides[k].size(), forces[k].size());
    ASSERT_EQ(cones[k].size(), frame.cones.size());
    ASSERT_EQ(impacts[k].size(), frame.impacts.size());
    for (std::size_t i = 0; i < forces[k].size(); ++i) {
      const Vec2 at = frame.forces[2 * i].at;
      const Vec2 force = frame.forces[2 * i].force;
      EXPECT_LE(Norm(Vec2{forces[k][i][0], forces[k][i][1]} - at), std::sqrt(2) * place);
      EXPECT_LE(Norm(Vec2{forces[k][i][2], forces[k][i][3]} - force), std::sqrt(2) * 10 * kVisibleForce);
      EXPECT_LE(Norm(Vec2{slides[k][i][2], slides[k][i][3]} + force), std::sqrt(2) * 10 * kVisibleForce);
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
  EXPECT_LT(RenderAnimationPage(Crowd(100, 600)).size(), 1'000'000U);
}

TEST(AnimationPage, NeedsNothingElseAndEscapesNames) {
  Animation animation = Fly(2, {.duration = 0.2, .fps = 10});
  animation.world.name = "a <b> & \"c\"";
  animation.world.bodies[1].name = "</script><script>alert(1)</script>";
  const std::string page = RenderAnimationPage(animation);
  for (const char* bad : {"http", " src=", "{{", "alert(1)</script>"}) EXPECT_EQ(page.find(bad), std::string::npos);
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

  /// What animation_selftest.js finds at a window size; whatever else is on the console is an error. Not by --dump-dom,
  /// which does not wait for animation frames: the browser runs until the self-test has spoken.
  Json SelfTest(std::string page, const std::string& size) const {
    page.insert(page.rfind("})();"), ReadFile(LCPBENCH_SOURCE_DIR "/tests/benchmarks/drawing/animation_selftest.js"));
    Write("page.html", page);
    Write("log", "");  // that of the page before would be found while the browser starts
    const std::string command = browser_ + " --headless --no-sandbox --disable-gpu --user-data-dir=" + Path("profile") +
                                " --enable-logging=stderr --window-size=" + size + " 'file://" + Path("page.html") +
                                "' > " + Path("log") +
                                " 2>&1 & browser=$!; for i in $(seq 900); do grep -q '\"selftest ' " + Path("log") +
                                " && break; sleep 0.1; done; kill $browser; wait $browser; true";
    EXPECT_EQ(std::system(command.c_str()), 0);
    Json found = {{"errors", Json::array()}};
    std::istringstream lines(ReadFile(Path("log")));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t at = line.find("CONSOLE");
      if (at == std::string::npos) continue;
      const std::size_t begin = line.find('"', at) + 1;
      const std::string text = line.substr(begin, line.rfind("\", source:") - begin);
      if (text.starts_with("selftest ")) {
        const auto said = Json::parse(text.substr(9));
        found["poses"] = said["poses"];
        for (const auto& error : said["errors"]) found["errors"].push_back(error);
      } else {
        found["errors"].push_back(text);
      }
    }
    return found;
  }

  std::string browser_;
};

TEST_F(AnimationInBrowser, PlaysPausesScrubsAndListensToKeysWithoutErrors) {
  FreeFlight flight(Exhibition());
  const Animation exhibition = RecordAnimation(&flight, {.duration = 1, .fps = 60});
  const Animation crowd = Crowd(1000, 60);
  for (const auto& [animation, size] :
       {std::pair{&exhibition, "1280,900"}, {&exhibition, "500,800"}, {&crowd, "1280,900"}}) {
    const Json found = SelfTest(RenderAnimationPage(*animation), size);
    ASSERT_EQ(found["errors"], Json::array()) << size;
    // The page's own reading of the frames against the motion.
    const Json& poses = found["poses"];
    const std::size_t last = animation->frames.size() - 1;
    for (std::size_t s = 0; s < 3; ++s) {
      const AnimationFrame& frame = animation->frames[s * last / 2];
      for (std::size_t i = 0; i < frame.poses.size(); ++i) {
        EXPECT_NEAR(poses[s][i][0].get<double>(), frame.poses[i].x.x, 1e-4);
        EXPECT_NEAR(poses[s][i][1].get<double>(), frame.poses[i].x.y, 1e-4);
        EXPECT_NEAR(std::remainder(poses[s][i][2].get<double>() - frame.poses[i].theta, 2 * kPi), 0, 1e-4);
      }
    }
  }
}

}  // namespace
}  // namespace lcpbench
