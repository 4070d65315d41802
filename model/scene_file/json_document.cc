#include "model/scene_file/json_document.h"

#include <set>
#include <vector>

#include "support/input_error.h"
#include "support/json_field.h"

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

}  // namespace lcpbench
