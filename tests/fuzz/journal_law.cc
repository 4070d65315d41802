#include <unistd.h>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "benchmarks/campaign/campaign_file.h"
#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/campaign/journal.h"
#include "benchmarks/campaign/sequence_file.h"
#include "tests/fuzz/error_law.h"
#include "tests/fuzz/laws.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

// In memory where there is such a folder.
class Folder {
 public:
  Folder() {
    const fs::path memory = "/dev/shm";
    path_ = (fs::is_directory(memory) ? memory : fs::temp_directory_path()) /
            ("lcpbench-journal-" + std::to_string(getpid()));
    fs::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code none;
    fs::remove_all(path_, none);
  }

  std::string path() const { return path_; }
  void Write(const std::string& file, const std::string& text) const { std::ofstream(path_ / file) << text; }
  std::string Read(const std::string& file) const {
    std::ostringstream text;
    text << std::ifstream(path_ / file, std::ios::binary).rdbuf();
    return text.str();
  }

 private:
  fs::path path_;
};

// A campaign of two solvers and two tiers on three problems, and of a sequence.
struct Plan {
  Plan() {
    manifests = {ReadManifest(LCPBENCH_SOURCE_DIR "/data/smoke.json")};
    plan.manifests = {"smoke.json"};
    plan.tiers = {1e-3, 1e-6};
    plan.filter = "/(disc-pile|disc-track|rockers)-n8-";
    plan.fills = false;
    problems = PlanProblems(plan, manifests);
    sequence.id = "rockers-s1";
    sequence.problems = 3;
    for (const char* solver : {"dantzig", "pgs"}) {
      Task task;
      task.solver = solver;
      task.about = "7-12";
      task.tier = 1e-6;
      task.judged = plan.tiers;
      task.end = problems.size();
      tasks.push_back(task);
      task.about = sequence.id;
      task.sequence = &sequence;
      task.mode = "warm";
      passes.push_back(task);
    }
  }

  CampaignPlan plan;
  std::vector<Manifest> manifests;
  std::vector<PlannedProblem> problems;
  SequenceEntry sequence;
  std::vector<Task> tasks, passes;
};

// A sequence is taken by its hash: that of what the file has, which the refusal names.
void ReadSequence(const std::string& path) {
  try {
    ReadSequenceFile(path, "");
  } catch (const InputError& error) {
    const std::string what = error.what();
    constexpr std::size_t kHash = 64;
    if (what.find(": expected the sequence with SHA-256") == std::string::npos) throw;
    ReadSequenceFile(path, what.substr(what.size() - kHash));
  }
}

}  // namespace

std::string BrokenJournalLaw(const std::string& text) {
  static const Plan plan;
  static const Folder folder;
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string file = text.substr(0, end);
  const std::string content = end < text.size() ? text.substr(end + 1) : "";
  const std::string path = folder.path() + "/" + file;
  const auto read = [&] {
    if (file == kCampaignFile) {
      const nlohmann::ordered_json campaign = ReadCampaignFile(path);
      if (!SameCampaign(campaign, campaign)) throw std::logic_error("a campaign is another than itself");
    } else if (file == kProblemsFile) {
      std::size_t done = 0;
      OpenProblems(path, plan.manifests, plan.problems, &done);
    } else if (file == "sequence.jsonl") {
      ReadSequence(path);
    } else {
      constexpr int kRounds = 2;
      const Launches launches{.near = kRounds, .others = 1};
      const Journal journal(folder.path(), plan.tasks, plan.passes, launches, kRounds, "hash");
    }
  };
  const bool is_journal = file == kProblemsFile || file == kStreamsFile || file == kStepsFile;
  if (!is_journal && file != kCampaignFile && file != "sequence.jsonl") return {};
  for (const char* other : {kStreamsFile, kStepsFile}) folder.Write(other, "");
  folder.Write(file, content);
  return BrokenReadingLaw(path, [&](bool* is_read) -> std::string {
    read();
    *is_read = true;
    const std::string expected = is_journal ? content.substr(0, content.rfind('\n') + 1) : content;
    if (folder.Read(file) != expected) return "the file is not its whole lines";
    read();
    return folder.Read(file) == expected ? "" : "read again, the file is another";
  });
}

}  // namespace lcpbench
