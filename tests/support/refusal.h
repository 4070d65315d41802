#pragma once

#include "support/input_error.h"
#include "tests/support/test.h"

namespace lcpbench {

inline std::string ReadFile(const std::filesystem::path& path) {
  return (std::stringstream() << std::ifstream(path, std::ios::binary).rdbuf()).str();
}

/// The text of the InputError that `act` throws; "" where it throws none.
template <typename Act>
std::string RefusalOf(Act act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// `act` is refused in one line that begins with `beginning` and holds `words`.
template <typename Act>
void ExpectRefused(Act act, const std::string& words, const std::string& beginning = "") {
  const std::string refusal = RefusalOf(act);
  EXPECT_NE(refusal, "") << "accepted; expected " << words;
  EXPECT_NE(refusal.find(words), std::string::npos) << refusal << "\nexpected: " << words;
  EXPECT_TRUE(refusal.starts_with(beginning)) << refusal;
  EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
}

/// What is refused, and how, by tests/data/refusals/<name>.txt. Fields of a line are separated by " => ", and \n in one
/// stands for a line break; what a line lacks of three fields is "". Empty lines and those with # in front do not
/// count.
inline std::vector<std::vector<std::string>> RefusalCases(const std::string& name) {
  const std::string separator = " => ";
  std::ifstream file(LCPBENCH_SOURCE_DIR "/tests/data/refusals/" + name + ".txt");
  std::vector<std::vector<std::string>> cases;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.starts_with("#")) continue;
    for (std::size_t at = 0; (at = line.find("\\n", at)) != std::string::npos; ++at) line.replace(at, 2, "\n");
    std::vector<std::string>& fields = cases.emplace_back();
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + separator.size()) {
      end = line.find(separator, begin);
      fields.push_back(line.substr(begin, end - begin));
    }
    fields.resize(3);
  }
  EXPECT_FALSE(cases.empty()) << name;
  return cases;
}

/// A folder of its own for each test of files.
class FolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  void Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(Path(name), std::ios::binary) << bytes;
  }
  std::string Bytes(const std::string& name) const { return ReadFile(folder_ / name); }

  const ::testing::TestInfo& test_ = *::testing::UnitTest::GetInstance()->current_test_info();
  std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) / (std::string(test_.test_suite_name()) + "-" + test_.name());
};

}  // namespace lcpbench
