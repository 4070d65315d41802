#include "model/scene_file/fields.h"

#include <algorithm>
#include <cmath>

namespace lcpbench {

double ReadNumber(const JsonField& field, const Range& range) {
  if (range.wider != nullptr) ReadNumber(field, *range.wider);
  const double number = field.Number();
  if (!range.Holds(number)) field.Mismatch(range.text);
  return number;
}

Vec2 ReadVector(const JsonField& field) {
  const Vec2 vector = field.Pair<Vec2>();
  if (!kAnyNumber.Holds(vector)) field.Fail("expected numbers within -1e30..1e30, found " + Text(vector));
  return vector;
}

double ReadNumber(const JsonField& object, const char* key, double otherwise, const Range& range) {
  return object.Has(key) ? ReadNumber(object[key], range) : otherwise;
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

bool IsDefault(const OrderedJson& json) {
  if (json.is_array()) return std::all_of(json.begin(), json.end(), IsDefault);
  return json == 0 && !std::signbit(json.get<double>());
}

}  // namespace lcpbench
