#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

namespace lcpbench {

/// Reorders items so that keys take turns: the first item of every key, then the second of every key, and so on. Items
/// of one key, and items of one turn, keep their order. Called for the finest key first it shares turns out fairly at
/// every level: by base, then by family, then by origin.  O(n log n)
template <typename Item, typename KeyOf>
void TakeTurns(std::vector<Item>* items, const KeyOf& key_of) {
  std::map<std::decay_t<std::invoke_result_t<KeyOf, const Item&>>, std::size_t> taken;
  std::vector<std::pair<std::size_t, Item>> by_turn;
  by_turn.reserve(items->size());
  for (Item& item : *items) {
    const std::size_t turn = taken[key_of(item)]++;
    by_turn.emplace_back(turn, std::move(item));
  }
  std::stable_sort(by_turn.begin(), by_turn.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::transform(by_turn.begin(), by_turn.end(), items->begin(), [](auto& entry) { return std::move(entry.second); });
}

}  // namespace lcpbench
