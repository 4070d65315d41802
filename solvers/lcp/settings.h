#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

namespace lcpbench {

/// Options of one method by name, as the command line gives them ("relaxation" -> "1.3").
using Settings = std::map<std::string, std::string>;

/// Turns Settings into a method's typed options. Each call names one option; Finish() refuses what no call named.
/// All members throw InputError naming the option, what was expected and what was found.
class SettingsReader {
 public:
  /// @param owner     the solver's key, for error texts
  /// @param settings  not owned; must outlive the reader
  SettingsReader(std::string_view owner, const Settings& settings);

  /// A number in [minimum, maximum]; `fallback` where the option is absent.
  double Number(const std::string& name, double fallback, double minimum, double maximum);
  /// One of `choices`; `fallback` where the option is absent.
  std::string Choice(const std::string& name, std::string_view fallback,
                     std::initializer_list<std::string_view> choices);
  /// `yes` or `no`.
  bool YesOrNo(const std::string& name, bool fallback);
  /// Must come last.
  void Finish() const;

 private:
  std::string owner_;
  const Settings& settings_;
  std::map<std::string, bool> known_;
};

}  // namespace lcpbench
