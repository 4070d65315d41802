#include "solvers/io/text_words.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>

#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr std::string_view kSpace = " \t\r\v\f";

std::optional<double> FiniteNumber(std::string_view word) {
  const std::string_view digits = !word.empty() && word.front() == '+' ? word.substr(1) : word;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || digits.empty() || end != digits.data() + digits.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

TextWords::TextWords(std::istream& input, std::string name) : input_(input), name_(std::move(name)) {}

bool TextWords::NextLine() {
  if (!std::getline(input_, line_)) {
    line_.clear();
    rest_ = line_;
    return false;
  }
  ++number_;
  rest_ = line_;
  return true;
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

std::string_view TextWords::WordOfAnyLine() {
  std::string_view word = Word();
  while (word.empty() && NextLine()) word = Word();
  return word;
}

std::string_view TextWords::PeekOfAnyLine() {
  const std::string_view word = WordOfAnyLine();
  if (!word.empty()) rest_ = std::string_view(line_).substr(static_cast<std::size_t>(word.data() - line_.data()));
  return word;
}

std::int64_t TextWords::Integer(std::int64_t least, std::int64_t most, const std::string& what) {
  return AsInteger(Word(), least, most, what);
}

double TextWords::Number() {
  const std::string_view word = Word();
  const std::optional<double> value = FiniteNumber(word);
  if (!value) Reject("a finite number", word);
  return *value;
}

std::int64_t TextWords::IntegerOfAnyLine(std::int64_t least, std::int64_t most, const std::string& what) {
  const std::string_view word = WordOfAnyLine();
  if (word.empty()) RejectEnd(what);
  return AsInteger(word, least, most, what);
}

std::vector<double> TextWords::NumbersOfAnyLine(std::int64_t count, const std::string& what) {
  std::vector<double> values;
  for (std::int64_t k = 0; k < count; ++k) {
    const auto expected = [&] {
      return "number " + std::to_string(k + 1) + " of the " + std::to_string(count) + " of " + what;
    };
    const std::string_view word = WordOfAnyLine();
    if (word.empty()) RejectEnd(expected());
    const std::optional<double> value = FiniteNumber(word);
    if (!value) Reject(expected() + " to be finite", word);
    values.push_back(*value);
  }
  return values;
}

void TextWords::EndOfLine() {
  const std::string_view word = Word();
  if (!word.empty()) Reject("the end of the line", word);
}

void TextWords::Reject(const std::string& expected, std::string_view found) const {
  constexpr std::size_t kLongest = 40;
  std::string text(found.substr(0, kLongest));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  if (found.size() > kLongest) text += "...";
  throw InputError(Place() + "expected " + expected + ", found " + (found.empty() ? "nothing" : "'" + text + "'"));
}

void TextWords::RejectEnd(const std::string& expected) const {
  throw InputError(Place() + "expected " + expected + ", found the end of the file");
}

std::int64_t TextWords::AsInteger(std::string_view word, std::int64_t least, std::int64_t most,
                                  const std::string& what) const {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < least || value > most) {
    Reject(what + " from " + std::to_string(least) + " to " + std::to_string(most), word);
  }
  return value;
}

// An empty file ends on its first line.
std::string TextWords::Place() const { return name_ + ":" + std::to_string(std::max<std::size_t>(number_, 1)) + ": "; }

std::string RoundTripDigits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace lcpbench
