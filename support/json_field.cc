#include "support/json_field.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "support/input_error.h"

namespace lcpbench {

using Json = nlohmann::json;

namespace {

// What operator[] refers to where there is no member: a value of no JSON type, which every accessor refuses.
const Json& Missing() {
  static const Json missing(Json::value_t::discarded);
  return missing;
}

// A string of the document's author, printed in one line of ASCII and cut off where it is long.
std::string Excerpt(const Json& value) {
  constexpr size_t kLongest = 60;
  std::string text = value.dump(-1, ' ', /*ensure_ascii=*/true);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

// Follows the parser through the document, so that errors can name the place.
class Follower {
 public:
  explicit Follower(const std::string& where) : where_(where) {}

  void Follow(Json::parse_event_t event, const Json& parsed) {
    switch (event) {
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        if (levels_.size() == kMaxJsonDepth) Fail("nested more than " + std::to_string(kMaxJsonDepth) + " deep");
        levels_.push_back({event == Json::parse_event_t::array_start, 0, {}, {}});
        break;
      case Json::parse_event_t::key: {
        Level& level = levels_.back();
        level.key = parsed.get<std::string>();
        if (!level.keys.insert(level.key).second) Fail("this key stands twice");
        break;
      }
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end:
        levels_.pop_back();
        CountItem();
        break;
      case Json::parse_event_t::value:
        CountItem();
        break;
    }
  }

  [[noreturn]] void Fail(const std::string& problem) const {
    throw InputError(where_ + ": " + Path() + ": " + problem);
  }

 private:
  struct Level {
    bool is_array;
    std::size_t index;  // of the item that comes next
    std::string key;    // read last
    std::set<std::string> keys;
  };

  void CountItem() {
    if (!levels_.empty() && levels_.back().is_array) levels_.back().index += 1;
  }

  std::string Path() const {
    std::string path;
    for (const Level& level : levels_) {
      path += "/" + (level.is_array ? std::to_string(level.index) : PointerToken(level.key));
    }
    return path.empty() ? "/" : path;
  }

  const std::string& where_;
  std::vector<Level> levels_;
};

// What the parser reads, followed through the document. Throws the parser's errors of syntax.
Json ParseFollowed(std::string_view text, const std::string& where) {
  Follower follower(where);
  try {
    return Json::parse(text, [&follower](int /*depth*/, Json::parse_event_t event, const Json& parsed) {
      follower.Follow(event, parsed);
      return true;
    });
  } catch (const Json::out_of_range&) {
    follower.Fail("a number beyond the range of double");
  }
}

// The library's words from the line number on; they may quote a token of any length.
std::string SyntaxError(const std::string& what) {
  constexpr std::size_t kLongest = 200;
  const auto begin = what.find("line ");
  std::string text = begin == std::string::npos ? what : what.substr(begin);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  for (char& c : text) {
    constexpr unsigned char kFirstPrintable = 0x20;
    constexpr unsigned char kLastPrintable = 0x7e;
    const auto byte = static_cast<unsigned char>(c);
    if (byte < kFirstPrintable || byte > kLastPrintable) c = '?';
  }
  return text;
}

}  // namespace

JsonField::JsonField(const Json& value, const std::string& where, std::string path)
    : value_(value), where_(where), path_(std::move(path)) {}

JsonField JsonField::operator[](const char* key) const {
  if (!value_.is_object()) Mismatch("an object");
  const auto it = value_.find(key);
  return {it == value_.end() ? Missing() : *it, where_, path_ + "/" + key};
}

void JsonField::RequireOnlyKeys(std::initializer_list<const char*> known) const {
  if (!value_.is_object()) Mismatch("an object");
  std::string names;
  for (const char* name : known) names += (names.empty() ? "" : ", ") + std::string(name);
  for (const auto& [key, value] : value_.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      Fail("unknown key " + Excerpt(key) + ", expected one of " + names);
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
                                : Excerpt(value_);
  throw InputError(where_ + ": " + Path() + ": expected " + expected + ", found " + found);
}

void JsonField::Fail(const std::string& problem) const { throw InputError(where_ + ": " + Path() + ": " + problem); }

std::string PointerToken(std::string_view key) {
  constexpr size_t kLongest = 60;
  // Printed as a JSON string without its quotes.
  const std::string text = Json(key).dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
  std::string token;
  for (const char c : text.substr(1, text.size() - 2)) token += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  if (token.size() > kLongest) token = token.substr(0, kLongest) + "...";
  return token;
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
    if (!json.is_object()) JsonField(json, where).Mismatch("an object");
    return json;
  } catch (const Json::parse_error& error) {
    throw InputError(where + ": not valid JSON, at byte " + std::to_string(error.byte));
  }
}

}  // namespace lcpbench
