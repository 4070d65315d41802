#include "benchmarks/collection/sealed.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "support/json_field.h"
#include "support/text_file.h"

namespace lcpbench {

SealedSet SealedSet::Read(const std::string& path) {
  SealedSet set;
  const nlohmann::json document = ParseJsonDocument(ReadTextFile(path), path);
  const JsonField file(document, path);
  for (const char* kind : {"families", "friction_families", "engines"}) {
    for (const JsonField& name : file[kind].Items()) set.names_.push_back(name.String());
  }
  return set;
}

bool SealedSet::Has(std::string_view family) const {
  return std::ranges::find(names_, family.substr(0, family.find(' '))) != names_.end();
}

}  // namespace lcpbench
