#include "model/json_field.h"

#include <utility>

#include "solvers/lcp/input_error.h"

namespace lcpbench {

using Json = nlohmann::json;

JsonField::JsonField(const Json& value, const std::string& where, std::string path)
    : value_(value), where_(where), path_(std::move(path)) {}

JsonField JsonField::operator[](const char* key) const {
  if (!value_.is_object()) Mismatch("an object");
  const auto it = value_.find(key);
  if (it == value_.end()) throw InputError(where_ + ": " + path_ + "/" + key + ": missing field");
  return {*it, where_, path_ + "/" + key};
}

std::vector<JsonField> JsonField::Items(std::optional<size_t> size) const {
  const std::string expected = size ? "an array of " + std::to_string(*size) : "an array";
  if (!value_.is_array() || (size && value_.size() != *size)) Mismatch(expected);
  std::vector<JsonField> items;
  items.reserve(value_.size());
  for (size_t i = 0; i < value_.size(); ++i) items.emplace_back(value_[i], where_, path_ + "/" + std::to_string(i));
  return items;
}

double JsonField::Number() const {
  if (!value_.is_number()) Mismatch("a number");
  return value_.get<double>();
}

std::optional<double> JsonField::NumberOrNull() const {
  if (value_.is_null()) return std::nullopt;
  if (!value_.is_number()) Mismatch("a number or null");
  return value_.get<double>();
}

bool JsonField::Boolean() const {
  if (!value_.is_boolean()) Mismatch("true or false");
  return value_.get<bool>();
}

std::string JsonField::String() const {
  if (!value_.is_string()) Mismatch("a string");
  return value_.get<std::string>();
}

int JsonField::IndexBelow(size_t end) const {
  // A non-negative integer literal is stored unsigned.
  if (value_.is_number_unsigned() && value_.get<size_t>() < end) return value_.get<int>();
  Mismatch("an integer in [0, " + std::to_string(end) + ")");
}

Vec2 JsonField::Vector() const {
  if (!value_.is_array() || value_.size() != 2) Mismatch("an array of two numbers");
  const std::vector<JsonField> items = Items();
  return {items[0].Number(), items[1].Number()};
}

std::vector<double> JsonField::Numbers(size_t size) const {
  std::vector<double> numbers;
  numbers.reserve(size);
  for (const JsonField& item : Items(size)) numbers.push_back(item.Number());
  return numbers;
}

void JsonField::Mismatch(const std::string& expected) const {
  constexpr size_t kLongestExcerpt = 60;
  // A nested value is only named: printing it could be long, and as deep as its author liked.
  std::string found = value_.is_structured()
                          ? std::string("an ") + value_.type_name() + " of " + std::to_string(value_.size())
                          : value_.dump(-1, ' ', /*ensure_ascii=*/true);
  if (found.size() > kLongestExcerpt) found = found.substr(0, kLongestExcerpt) + "...";
  throw InputError(where_ + ": " + (path_.empty() ? "/" : path_) + ": expected " + expected + ", found " + found);
}

Json ParseJsonObject(std::string_view line, const std::string& where) {
  try {
    Json json = Json::parse(line);
    if (!json.is_object()) JsonField(json, where).Mismatch("an object");
    return json;
  } catch (const Json::parse_error& error) {
    throw InputError(where + ": not valid JSON, at byte " + std::to_string(error.byte));
  } catch (const Json::out_of_range&) {
    throw InputError(where + ": not valid JSON, a number is out of the range of double");
  }
}

}  // namespace lcpbench
