// format_reader FORMAT: tells of every document on standard input, one a line, whether our reader of the format takes
// it ("ok"), or the reader's words. For tests/data/test_formats.py, which compares them with docs/formats/.

#include <unistd.h>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <string>

#include "benchmarks/campaign/campaign_file.h"
#include "benchmarks/campaign/result_fields.h"
#include "benchmarks/campaign/sequence_file.h"
#include "benchmarks/campaign/tuned_file.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/recording.h"
#include "benchmarks/collection/references.h"
#include "model/records/records.h"
#include "model/records/replay.h"
#include "model/scene_file/scene_file.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

constexpr char kWhere[] = "file:1";

using ReadText = std::function<void(const std::string& text)>;

// A reader that takes a path.
ReadText OfFile(const std::function<void(const std::string& path)>& read) {
  return [read](const std::string& text) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("lcpbench-format-" + std::to_string(getpid()))).string();
    std::ofstream(path) << text << '\n';
    try {
      read(path);
    } catch (...) {
      std::filesystem::remove(path);
      throw;
    }
    std::filesystem::remove(path);
  };
}

// As the known answer to a problem of two rows.
void ReadReference(const std::string& path) {
  const LcpProblem problem = LcpProblem::FromDense("two", Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1, 1), {}, {});
  Manifest manifest;
  manifest.references = std::filesystem::path(path).filename();
  const References references(manifest, std::filesystem::path(path).parent_path());
  if (!references.Find(problem)) throw InputError("id: not found");
}

void ReadSequence(const std::string& path) {
  try {
    ReadSequenceFile(path, "");
  } catch (const InputError& error) {
    if (std::string(error.what()).find(": expected the sequence with SHA-256") == std::string::npos) throw;
  }
}

// A header, or a step of two bodies in the plane or, with quaternions, in space.
void ReadRecordingLine(const std::string& text) {
  if (text.find("lcpbench_recording") != std::string::npos || text.find("\"engine\"") != std::string::npos) {
    ParseRecordingHeader(text, kWhere);
    return;
  }
  RecordingHeader header;
  header.dimension = text.find("\"q\": [[") == std::string::npos ? 2 : 3;
  header.bodies.resize(2);
  ParseRecordedStep(text, header, kWhere);
}

const std::map<std::string, ReadText> kReaders = {
    {"problem", [](const std::string& text) { ParseLcpRecord(text, kWhere); }},
    {"contact_record", [](const std::string& text) { ParseSystemRecord(text, kWhere); }},
    {"replay_record", [](const std::string& text) { ParseReplayRecord(text, kWhere); }},
    {"recording", ReadRecordingLine},
    {"scene", [](const std::string& text) { ParseScene(text, kWhere); }},
    {"manifest", OfFile([](const std::string& path) { ReadManifest(path); })},
    {"reference", OfFile(ReadReference)},
    {"sequence", OfFile(ReadSequence)},
    {"tuned", OfFile([](const std::string& path) { ReadTunedFile(path); })},
    {"campaign", OfFile([](const std::string& path) { ReadCampaignFile(path); })},
    {"campaign_lines", [](const std::string& text) { RequireFields(ParseJsonObject(text, kWhere)); }},
};

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  if (argc != 2 || lcpbench::kReaders.count(argv[1]) == 0) return 2;
  const lcpbench::ReadText& read = lcpbench::kReaders.at(argv[1]);
  for (std::string text; std::getline(std::cin, text);) {
    try {
      read(text);
      std::cout << "ok\n";
    } catch (const lcpbench::InputError& error) {
      std::cout << error.what() << '\n';
    }
  }
  return 0;
}
