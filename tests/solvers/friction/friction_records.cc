#include "tests/solvers/friction/friction_records.h"

#include <boost/multiprecision/cpp_int.hpp>
#include <fstream>
#include <stdexcept>

namespace lcpbench {

const std::vector<FrictionRecord>& FrictionRecords() {
  static const std::vector<FrictionRecord> records = [] {
    std::vector<FrictionRecord> all;
    for (const char* name : {"friction.jsonl", "friction_counterexamples.jsonl"}) {
      const std::string path = std::string(LCPBENCH_SOURCE_DIR) + "/tests/data/oracle/" + name;
      std::ifstream file(path);
      if (!file) throw std::runtime_error("cannot read " + path);
      for (std::string line; std::getline(file, line);) {
        all.push_back({line, ParseLcpRecord(line, path), nlohmann::json::parse(line)});
      }
    }
    return all;
  }();
  return records;
}

Eigen::VectorXd ToVector(const nlohmann::json& numbers) {
  Eigen::VectorXd vector(static_cast<Index>(numbers.size()));
  for (Index i = 0; i < vector.size(); ++i) {
    const nlohmann::json& number = numbers[static_cast<size_t>(i)];
    vector[i] = number.is_string() ? boost::multiprecision::cpp_rational(number.get<std::string>()).convert_to<double>()
                                   : number.get<double>();
  }
  return vector;
}

std::vector<Eigen::VectorXd> KnownSolutions(const FrictionRecord& record) {
  std::vector<Eigen::VectorXd> solutions;
  if (!record.is_solved()) return solutions;
  if (record.json.contains("f_exact")) solutions.push_back(ToVector(record.json["f_exact"]));
  if (!record.json.contains("pieces")) return solutions;
  for (const nlohmann::json& piece : record.json["pieces"]) {
    for (const nlohmann::json& vertex : piece["vertices"]) {
      solutions.push_back(ToVector(vertex));
      for (const char* directions : {"rays", "lines"}) {
        for (const nlohmann::json& direction : piece[directions]) {
          solutions.push_back(ToVector(vertex) + ToVector(direction));
        }
      }
    }
  }
  return solutions;
}

}  // namespace lcpbench
