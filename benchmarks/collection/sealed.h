#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lcpbench {

/// What is for measuring only (data/sealed.json): scene families and engines by name.
class SealedSet {
 public:
  SealedSet() = default;
  /// @throws InputError naming the file where it is not as written
  static SealedSet Read(const std::string& path);

  const std::vector<std::string>& names() const { return names_; }
  /// @param family  ManifestEntry::family; of a recording the engine is its first word
  bool Has(std::string_view family) const;

 private:
  std::vector<std::string> names_;
};

}  // namespace lcpbench
