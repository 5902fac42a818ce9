// SPDX-License-Identifier: GPL-3.0-or-later
// The greedy walk against the graph as section 3.2 of the paper describes it, built literally.
#include "stages/selection_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <list>
#include <random>

namespace kestrel {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The paper's graph: nodes by descending cost, each with pointers to those of smaller or equal
/// cost and higher relevance, by descending relevance. O(n² log n), for small n.
class LiteralGraph {
 public:
  explicit LiteralGraph(const std::vector<SelectionNode>& input) : flags_(input.size(), false) {
    for (size_t i = 0; i < input.size(); ++i) nodes_.push_back({input[i], i, {}});
    nodes_.sort([](const Node& a, const Node& b) { return a.value.cost > b.value.cost; });
    for (auto from = nodes_.begin(); from != nodes_.end(); ++from) {
      for (auto to = std::next(from); to != nodes_.end(); ++to) {
        if (to->value.relevance > from->value.relevance) from->more_relevant.push_back(&*to);
      }
      std::stable_sort(
          from->more_relevant.begin(), from->more_relevant.end(),
          [](const Node* a, const Node* b) { return a->value.relevance > b->value.relevance; });
    }
  }

  std::vector<bool> walk(double left) {
    while (left > 0.0 && !nodes_.empty()) {
      const Node* current = &nodes_.front();
      if (current->value.cost > left) {
        remove(current);
        continue;
      }
      if (!current->more_relevant.empty()) current = current->more_relevant.front();
      left -= current->value.cost;
      flags_[current->index] = true;
      remove(current);
    }
    return flags_;
  }

 private:
  struct Node {
    SelectionNode value;
    size_t index;
    std::vector<const Node*> more_relevant;
  };

  void remove(const Node* node) {
    for (Node& other : nodes_) {
      auto& pointers = other.more_relevant;
      pointers.erase(std::remove(pointers.begin(), pointers.end(), node), pointers.end());
    }
    nodes_.remove_if([node](const Node& other) { return &other == node; });
  }

