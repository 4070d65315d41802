// lcpbench replay and compressed input, as users meet them; and the public recordings.

#include "model/records/replay.h"
#include "solvers/io/gzip_file.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

const fs::path kRecordings = LCPBENCH_SOURCE_DIR "/tests/data/myphysicslab/contact_problems.jsonl.gz";

std::string Unzip(const fs::path& path) {
  LineReader lines(path.string());
  std::string text;
  for (std::string line; lines.Next(&line);) text += line + '\n';
  return text;
}

class ReplayCommand : public CommandTest {};

// A disc about to leave a disc: vn = 0.5 makes n' = dv/rho wrong by vn^2/rho = 0.125.
Json TwoDiscs() {
  return Json::parse(R"({"id": "two-discs", "n": 1, "bodies": [
      {"name": "upper", "fixed": false, "m": 2, "I": 1, "x": 0, "y": 2, "angle": 0.5, "vx": 3, "vy": 0.5,
       "omega": -2, "ax": 0, "ay": -10, "alpha": 0},
      {"name": "lower", "fixed": true, "m": null, "I": null, "x": 0, "y": 0, "angle": 0, "vx": 0, "vy": 0,
       "omega": 0, "ax": 0, "ay": 0, "alpha": 0}],
    "contacts": [{"kind": "curved_curved", "p": 0, "q": 1, "n": [0, 1], "normalFixed": false, "joint": false,
      "R1": [0, -1], "R2": [0, 1], "U1": [0, 0], "U2": [0, 0], "radius1": 1, "radius2": 1, "distance": 0, "vn": 0.5,
      "extra": 0}],
    "A": [0.5], "b": [-5.375]})");
}

// gzip -9 of "one\ntwo\n", twice the same member.
std::string TwoMembers() {
  const std::string member(
      "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\xff\xcb\xcf\x4b\xe5\x2a\x29\xcf\xe7\x02\x00"
      "\xe6\x0b\xba\x12\x08\x00\x00\x00",
      28);
  return member + member;
}

TEST_F(ReplayCommand, AgreesAfterTheCorrectionAndSaysHowLargeItIs) {
  Write("record.jsonl", TwoDiscs().dump() + "\n");
  const CommandOutcome table = Succeed("replay " + Path("record.jsonl"));
  EXPECT_EQ(table.error, "");
  for (const char* part : {"curved_curved", "normal-derivative"}) ExpectPart(table.out, part);
  const Json json = Answer("replay --json " + Path("record.jsonl"));
  EXPECT_TRUE(json["agrees"].get<bool>());
  ExpectHas(json["kinds"][0], {{"agree_before", 0}, {"agree_after", 1}});
  EXPECT_DOUBLE_EQ(json["corrections"][0]["largest"].get<double>(), 0.125);
}

TEST_F(ReplayCommand, DisagreementIsStatusOneAndNamesTheRow) {
  Json record = TwoDiscs();
  record["b"] = {-5.25};
  const CommandOutcome outcome = Run("replay -", record.dump() + "\n");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.error, "");
  EXPECT_NE(outcome.out.find("<stdin>:1: two-discs: b[0] (curved_curved)"), std::string::npos) << outcome.out;
}

TEST_F(ReplayCommand, MalformedRecordsAreOneLineAndStatusTwo) {
  Json record = TwoDiscs();
  record["contacts"][0]["n"] = {0, 2};
  ExpectMistake("replay -", "<stdin>:2: /contacts/0/n", "\n" + record.dump());
  record = TwoDiscs();
  record["contacts"][0]["U1"] = {0, -2};  // the centres coincide
  ExpectMistake("replay -", "<stdin>:1: system 'two-discs'", record.dump());
  EXPECT_EQ(Run("replay").status, 2);
  Succeed("replay --help");
  // A bad line does not hide the good ones.
  const CommandOutcome outcome = Run("replay --json -", "{}\n" + TwoDiscs().dump() + "\n");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(Json::parse(outcome.out)["records"], 1);
}

