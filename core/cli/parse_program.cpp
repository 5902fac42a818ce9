// SPDX-License-Identifier: GPL-3.0-or-later
// Node programs of materials, by the names of kestrelGetNodeTable().
#include <algorithm>
#include <climits>

#include "cli/parse.h"
#include "shading/node_table.h"

namespace kestrel::cli {
namespace {

constexpr size_t kMaximumSteps = 65536;
constexpr size_t kMaximumIds = 4096;
constexpr int kMaximumOperand = 1 << 24;

std::vector<std::string> strings(std::span<const std::string_view> views) {
  return {views.begin(), views.end()};
}

std::vector<std::string> op_names() {
  std::vector<std::string> names;
  for (const NodeOp& op : node_table()) names.emplace_back(op.name);
  return names;
}

/// ["math", ["ADD", "NO"], result, data, operands…]
KestrelNodeInstruction parse_step(const JsonNode& node) {
  static const std::vector<std::string> kOps = op_names();
  const std::vector<JsonNode> parts = node.items(4 + std::size(KestrelNodeInstruction{}.operands));
  if (parts.size() < 4) node.fail("expected op, modes, result, data and operands");
  KestrelNodeInstruction step{};
  step.op = static_cast<uint32_t>(parts[0].choice(kOps));
  const NodeOp& op = node_table()[step.op];
  const std::vector<JsonNode> modes = parts[1].items(op.modes.size());
  if (modes.size() != op.modes.size()) parts[1].fail("expected {} modes", op.modes.size());
  uint32_t digit = 1;
  for (size_t i = 0; i < modes.size(); ++i) {
    step.mode += digit * static_cast<uint32_t>(modes[i].choice(strings(op.modes[i])));
    digit *= static_cast<uint32_t>(op.modes[i].size());
  }
  step.result = parts[2].integer(0, kMaximumOperand);
  step.data = parts[3].integer(0, kMaximumOperand);
  if (parts.size() != 4 + op.operands.size()) {
    node.fail("expected {} operands, found {}", op.operands.size(), parts.size() - 4);
  }
  for (size_t i = 4; i < parts.size(); ++i) {
    step.operands[i - 4] = parts[i].integer(-kMaximumOperand, kMaximumOperand);
  }
  return step;
}

}  // namespace

ProgramDescription parse_program(const JsonNode& node, const Names& textures,
                                 const SceneBuffer& buffer) {
  node.expect_keys({"steps", "constants", "textures", "attributes", "outputs"});
  ProgramDescription program;
  for (const JsonNode& step : node.require("steps").items(kMaximumSteps)) {
    program.steps.push_back(parse_step(step));
  }
  if (const auto n = node.find("constants")) {
    program.constants = buffer.floats(*n, -kMaximumRadiance, kMaximumRadiance);
    if (program.constants.size() % 4 != 0) n->fail("expected 4 numbers for each constant");
  }
  if (const auto n = node.find("textures")) {
    for (const JsonNode& name : n->items(kMaximumIds)) {
      program.textures.push_back(static_cast<uint64_t>(textures.find(name)) + 1);
    }
  }
  if (const auto n = node.find("attributes")) {
    for (const JsonNode& id : n->items(kMaximumIds)) program.attributes.push_back(id.whole());
  }
  const JsonNode outputs = node.require("outputs");
  outputs.expect_keys(strings(node_outputs()));
  for (int i = 0; i < KESTREL_NODE_OUTPUTS; ++i) {
    const auto operand = outputs.find(std::string(node_outputs()[i]));
    program.outputs[i] =
        operand ? operand->integer(-kMaximumOperand, kMaximumOperand) : KESTREL_NODE_UNSET;
  }
  return program;
}

}  // namespace kestrel::cli
