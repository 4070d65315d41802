#include "benchmarks/collection/references.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "benchmarks/collection/gzip_file.h"
#include "solvers/lcp/verify.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

constexpr size_t kExcerpt = 40;

// Of a line; where it stands first, as our files have it, without parsing the numbers behind it.
std::string IdOf(const std::string& line) {
  constexpr std::string_view kStart = R"({"id":")";
  if (line.starts_with(kStart)) {
    const std::size_t end = line.find_first_of("\"\\", kStart.size());
    if (end != std::string::npos && line[end] == '"') return line.substr(kStart.size(), end - kStart.size());
  }
  return Json::parse(line).at("id").get<std::string>();
}

Eigen::VectorXd Numbers(const Json& values, Index size) {
  const auto numbers = values.get<std::vector<double>>();
  if (static_cast<Index>(numbers.size()) != size) {
    throw InputError("expected " + std::to_string(size) + " numbers, found " + std::to_string(numbers.size()));
  }
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), size);
}

}  // namespace

References::References(const Manifest& manifest, const std::string& folder) {
  if (manifest.references.empty()) return;
  name_ = (std::filesystem::path(folder) / manifest.references).string();
  LineReader lines(name_);
  std::string line;
  while (lines.Next(&line)) {
    try {
      std::string id = IdOf(line);
      lines_[std::move(id)] = std::move(line);
    } catch (const Json::exception&) {
      throw InputError(name_ + ": expected lines with an id, found '" + line.substr(0, kExcerpt) + "'");
    }
  }
}

std::string References::Line(const std::string& id) const {
  const auto line = lines_.find(id);
  return line == lines_.end() ? "" : line->second;
}

std::optional<KnownAnswer> References::Find(const LcpProblem& problem) const {
  const auto line = lines_.find(problem.id());
  if (line == lines_.end()) return std::nullopt;
  try {
    const Json record = Json::parse(line->second);
    KnownAnswer answer;
    if (record.at("status") == "infeasible") {
      answer.reference.status = LcpReference::Status::kInfeasible;
      return answer;
    }
    answer.reference.status = LcpReference::Status::kSolved;
    answer.reference.w = Numbers(record.at("w"), problem.size());
    answer.f = Numbers(record.contains("f_minnorm") ? record["f_minnorm"] : record.at("f"), problem.size());
    answer.reference.floor = RoundingFloor(problem, answer.f);
    const Json unique = record.value("f_unique", Json(nullptr));
    if (unique.is_boolean() && unique.get<bool>()) answer.reference.f = answer.f;
    return answer;
  } catch (const Json::exception&) {
    throw InputError(name_ + ": '" + problem.id() + "': expected an answer with status, w and f");
  } catch (const InputError& error) {
    throw InputError(name_ + ": '" + problem.id() + "': " + error.what());
  }
}

}  // namespace lcpbench
