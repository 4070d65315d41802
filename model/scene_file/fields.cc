#include "model/scene_file/fields.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "support/number_text.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

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

Json ParseJsonDocument(std::string_view text, const std::string& where) {
  Follower follower(where);
  try {
    return Json::parse(text, [&follower](int /*depth*/, Json::parse_event_t event, const Json& parsed) {
      follower.Follow(event, parsed);
      return true;
    });
  } catch (const Json::parse_error& error) {
    throw InputError(where + ": not valid JSON: " + SyntaxError(error.what()));
  } catch (const Json::out_of_range&) {
    follower.Fail("a number beyond the range of double");
  }
}

double ReadNumber(const JsonField& field) {
  const double number = field.Number();
  if (!(std::abs(number) <= kLargestNumber)) field.Mismatch("a number within -1e30..1e30");
  return number;
}

double ReadPositive(const JsonField& field) {
  const double number = field.Number();
  if (!(number >= 1 / kLargestNumber && number <= kLargestNumber)) {
    field.Mismatch("a number > 0, within 1e-30..1e30");
  }
  return number;
}

double ReadNonNegative(const JsonField& field) {
  const double number = field.Number();
  if (!(number >= 0 && number <= kLargestNumber)) field.Mismatch("a number >= 0, at most 1e30");
  return number;
}

Vec2 ReadVector(const JsonField& field) {
  const Vec2 vector = field.Pair<Vec2>();
  if (!(std::abs(vector.x) <= kLargestNumber && std::abs(vector.y) <= kLargestNumber)) {
    field.Fail("expected numbers within -1e30..1e30, found " + Text(vector));
  }
  return vector;
}

double ReadNumber(const JsonField& object, const char* key, double otherwise) {
  return object.Has(key) ? ReadNumber(object[key]) : otherwise;
}

Vec2 ReadVector(const JsonField& object, const char* key, Vec2 otherwise) {
  return object.Has(key) ? ReadVector(object[key]) : otherwise;
}

void RequireName(const std::string& name, const JsonField& field) {
  constexpr unsigned char kFirstPrintable = 0x20;
  constexpr unsigned char kDelete = 0x7f;
  const bool printable = std::all_of(name.begin(), name.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= kFirstPrintable && byte != kDelete;
  });
  if (name.empty() || name.size() > kLongestName || !printable) {
    field.Fail("expected a name of 1 to " + std::to_string(kLongestName) + " bytes without control characters");
  }
}

std::string ReadName(const JsonField& field) {
  std::string name = field.String();
  RequireName(name, field);
  return name;
}

const char* OnlyKey(const JsonField& object, std::initializer_list<const char*> known) {
  object.RequireOnlyKeys(known);
  const char* only = nullptr;
  std::string names;
  int count = 0;
  for (const char* key : known) {
    names += (names.empty() ? "" : ", ") + std::string(key);
    if (!object.Has(key)) continue;
    only = key;
    ++count;
  }
  if (count != 1) object.Mismatch("an object with exactly one of the keys " + names);
  return only;
}

std::string Text(double value) { return NumberText(value); }

std::string Text(Vec2 p) { return "(" + Text(p.x) + ", " + Text(p.y) + ")"; }

}  // namespace lcpbench
