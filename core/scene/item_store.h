// SPDX-License-Identifier: GPL-3.0-or-later
// Items by the host's 64-bit ids, in the order in which the ids were first set.
#pragma once

#include <cstdint>
#include <list>
#include <unordered_map>
#include <utility>

namespace kestrel {

template <typename T>
class ItemStore {
 public:
  using Item = std::pair<const uint64_t, T>;

  /// Adds at the end, or replaces in place.
  T& put(uint64_t id, T value) {
    if (T* known = find(id)) return *known = std::move(value);
    items_.emplace_back(id, std::move(value));
    try {
      by_id_.emplace(id, std::prev(items_.end()));
    } catch (...) {
      items_.pop_back();
      throw;
    }
    return items_.back().second;
  }

  T* find(uint64_t id) {
    const auto it = by_id_.find(id);
    return it == by_id_.end() ? nullptr : &it->second->second;
  }

  /// False where the id is unknown.
  bool erase(uint64_t id) {
    const auto it = by_id_.find(id);
    if (it == by_id_.end()) return false;
    items_.erase(it->second);
    by_id_.erase(it);
    return true;
  }

  size_t size() const { return items_.size(); }
  auto begin() { return items_.begin(); }
  auto end() { return items_.end(); }

 private:
  std::list<Item> items_;
  std::unordered_map<uint64_t, typename std::list<Item>::iterator> by_id_;
};

}  // namespace kestrel
