#include "support/json_field.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "support/input_error.h"
#include "support/printable.h"

namespace lcpbench {

using Json = nlohmann::json;

namespace {

// What operator[] refers to where the member is missing: a value that every accessor refuses.
const Json& Missing() {
  static const Json missing(Json::value_t::discarded);
  return missing;
}

// The document author's text as JSON writes it, in one line of ASCII and cut off where it is long.
std::string Ascii(const Json& value) {
  constexpr std::size_t kLongest = 60;
  return Excerpt(value.dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace), kLongest);
}

// Builds the document while the parser reads it, so that errors can name the place and nothing is looked at twice.
class DocumentBuilder {
 public:
  explicit DocumentBuilder(const std::string& where) : where_(where) {}

  Json Take() { return std::move(root_); }

  // What nlohmann::json::sax_parse calls.
  bool null() { return Put(nullptr); }
  bool boolean(bool value) { return Put(value); }
  bool number_integer(Json::number_integer_t value) { return Put(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return Put(value); }
  bool number_float(Json::number_float_t value, const std::string& /*text*/) { return Put(value); }
  bool string(std::string& value) { return Put(std::move(value)); }
  bool binary(Json::binary_t& /*value*/) { return false; }
  bool start_object(std::size_t /*size*/) { return Open(Json::object()); }
  bool start_array(std::size_t /*size*/) { return Open(Json::array()); }
  bool key(std::string& name) {
    Level& level = levels_.back();
    const auto [member, is_new] = level.object->try_emplace(std::move(name));
    level.member = &*member;
    if (!is_new) Fail("this key is given twice");
    return true;
  }
  bool end_object() { return Close(); }
  bool end_array() { return Close(); }
  bool parse_error(std::size_t /*position*/, const std::string& /*token*/, const Json::exception& error) const {
    if (const auto* syntax = dynamic_cast<const Json::parse_error*>(&error)) throw *syntax;
    Fail("a number beyond the range of double");
  }

 private:
  struct Level {  // an array, or an object and its member that was begun last
    Json::array_t* array;
    Json::object_t* object;
    Json::object_t::value_type* member;
  };

  template <typename Value>
  bool Put(Value&& value) {
    Add(std::forward<Value>(value));
    return true;
  }
  template <typename Value>
  Json* Add(Value&& value) {
    if (levels_.empty()) return &(root_ = std::forward<Value>(value));
    const Level& level = levels_.back();
    if (level.array != nullptr) return &level.array->emplace_back(std::forward<Value>(value));
    return &(level.member->second = std::forward<Value>(value));
  }
  bool Open(Json&& empty) {
    if (levels_.size() == kMaxJsonDepth) Fail("nested more than " + std::to_string(kMaxJsonDepth) + " deep");
    Json* added = Add(std::move(empty));
    levels_.push_back({added->get_ptr<Json::array_t*>(), added->get_ptr<Json::object_t*>(), nullptr});
    return true;
  }
  bool Close() {
    levels_.pop_back();
    return true;
  }
  [[noreturn]] void Fail(const std::string& problem) const {
    std::string path;
    for (const Level& level : levels_) {
      path += '/';
      path += level.array != nullptr ? std::to_string(level.array->size() - (&level == &levels_.back() ? 0 : 1))
                                     : PointerToken(level.member->first);
    }
    throw InputError(where_ + ": " + (path.empty() ? "/" : path) + ": " + problem);
  }

  const std::string& where_;
  Json root_;
  std::vector<Level> levels_;
};

// Throws the parser's errors of syntax.
Json ParseFollowed(std::string_view text, const std::string& where) {
  DocumentBuilder builder(where);
  Json::sax_parse(text, &builder);
  return builder.Take();
}

// The library's words from the line number on; they may quote a token of any length.
std::string SyntaxError(std::string_view what) {
  constexpr std::size_t kLongest = 200;
  const auto begin = what.find("line ");
  return Excerpt(begin == std::string_view::npos ? what : what.substr(begin), kLongest);
}

}  // namespace

JsonField::JsonField(const Json& value, const std::string& where, std::string path)
    : value_(value), where_(where), path_(std::move(path)) {}

JsonField JsonField::operator[](const char* key) const {
  if (!value_.is_object()) Mismatch("an object");
  const auto it = value_.find(key);
  return {it == value_.end() ? Missing() : *it, where_, path_ + "/" + key};
}

void JsonField::RequireOnlyKeys(std::span<const char* const> known) const {
  if (!value_.is_object()) Mismatch("an object");
  std::string names;
  for (const char* name : known) names += (names.empty() ? "" : ", ") + std::string(name);
  for (const auto& [key, value] : value_.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      Fail("unknown key " + Ascii(key) + ", expected one of " + names);
    }
  }
}

