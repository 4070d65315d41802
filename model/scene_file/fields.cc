#include "model/scene_file/fields.h"

#include <algorithm>

#include "support/number_text.h"

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