  std::list<Node> nodes_;
  std::vector<bool> flags_;
};

std::vector<int> indices(const std::vector<bool>& flags) {
  std::vector<int> out;
  for (size_t i = 0; i < flags.size(); ++i) {
    if (flags[i]) out.push_back(static_cast<int>(i));
  }
  return out;
}

/// Whole numbers below the given counts: sums are exact, and small counts make many ties.
std::vector<SelectionNode> random_nodes(std::mt19937& random, int count, int costs,
                                        int relevances) {
  std::vector<SelectionNode> nodes(count);
  for (SelectionNode& n : nodes) {
    n.cost = std::uniform_int_distribution<int>(0, costs)(random);
    n.relevance = std::uniform_int_distribution<int>(0, relevances)(random);
  }
  return nodes;
}

double selected_cost(const std::vector<SelectionNode>& nodes, const std::vector<bool>& selected) {
  double sum = 0.0;
  for (size_t i = 0; i < nodes.size(); ++i) sum += selected[i] ? nodes[i].cost : 0.0;
  return sum;
}

using Nodes = std::vector<SelectionNode>;
using Indices = std::vector<int>;

TEST(SelectionGraph, WalksThePapersExample) {
  // As around Figure 4: with 400 left, the first two are too dear; the third fits and points to the
  // next in cost and to the fifth and sixth as more relevant, of which the fifth is the most so.
  const Nodes nodes = {{900, 12}, {500, 40}, {350, 10}, {300, 8}, {200, 30}, {100, 20}, {50, 5}};
  // 5th: 200 left. 3rd and 4th no longer fit. 6th: 100 left. 7th: 50 left.
  EXPECT_EQ(indices(select_nodes(nodes, 400)), (Indices{4, 5, 6}));
  EXPECT_EQ(indices(LiteralGraph(nodes).walk(400)), (Indices{4, 5, 6}));
}

TEST(SelectionGraph, TheCostliestGoesFirstOnlyWhileNothingIsMoreRelevant) {
  EXPECT_EQ(indices(select_nodes({{60, 2}, {50, 1}, {40, 1}}, 100)), (Indices{0, 2}));
  EXPECT_EQ(indices(select_nodes({{60, 1}, {50, 2}, {40, 2}}, 100)), (Indices{1, 2}));
}

TEST(SelectionGraph, EqualsTheLiteralGraph) {
  std::mt19937 random(1);
  for (int round = 0; round < 6000; ++round) {
    const int count = std::uniform_int_distribution<int>(0, 24)(random);
    const bool ties = round % 2 == 0;
    const Nodes nodes = random_nodes(random, count, ties ? 4 : 1000, ties ? 3 : 1000);
    const double budget = std::uniform_int_distribution<int>(0, ties ? 30 : 6000)(random);
    ASSERT_EQ(select_nodes(nodes, budget), LiteralGraph(nodes).walk(budget))
        << "round " << round << ", budget " << budget;
  }
}

TEST(SelectionGraph, TiesGoToTheFirstListed) {
  // Three alike, two fit.
  EXPECT_EQ(indices(select_nodes({{10, 5}, {10, 5}, {10, 5}}, 20)), (Indices{0, 1}));
  // Equal cost: the first is the costlier, dropped or selected before the others.
  EXPECT_EQ(indices(select_nodes({{10, 1}, {10, 2}, {10, 2}}, 10)), (Indices{1}));
  // Zeros of either sign are equal.
  EXPECT_EQ(indices(select_nodes({{10, -0.0}, {10, 0.0}}, 10)), (Indices{0}));
  EXPECT_EQ(indices(select_nodes({{10, 0.0}, {10, -0.0}}, 10)), (Indices{0}));
  // Equal relevance: the costlier first.
  EXPECT_EQ(indices(select_nodes({{10, 5}, {20, 5}, {15, 5}}, 30)), (Indices{0, 1}));
}

TEST(SelectionGraph, KeepsWithinTheBudgetAndLeavesOutOnlyWhatDoesNotFit) {
  std::mt19937 random(2);
  for (int round = 0; round < 2000; ++round) {
    const Nodes nodes = random_nodes(random, 50, 200, 50);
    const double budget = std::uniform_int_distribution<int>(0, 4000)(random);
    const std::vector<bool> selected = select_nodes(nodes, budget);
    const double left = budget - selected_cost(nodes, selected);
    ASSERT_GE(left, 0.0);
    for (size_t i = 0; i < nodes.size(); ++i) {
      ASSERT_TRUE(selected[i] || left == 0.0 || nodes[i].cost > left) << nodes[i].cost;
    }
  }
}

TEST(SelectionGraph, AlwaysSelectsTheMostRelevantWhereEveryNodeFitsAlone) {
  std::mt19937 random(3);
  for (int round = 0; round < 500; ++round) {
    const Nodes nodes = random_nodes(random, 30, 100, 1000000);
    const std::vector<bool> selected = select_nodes(nodes, 100);
    const auto best =
        std::max_element(nodes.begin(), nodes.end(),
                         [](const auto& a, const auto& b) { return a.relevance < b.relevance; });
    EXPECT_TRUE(selected[best - nodes.begin()]);
  }
}

TEST(SelectionGraph, SelectsAllWhenTheBudgetCoversTheSum) {
  std::mt19937 random(4);
  const Nodes nodes = random_nodes(random, 100, 50, 10);
  const double sum = selected_cost(nodes, std::vector<bool>(nodes.size(), true));
  ASSERT_GT(sum, 0.0);
  EXPECT_EQ(indices(select_nodes(nodes, sum + 1)).size(), nodes.size());
  EXPECT_LT(indices(select_nodes(nodes, sum - 1)).size(), nodes.size());
}

TEST(SelectionGraph, DependsOnTheOrderOfRelevancesNotTheirSize) {
  std::mt19937 random(5);
  Nodes nodes = random_nodes(random, 200, 100, 1000);
  const std::vector<bool> before = select_nodes(nodes, 3000);
  for (SelectionNode& n : nodes) n.relevance = n.relevance * n.relevance + 7.0;
  EXPECT_EQ(select_nodes(nodes, 3000), before);
}

TEST(SelectionGraph, NoBudgetSelectsNothingAndAnInfiniteOneEverything) {
  const Nodes nodes = {{10, 1}, {0, 1}, {kInf, 1}};
  EXPECT_EQ(indices(select_nodes(nodes, 0)), Indices{});
  EXPECT_EQ(indices(select_nodes(nodes, -5)), Indices{});
  EXPECT_EQ(indices(select_nodes(nodes, kNan)), Indices{});
  EXPECT_EQ(indices(select_nodes(nodes, kInf)), (Indices{0, 1, 2}));
  EXPECT_EQ(indices(select_nodes({}, 100)), Indices{});
}

TEST(SelectionGraph, TreatsBrokenNumbersAsDocumented) {
  // No number as cost: never within a finite budget. Negative: free, and gives nothing back.
  EXPECT_EQ(indices(select_nodes({{kNan, 9}, {10, 1}}, 10)), (Indices{1}));
  EXPECT_EQ(indices(select_nodes({{-100, 9}, {10, 1}, {10, 1}}, 10)), (Indices{0, 1}));
  // No number as relevance: last.
  EXPECT_EQ(indices(select_nodes({{10, kNan}, {10, -1}}, 10)), (Indices{1}));
  // Below zero and infinite relevances order as numbers do.
  EXPECT_EQ(indices(select_nodes({{9, -2}, {9, -1}, {9, -3e300}}, 10)), (Indices{1}));
  EXPECT_EQ(indices(select_nodes({{9, 1e300}, {9, kInf}, {9, -kInf}}, 10)), (Indices{1}));
  EXPECT_EQ(indices(select_nodes({{kNan, kNan}, {kInf, kInf}}, kInf)), (Indices{0, 1}));
}

TEST(SelectionGraph, TakesAnyNumberOfNodes) {
  // The literal graph would hold 45 thousand million pointers here, and drop some at every step.
  constexpr int kCount = 300000;
  Nodes nodes(kCount);
  for (int i = 0; i < kCount; ++i) nodes[i] = {double(kCount - i), double(i)};
  // Costs 1, 2, … of the last nodes, which are the most relevant, until the next is beyond it.
  const std::vector<bool> selected = select_nodes(nodes, 300000.0 + 1 + 2 + 3);
  EXPECT_TRUE(selected[kCount - 1] && selected[kCount - 700]);
  EXPECT_LE(selected_cost(nodes, selected), 300006.0);
  EXPECT_FALSE(selected[0]);
}

}  // namespace
}  // namespace kestrel
