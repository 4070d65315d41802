#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

namespace lcpbench::recorders {

/// Identities for engines that hold no contact from step to step: a contact is the nearest one of the same pair in the
/// step before, seen from a body that moves, if it is near enough. To be asked in every step.
class ContactNames {
 public:
  struct Contact {
    std::pair<int, int> pair;     ///< of shapes
    std::array<double, 3> place;  ///< in the body's frame
    double reach;                 ///< how far it may have moved to be the same
  };

  /// Numbers of the contacts within their pairs, from 1.
  std::vector<int> Number(const std::vector<Contact>& contacts) {
    struct Match {
      double distance;
      std::size_t contact;
      Held* held;
    };
    std::vector<Match> matches;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const Contact& contact = contacts[k];
      const auto before = held_.find(contact.pair);
      if (before == held_.end()) continue;
      for (Held& held : before->second) {
        const double distance = std::hypot(contact.place[0] - held.place[0], contact.place[1] - held.place[1],
                                           contact.place[2] - held.place[2]);
        if (distance <= contact.reach) matches.push_back({distance, k, &held});
      }
    }
    std::ranges::stable_sort(matches, {}, &Match::distance);
    std::vector<int> numbers(contacts.size(), 0);
    for (const Match& match : matches)
      if (numbers[match.contact] == 0) std::swap(numbers[match.contact], match.held->number);
    std::map<std::pair<int, int>, std::vector<Held>> now;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      if (numbers[k] == 0) numbers[k] = ++last_number_[contacts[k].pair];
      now[contacts[k].pair].push_back({contacts[k].place, numbers[k]});
    }
    held_ = std::move(now);
    return numbers;
  }

 private:
  struct Held {
    std::array<double, 3> place;
    int number;  ///< 0: taken by a contact of this step
  };
  std::map<std::pair<int, int>, std::vector<Held>> held_;  ///< contacts of the step before
  std::map<std::pair<int, int>, int> last_number_;
};

}  // namespace lcpbench::recorders
