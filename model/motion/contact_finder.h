#pragma once

#include <span>
#include <utility>
#include <vector>

#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/detection/detection.h"
#include "model/shape/outline.h"

namespace lcpbench {

/// Finds the contacts of a world's bodies again and again as they move: keeps what does not change.
class ContactFinder {
 public:
  /// Chains every body's outline (OutlineOf) and excludes pairs that share a joint.  O(edges + joints log joints)
  explicit ContactFinder(const World& world);

  /// The contacts of the same bodies at other positions, as DetectContacts.
  /// @param tolerance, penetration  as DetectionOptions [m]
  std::vector<Constraint> Find(std::span<const Body> bodies, double tolerance, double penetration) const;

  ContactFinder(const ContactFinder&) = delete;
  ContactFinder& operator=(const ContactFinder&) = delete;

 private:
  std::vector<Outline> outlines_;
  std::vector<const Outline*> pointers_;  // into outlines_
  std::vector<std::pair<int, int>> joined_;
};

}  // namespace lcpbench
