// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/selection_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace kestrel {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A value to sort by, with what it belongs to.
struct Key {
  double value;
  uint32_t index;
};

/// Descending; equal values keep the order of their indices.
void sort_keys(std::vector<Key>& keys) {
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
    return a.value > b.value || (a.value == b.value && a.index < b.index);
  });
}

std::vector<Key> nodes_by_cost(const std::vector<SelectionNode>& nodes) {
  std::vector<Key> keys(nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    const double cost = nodes[i].cost;
    keys[i] = {std::isnan(cost) ? kInfinity : std::max(cost, 0.0), static_cast<uint32_t>(i)};
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
    keys[i] = {std::isnan(relevance) ? -kInfinity : relevance, static_cast<uint32_t>(i)};
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
    if (removed[costliest] || by_cost[costliest].value > left) {
      removed[costliest++] = true;
      continue;
    }
    while (removed[by_relevance[most_relevant].index]) ++most_relevant;
    const uint32_t position = by_relevance[most_relevant].index;
    selected[by_cost[position].index] = true;
    removed[position] = true;
    if (std::isfinite(left)) left -= by_cost[position].value;
  }
  return selected;
}

}  // namespace kestrel