size_t JsonField::Size(std::optional<size_t> size) const {
  if (!value_.is_array() || (size && value_.size() != *size)) {
    Mismatch(size ? "an array of " + std::to_string(*size) : "an array");
  }
  return value_.size();
}

std::vector<JsonField> JsonField::Items(std::optional<size_t> size) const {
  const size_t count = Size(size);
  std::vector<JsonField> items;
  items.reserve(count);
  for (size_t i = 0; i < count; ++i) items.push_back(Item(i));
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

std::vector<std::pair<std::string, JsonField>> JsonField::Members() const {
  if (!value_.is_object()) Mismatch("an object");
  std::vector<std::pair<std::string, JsonField>> members;
  members.reserve(value_.size());
  for (const auto& [key, value] : value_.items()) {
    members.emplace_back(key, JsonField(value, where_, path_ + "/" + PointerToken(key)));
  }
  return members;
}

bool JsonField::Boolean() const {
  if (!value_.is_boolean()) Mismatch("true or false");
  return value_.get<bool>();
}

std::string JsonField::String() const {
  if (!value_.is_string()) Mismatch("a string");
  return value_.get<std::string>();
}

int JsonField::Integer() const {
  if (value_.is_number_integer()) {
    const auto number = value_.get<double>();  // exact where it fits
    constexpr std::numeric_limits<int> kLimits;
    if (kLimits.min() <= number && number <= kLimits.max()) return static_cast<int>(number);
  }
  Mismatch("an integer");
}

int JsonField::IndexBelow(size_t end) const {
  // A non-negative integer literal is stored unsigned.
  if (value_.is_number_unsigned() && value_.get<size_t>() < end) return value_.get<int>();
  Mismatch("an integer in [0, " + std::to_string(end) + ")");
}

std::vector<double> JsonField::TwoNumbers() const {
  if (!value_.is_array() || value_.size() != 2) Mismatch("an array of two numbers");
  return Numbers(2);
}

std::vector<double> JsonField::Numbers(size_t size) const {
  std::vector<double> numbers;
  numbers.reserve(size);
  for (const JsonField& item : Items(size)) numbers.push_back(item.Number());
  return numbers;
}

void JsonField::Mismatch(const std::string& expected) const {
  if (value_.is_discarded()) throw InputError(where_ + ": " + Path() + ": missing field, expected " + expected);
  // A nested value is only named: printing it could be long, and as deep as its author liked.
  const std::string found = value_.is_structured()
                                ? std::string("an ") + value_.type_name() + " of " + std::to_string(value_.size())
                                : Ascii(value_);
  throw InputError(where_ + ": " + Path() + ": expected " + expected + ", found " + found);
}

void JsonField::Fail(const std::string& problem) const { throw InputError(where_ + ": " + Path() + ": " + problem); }

std::string PointerToken(std::string_view key) {
  constexpr std::size_t kLongest = 60;
  // Printed as a JSON string without its quotes.
  const std::string text = Json(key).dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
  std::string token;
  for (const char c : text.substr(1, text.size() - 2)) token += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return Excerpt(token, kLongest);
}

Json ParseJsonDocument(std::string_view text, const std::string& where) {
  try {
    return ParseFollowed(text, where);
  } catch (const Json::parse_error& error) {
    throw InputError(where + ": not valid JSON: " + SyntaxError(error.what()));
  }
}

Json ParseJsonObject(std::string_view line, const std::string& where) {
  try {
    Json json = ParseFollowed(line, where);
    if (json.is_object()) return json;
    throw NotJsonError(where + ": expected an object, found " + json.type_name());
  } catch (const Json::parse_error& error) {
    throw NotJsonError(where + ": not valid JSON, at byte " + std::to_string(error.byte));
  }
}

}  // namespace lcpbench
