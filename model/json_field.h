#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/vec2.h"

namespace lcpbench {

/// A value of a JSON line together with the way to it, so that every error can say where it is:
///     "file:line: /contacts/3/n: expected an array of two numbers, found null".
/// Refers to the document and to `where`; both must outlive it. Every accessor throws InputError on a mismatch.
class JsonField {
 public:
  /// @param where  "file:line"
  /// @param path   JSON pointer of `value`; "" for the document
  JsonField(const nlohmann::json& value, const std::string& where, std::string path = "");

  /// Member `key` of an object; an error if it is missing.
  JsonField operator[](const char* key) const;
  /// Members of an array, of `size` items if one is given.
  std::vector<JsonField> Items(std::optional<size_t> size = std::nullopt) const;

  bool IsNull() const { return value_.is_null(); }
  double Number() const;
  std::optional<double> NumberOrNull() const;
  bool Boolean() const;
  std::string String() const;
  /// An integer in [0, end).
  int IndexBelow(size_t end) const;
  Vec2 Vector() const;
  std::vector<double> Numbers(size_t size) const;

  [[noreturn]] void Mismatch(const std::string& expected) const;

 private:
  const nlohmann::json& value_;
  const std::string& where_;
  std::string path_;
};

/// The JSON object on one line. @throws InputError naming where, if it is not one
nlohmann::json ParseJsonObject(std::string_view line, const std::string& where);

}  // namespace lcpbench
