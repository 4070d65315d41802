#include "solvers/io/text_words.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "solvers/io/gzip_file.h"
#include "support/input_error.h"
#include "support/number_text.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

constexpr std::string_view kSpace = " \t\r\v\f";

}  // namespace

TextWords::TextWords(std::istream& input, std::string name) : input_(input), name_(std::move(name)) {}

bool TextWords::NextLine() {
  const bool is_there = static_cast<bool>(std::getline(input_, line_));
  if (is_there) {
    ++number_;
  } else {
    line_.clear();
  }
  rest_ = line_;
  return is_there;
}

bool TextWords::NextData(char comment) {
  while (NextLine()) {
    const auto first = line_.find_first_not_of(kSpace);
    if (first != std::string::npos && line_[first] != comment) return true;
  }
  return false;
}

std::string_view TextWords::Word() {
  const auto begin = std::min(rest_.find_first_not_of(kSpace), rest_.size());
  const auto end = std::min(rest_.find_first_of(kSpace, begin), rest_.size());
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_ = rest_.substr(end);
  return word;
}

std::int64_t TextWords::Integer(std::int64_t least, std::int64_t most, const std::string& what) {
  const std::string_view word = Word();
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_whole = error == std::errc() && end == word.data() + word.size();
  if (is_whole && least <= value && value <= most) return value;
  Reject(what + " from " + std::to_string(least) + " to " + std::to_string(most), word);
}

double TextWords::Number() {
  const std::string_view word = Word();
  const std::optional<double> value = ParseNumber(word);
  if (!value) Reject("a finite number", word);
  return *value;
}

void TextWords::Expect(std::string_view expected) {
  const std::string_view word = Word();
  if (word != expected) Reject(expected.empty() ? "the end of the line" : "'" + std::string(expected) + "'", word);
}

void TextWords::Reject(const std::string& expected, std::string_view found) const {
  constexpr std::size_t kLongest = 40;
  throw InputError(Place() + "expected " + expected + ", found " +
                   (found.empty() ? "nothing" : "'" + Excerpt(found, kLongest) + "'"));
}

void TextWords::RejectEnd(const std::string& expected) const {
  throw InputError(Place() + "expected " + expected + ", found the end of the file");
}

// An empty file ends on its first line.
std::string TextWords::Place() const { return name_ + ":" + std::to_string(std::max<std::size_t>(number_, 1)) + ": "; }

std::string RoundTripDigits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

void WriteFile(const std::string& path, const std::function<void(std::ostream&)>& write) {
  TextOrGzipOutput file(path);
  write(file.stream());
  file.Close();
}

}  // namespace lcpbench
