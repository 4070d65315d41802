#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/input_error.h"

namespace lcpbench {

/// A value of a JSON document together with the way to it, so that every error can say where it is, in one line:
///     "file:line: /contacts/3/n: expected an array of two numbers, found null"
///     "file:line: /contacts/3/n: missing field, expected an array of two numbers"
/// Refers to the document and to `where`; both must outlive it. Every accessor throws InputError on a mismatch.
class JsonField {
 public:
  /// @param where  "file:line", or "file" for a document of many lines
  /// @param path   JSON pointer of `value`; "" for the document
  JsonField(const nlohmann::json& value, const std::string& where, std::string path = "");

  /// Member `key` of an object. A missing one is an error once it is read, so that the error says what was expected.
  JsonField operator[](const char* key) const;
  bool Has(const char* key) const { return value_.is_object() && value_.contains(key); }
  /// Refuses an object with any other key: the error names the first such key and the known ones.
  void RequireOnlyKeys(std::initializer_list<const char*> known) const { RequireOnlyKeys(std::span(known)); }
  void RequireOnlyKeys(std::span<const char* const> known) const;
  /// Members of an array, of `size` items if one is given.
  std::vector<JsonField> Items(std::optional<size_t> size = std::nullopt) const;
  /// The same for long arrays: how many there are, and one of them.
  size_t Size(std::optional<size_t> size = std::nullopt) const;
  JsonField Item(size_t i) const { return {value_[i], where_, path_ + "/" + std::to_string(i)}; }

  /// Whether there is a member `key` that is not null: null stands for what is not known.
  bool Knows(const char* key) const { return Has(key) && !value_[key].is_null(); }

  bool IsNull() const { return value_.is_null(); }
  bool IsArray() const { return value_.is_array(); }
  bool IsString() const { return value_.is_string(); }
  bool IsNumber() const { return value_.is_number(); }
  bool IsObject() const { return value_.is_object(); }
  double Number() const;
  std::optional<double> NumberOrNull() const;
  bool Boolean() const;
  std::string String() const;
  /// The value that a string stands for, e.g. Choice<Side>({{"convex", Side::kConvex}, {"concave", Side::kConcave}}).
  template <class T>
  T Choice(std::initializer_list<std::pair<const char*, T>> choices) const;
  int Integer() const;
  /// An integer in [0, end).
  int IndexBelow(size_t end) const;
  /// An array of two numbers, as a V{first, second}.
  template <class V>
  V Pair() const {
    const std::vector<double> numbers = TwoNumbers();
    return {numbers[0], numbers[1]};
  }
  std::vector<double> Numbers(size_t size) const;

  /// Members of an object by key, in the order of their keys.
  std::vector<std::pair<std::string, JsonField>> Members() const;

  /// JSON pointer to this value; "/" for the document.
  std::string Path() const { return path_.empty() ? "/" : path_; }
  [[noreturn]] void Mismatch(const std::string& expected) const;
  /// Throws InputError: where, path and the problem in words.
  [[noreturn]] void Fail(const std::string& problem) const;

 private:
  std::vector<double> TwoNumbers() const;

  const nlohmann::json& value_;
  const std::string& where_;
  std::string path_;
};

template <class T>
T JsonField::Choice(std::initializer_list<std::pair<const char*, T>> choices) const {
  std::string expected;
  for (const auto& [name, value] : choices) {
    if (value_ == name) return value;
    expected += (expected.empty() ? "one of " : ", ") + std::string(name);
  }
  Mismatch(expected);
}

/// A key as a part of a JSON pointer [RFC 6901], in one line of ASCII and cut off where it is long.
std::string PointerToken(std::string_view key);

/// Arrays and objects in each other beyond this are refused: no file of ours is half as deep.
inline constexpr std::size_t kMaxJsonDepth = 32;

/// A JSON document [RFC 8259]: unlike the plain parser it refuses a key that stands twice in one object (one of the two
/// would be lost unseen). Time and memory proportional to the text, recursion none.
/// @throws InputError, one line: where, then line and column of what is not JSON, or the JSON pointer of a repeated
///         key, of a value nested deeper than kMaxJsonDepth, of a number beyond the range of double
nlohmann::json ParseJsonDocument(std::string_view text, const std::string& where);

/// A text that is not JSON, or not an object where one is expected: at the beginning of a file, another format.
class NotJsonError : public InputError {
 public:
  using InputError::InputError;
};

/// The same of one line that holds an object; what is not JSON is named by its byte.
/// @throws NotJsonError for text that is not JSON, or not an object; else as ParseJsonDocument
nlohmann::json ParseJsonObject(std::string_view line, const std::string& where);

}  // namespace lcpbench
