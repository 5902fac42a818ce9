// SPDX-License-Identifier: GPL-3.0-or-later
// The graph of the paper's section 3.2 and the greedy walk over it (listing 6, second half).
#pragma once

#include <vector>

namespace kestrel {

/// A node of the selection graph: what one unit costs and how relevant it is.
struct SelectionNode {
  double cost = 0.0;       // C, same unit as the budget; NaN counts as infinite, negative as 0
  double relevance = 0.0;  // R; NaN counts as the least
};

/// Repeatedly takes the costliest node left, while some of the budget is left; drops it if it does
/// not fit; else selects the most relevant node among it and those of smaller or equal cost, and
/// pays for that. Ties: of equal cost, the one listed first is the costlier; of equal relevance,
/// the costlier is the more relevant. An infinite budget selects every node, one that is zero,
/// negative or NaN none. Returns one flag a node. O(n log n).
std::vector<bool> select_nodes(const std::vector<SelectionNode>& nodes, double budget);

}  // namespace kestrel