TEST_F(ReplayCommand, GzipMembersAreReadOneAfterAnotherAndCutOrDamagedOnesAreTold) {
  const std::string good = TwoMembers();
  Write("two.gz", good);
  EXPECT_EQ(Unzip(folder_ / "two.gz"), "one\ntwo\none\ntwo\n");
  for (const size_t length : {size_t{2}, size_t{12}, size_t{20}, good.size() / 2 + 3, good.size() - 1}) {
    Write("early.gz", good.substr(0, length));
    EXPECT_THROW(Unzip(folder_ / "early.gz"), InputError) << length;
  }
  std::string damaged = good;
  damaged[good.size() / 2 - 6] ^= 1;  // the first member's checksum
  Write("damaged.gz", damaged);
  EXPECT_THROW(Unzip(folder_ / "damaged.gz"), InputError);
  // After the lines that could be unpacked, which are no problems.
  WriteGzipFile(Path("lines.gz"), "{}\n{}\n");
  const std::string lines = ReadFile(folder_ / "lines.gz");
  const CommandOutcome outcome = Run("solve --solver dantzig -", lines.substr(0, lines.size() - 4));
  EXPECT_EQ(outcome.status, 2);
  ExpectPart(outcome.error, "gzip data end early");
}

TEST_F(ReplayCommand, PublicRecordingsAgreePlainAndCompressed) {
  const CommandOutcome compressed = Succeed("replay --json " + kRecordings.string());
  const Json json = Json::parse(compressed.out);
  EXPECT_TRUE(json["agrees"].get<bool>());
  EXPECT_EQ(json["records"], 517);
  EXPECT_EQ(json["A"]["agree"], json["records"]);
  for (const Json& kind : json["kinds"]) {
    EXPECT_EQ(kind["rows"], kind["agree_after"]) << kind;
    EXPECT_LE(kind["largest_geometry"].get<double>(), 1e-12) << kind;
  }
  EXPECT_EQ(Run("replay --json -", Unzip(kRecordings)).out, compressed.out);
}

// What the rebuilding rests on: the features it takes the records to mean are the same points and circles of a body in
// all records of a scene. Were an arm or a radius understood wrongly, by as little as the gap, they would scatter.
TEST_F(ReplayCommand, RebuiltFeaturesOfPublicRecordingsAreFixedInTheirBodies) {
  using Place = std::array<std::int64_t, 3>;
  const auto rounded = [](double x) { return static_cast<std::int64_t>(std::llround(x * 1e7)); };
  const auto place = [&](const Feature& feature) -> Place {
    if (const auto* vertex = std::get_if<Vertex>(&feature)) return {rounded(vertex->p.x), rounded(vertex->p.y), 0};
    if (const auto* arc = std::get_if<ArcEdge>(&feature)) {
      return {rounded(arc->center.x), rounded(arc->center.y), rounded(arc->radius)};
    }
    const auto& edge = std::get<StraightEdge>(feature);
    const Vec2 along = 0.5 * (edge.b - edge.a);
    return {rounded(along.x), rounded(along.y), rounded(Cross(edge.a, along))};
  };
  struct Seen {
    size_t samples = 0;
    std::map<std::string, std::set<Place>> places;  // by scene and body
  };
  std::map<std::pair<RecordedKind, int>, Seen> seen;  // by kind and side
  for (const std::string& line : Lines(Unzip(kRecordings))) {
    const ReplayRecord record = ParseReplayRecord(line, "recordings");
    const std::string scene = Json::parse(line)["scene"].get<std::string>();
    for (const RecordedContact& contact : record.contacts) {
      if (contact.kind == RecordedKind::kPathJoint) continue;  // the point of the path is another in every record
      const Constraint constraint = Rebuild(contact, record.bodies).constraint;
      for (const int side : {1, 2}) {
        const int body = side == 1 ? contact.body1 : contact.body2;
        Seen& here = seen[{contact.kind, side}];
        ++here.samples;
        here.places[scene + "/" + record.bodies[static_cast<size_t>(body)].name].insert(
            place(side == 1 ? constraint.feature1 : constraint.feature2));
      }
    }
  }
  EXPECT_EQ(seen.size(), 16u);
  for (const auto& [kind_and_side, here] : seen) {
    size_t places = 0;
    for (const auto& [body, set] : here.places) places += set.size();
    // Measured 0.07 to 0.40 (vertex/vertex, which is seldom met twice); 0.6 and more with a feature off by the gap.
    EXPECT_LT(static_cast<double>(places), 0.5 * static_cast<double>(here.samples))
        << "kind " << static_cast<int>(kind_and_side.first) << ", body " << kind_and_side.second << ": " << places
        << " places in " << here.samples << " samples";
  }
}

}  // namespace
}  // namespace lcpbench
