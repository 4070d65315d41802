#include "benchmarks/campaign/sequences/sequence_journal.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

Json MembersOf(const SequenceEntry& sequence, const PlannedPass& pass, int round) {
  Json line;
  line["sequence"] = sequence.id;
  line["solver"] = pass.solver;
  line["tier"] = pass.tier;
  line["mode"] = pass.mode;
  line["deadline_s"] = pass.deadline_s > 0 ? Json(pass.deadline_s) : Json(nullptr);
  line["round"] = round;
  line["excluded"] = pass.excluded;
  return line;
}

}  // namespace

SequenceJournal::SequenceJournal(const std::string& path)
    : file_(path, "a pass over a sequence", [this](const nlohmann::json& line) { Note(line); }) {}

SequenceJournal::Key SequenceJournal::KeyOf(const std::string& sequence, const PlannedPass& pass) {
  return {sequence, pass.solver, TierText(pass.tier), pass.mode};
}

bool SequenceJournal::Has(const std::string& sequence, const PlannedPass& pass, int round) const {
  return done_.count({KeyOf(sequence, pass), round}) > 0;
}

std::string SequenceJournal::FirstOutcome(const std::string& sequence, const PlannedPass& pass) const {
  const auto found = first_outcomes_.find(KeyOf(sequence, pass));
  return found == first_outcomes_.end() ? "" : found->second;
}

void SequenceJournal::Note(const nlohmann::json& line) {
  const Key key(line.at("sequence").get<std::string>(), line.at("solver").get<std::string>(),
                TierText(line.at("tier").get<double>()), line.at("mode").get<std::string>());
  const int round = line.at("round").get<int>();
  done_.insert({key, round});
  if (round > 0 || !line.at("excluded").get<std::string>().empty()) return;
  first_outcomes_[key] = line.at("outcome").get<std::string>();
}

void SequenceJournal::Append(const Json& line) {
  file_.Append({line});
  Note(nlohmann::json(line));
}

void SequenceJournal::Write(const SequenceEntry& sequence, const PlannedPass& pass, int round,
                            const SequenceReply& reply, const std::string& environment_hash) {
  Json line = MembersOf(sequence, pass, round);
  line["outcome"] = reply.outcome;
  line["detail"] = reply.detail;
  line["steps"] = sequence.problems;
  const Json results =
      reply.results.empty() ? NothingReached(pass.judged, static_cast<int>(sequence.problems)) : reply.results;
  line.update(results);
  line["environment"] = environment_hash;
  Append(line);
}

void SequenceJournal::WriteExcluded(const SequenceEntry& sequence, const PlannedPass& pass) {
  Append(MembersOf(sequence, pass, 0));
}

}  // namespace lcpbench
