// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/selection_graph.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace kestrel {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A value to sort by, with what it belongs to. Smaller keys stand for larger values.
struct Key {
  uint64_t bits;
  uint32_t index;
};

/// The bits of a number in descending order, as an unsigned integer; -0 is 0.
uint64_t descending_bits(double value) {
  constexpr uint64_t kSign = uint64_t{1} << 63;
  const uint64_t bits = std::bit_cast<uint64_t>(value + 0.0);
  return bits & kSign ? bits : ~(bits | kSign);
}

/// By descending value; equal ones keep their order. A radix sort: its branches do not depend on
/// the keys, which makes it several times faster here than one that compares.
void sort_keys(std::vector<Key>& keys) {
  constexpr int kDigits = 8;
  std::vector<std::array<uint32_t, 256>> starts(kDigits, std::array<uint32_t, 256>{});
  for (const Key& key : keys) {
    for (int digit = 0; digit < kDigits; ++digit) ++starts[digit][key.bits >> (8 * digit) & 255];
  }
  std::vector<Key> sorted(keys.size());
  for (int digit = 0; digit < kDigits; ++digit) {
    auto& start = starts[digit];
    if (std::find(start.begin(), start.end(), keys.size()) != start.end()) continue;  // all alike
    uint32_t sum = 0;
    for (uint32_t& count : start) sum += std::exchange(count, sum);
    for (const Key& key : keys) sorted[start[key.bits >> (8 * digit) & 255]++] = key;
    keys.swap(sorted);
  }
}

double price(double cost) {
  return std::isnan(cost) ? kInfinity : std::max(cost, 0.0);
}

std::vector<Key> nodes_by_cost(const std::vector<SelectionNode>& nodes) {
  std::vector<Key> keys(nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    keys[i] = {descending_bits(price(nodes[i].cost)), static_cast<uint32_t>(i)};
  }
  sort_keys(keys);
  return keys;
}

/// Positions in the cost order, the most relevant first.
std::vector<Key> positions_by_relevance(const std::vector<SelectionNode>& nodes,
                                        const std::vector<Key>& by_cost) {
  std::vector<Key> keys(nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    const double relevance = nodes[by_cost[i].index].relevance;
    keys[i] = {descending_bits(std::isnan(relevance) ? -kInfinity : relevance),
               static_cast<uint32_t>(i)};
  }
  sort_keys(keys);
  return keys;
}

}  // namespace

std::vector<bool> select_nodes(const std::vector<SelectionNode>& nodes, double budget) {
  // As the costliest node fits, so do all others left, and the node that the paper's pointers lead
  // to is the most relevant of them. So two sorted lists, each read once, replace the pointers.
  const std::vector<Key> by_cost = nodes_by_cost(nodes);
  const std::vector<Key> by_relevance = positions_by_relevance(nodes, by_cost);
  std::vector<bool> selected(nodes.size(), false);
  std::vector<bool> removed(nodes.size(), false);  // by position in the cost order
  size_t most_relevant = 0;
  double left = budget;
  for (size_t costliest = 0; costliest < nodes.size() && left > 0.0;) {
    if (removed[costliest] || price(nodes[by_cost[costliest].index].cost) > left) {
      removed[costliest++] = true;
      continue;
    }
    while (removed[by_relevance[most_relevant].index]) ++most_relevant;
    const uint32_t position = by_relevance[most_relevant].index;
    const uint32_t node = by_cost[position].index;
    selected[node] = true;
    removed[position] = true;
    if (std::isfinite(left)) left -= price(nodes[node].cost);
  }
  return selected;
}

}  // namespace kestrel
