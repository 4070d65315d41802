#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/support/refusal.h"

namespace lcpbench {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct CommandOutcome {
  int status = -1;
  std::string out;
  std::string error;
};

inline std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}
inline std::vector<std::string> Lines(const std::string& text) { return Split(text, '\n'); }

/// A JSON value of each line.
inline std::vector<Json> Records(const std::string& text) {
  std::vector<Json> records;
  for (const std::string& line : Lines(text)) records.push_back(Json::parse(line));
  return records;
}
inline std::vector<Json> JsonLines(const fs::path& path) { return Records(ReadFile(path)); }
inline Json ReadJson(const fs::path& path) { return Json::parse(ReadFile(path)); }

/// `found` has these members.
inline void ExpectHas(const Json& found, const Json& members) {
  for (const auto& [name, value] : members.items())
    EXPECT_EQ(found.value(name, Json()), value) << name << " of " << found;
}
/// A text, or an error, has this part.
inline void ExpectPart(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text << "\nexpected: " << part;
}

/// A campaign's folder problem by problem: an object per problem, solver and tier with what streams.jsonl says of it in
/// arrays, in the order of the tasks, and its times `fresh_s` of all passes.
inline std::vector<Json> CellsOf(const fs::path& folder) {
  std::map<std::string, std::vector<std::string>> problems;
  for (const Json& line : JsonLines(folder / "problems.jsonl")) problems[line["size_class"]].push_back(line["problem"]);
  std::vector<Json> cells;
  std::map<std::string, std::size_t> places;
  for (const Json& line : JsonLines(folder / "streams.jsonl")) {
    const auto place = [&](std::size_t k) -> std::size_t& {
      const std::string problem = problems.at(line["size_class"]).at(line["first"].get<std::size_t>() + k);
      return places[problem + "|" + line["solver"].get<std::string>() + "|" + line["tier"].dump()];
    };
    if (line["kind"] == "fresh") {
      for (std::size_t k = 0; k < line["fresh_s"].size(); ++k) {
        if (line["fresh_s"][k].is_number()) cells.at(place(k))["fresh_s"].push_back(line["fresh_s"][k]);
      }
    }
    if (line["kind"] != "judge") continue;
    const bool excluded = line["excluded"] != "";
    for (std::size_t k = 0; k < line[excluded ? "count" : "attempted"]; ++k) {
      Json cell = {{"problem", problems.at(line["size_class"]).at(line["first"].get<std::size_t>() + k)},
                   {"solver", line["solver"]},
                   {"tier", line["tier"]},
                   {"excluded", line["excluded"]},
                   {"claim", "solved"},
                   {"passes", !excluded},
                   {"at_floor", false},
                   {"false_success", false},
                   {"reason", ""},
                   {"detail", ""},
                   {"fresh_s", Json::array()}};
      for (const auto& [field, values] : line.items()) {
        if (values.is_array() && field != "exceptions") cell[field] = values[k];
      }
      for (const Json& exception : line.value("exceptions", Json::array())) {
        if (exception["at"] == k) cell.update(exception);
      }
      if (cell["claim"] == "excluded") cell["excluded"] = cell["reason"];
      place(k) = cells.size();
      cells.push_back(std::move(cell));
    }
  }
  return cells;
}

/// Runs the lcpbench command, or another program, in a folder of the test's own.
class CommandTest : public FolderTest {
 protected:
  CommandOutcome Run(const std::string& arguments, const std::string& input = "") {
    Write("stdin", input);
    const std::string command =
        program_ + " " + arguments + " < " + Path("stdin") + " > " + Path("stdout") + " 2> " + Path("stderr");
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(folder_ / "stdout"), ReadFile(folder_ / "stderr")};
  }

  /// Run, of what succeeds.
  CommandOutcome Succeed(const std::string& arguments, const std::string& input = "") {
    CommandOutcome outcome = Run(arguments, input);
    EXPECT_EQ(outcome.status, 0) << arguments << "\n" << outcome.error;
    return outcome;
  }

  /// What a command that succeeds says: a JSON value, or one on each line.
  Json Answer(const std::string& arguments, const std::string& input = "") {
    return Json::parse(Succeed(arguments, input).out);
  }
  std::vector<Json> Answers(const std::string& arguments, const std::string& input = "") {
    return Records(Succeed(arguments, input).out);
  }

  /// Run, of a user's mistake: status 2, and one line that has the text.
  void ExpectMistake(const std::string& arguments, const std::string& text, const std::string& input = "") {
    const CommandOutcome outcome = Run(arguments, input);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
    ExpectPart(outcome.error, text);
    EXPECT_EQ(Lines(outcome.error).size(), 1U) << outcome.error;
  }

  /// With each text in the place of the second line of a campaign's file, `resume` is a mistake that names the line and
  /// holds the words, and leaves the file as it was.
  void ExpectSecondLineRefused(const std::string& file, const std::vector<std::pair<std::string, std::string>>& wrong,
                               const std::string& resume) {
    const std::string kept = ReadFile(folder_ / file);
    for (const auto& [text, words] : wrong) {
      std::vector<std::string> lines = Lines(kept);
      lines.at(1) = text;
      std::string changed;
      for (const std::string& line : lines) changed += line + "\n";
      Write(file, changed);
      ExpectMistake(resume, fs::path(file).filename().string() + ":2: ");
      ExpectPart(ReadFile(folder_ / "stderr"), words);
      EXPECT_EQ(ReadFile(folder_ / file), changed);
    }
    Write(file, kept);
  }

  /// The command in the background, the first of a process group, with its errors to a file. @return its process
  pid_t Start(const std::string& arguments, const std::string& errors) const {
    const pid_t child = fork();
    if (child == 0) {
      setpgid(0, 0);
      const std::string command = "exec " + program_ + " " + arguments + " > /dev/null 2> " + Path(errors);
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    setpgid(child, child);  // whoever is first
    return child;
  }

  /// Lets the command run, with its errors to the file "stderr", until `file` has grown by so many bytes, so that it is
  /// in the midst of its work however fast the machine is; then it gets the signal, alone or with its process group,
  /// `once` or until it has ended.
  /// @return its status, as waitpid gives it
  int RunUntil(const std::string& file, std::uintmax_t growth, int signal, bool whole_group,
               const std::string& arguments, bool once = false) const {
    // The size of the file, or of what is to take its place when it is complete (TextOutput).
    const auto size = [&] {
      std::error_code none;
      const std::uintmax_t bytes = fs::file_size(folder_ / file, none);
      if (!none) return bytes;
      std::uintmax_t beside = 0;
      for (const auto& entry : fs::directory_iterator(folder_)) {
        const bool is_beside = entry.path().filename().string().starts_with(".lcpbench-");
        const std::uintmax_t found = is_beside ? entry.file_size(none) : 0;
        if (!none) beside += found;
      }
      return beside;
    };
    const std::uintmax_t enough = size() + growth;
    const pid_t child = Start(arguments, "stderr");
    int status = 0;
    bool is_sent = false;
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (size() >= enough && !(once && is_sent)) is_sent = kill(whole_group ? -child : child, signal) == 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return status;
  }

  std::string program_ = LCPBENCH_COMMAND;
};

}  // namespace lcpbench
