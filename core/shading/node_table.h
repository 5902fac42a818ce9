// SPDX-License-Identifier: GPL-3.0-or-later
// The names of node programs' instructions. Hosts and scene files write programs by them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kestrel {

/// What an instruction's `data` is.
enum class NodeData : uint8_t { none, place, texture, attribute, table, constant };

/// A kind of instruction; its number is its place in node_table().
struct NodeOp {
  std::string_view name;
  /// Each digit's values by name, the lowest digit of the mode first.
  std::vector<std::vector<std::string_view>> modes;
  std::vector<std::string_view> operands;
  NodeData data = NodeData::none;

  /// How many modes there are.
  uint32_t mode_count() const;
};

std::span<const NodeOp> node_table();
/// What a program computes, by its number.
std::span<const std::string_view> node_outputs();

/// {"ops": [{"name", "modes", "operands", "data"}, …], "outputs": […], "registers", "table_size"}
std::string node_table_json();

}  // namespace kestrel
