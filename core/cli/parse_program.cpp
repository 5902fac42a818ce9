// SPDX-License-Identifier: GPL-3.0-or-later
// Node programs of materials, by the names of kestrelGetNodeTable().
#include <nlohmann/json.hpp>

#include "cli/parse.h"

namespace kestrel::cli {
namespace {

constexpr size_t kMaximumInstructions = 65536;
constexpr size_t kMaximumIds = 4096;
constexpr int kMaximumOperand = 1 << 24;

/// kestrelGetNodeTable().
struct Op {
  std::vector<std::vector<std::string>> modes;
  size_t operands = 0;
};
struct Table {
  std::vector<std::string> names;
  std::vector<Op> ops;  // by the names
  std::vector<std::string> outputs;

  Table() {
    const nlohmann::json json = nlohmann::json::parse(kestrelGetNodeTable());
    for (const nlohmann::json& op : json.at("ops")) {
      names.push_back(op.at("name"));
      ops.push_back({op.at("modes"), op.at("operands").size()});
    }
    outputs = json.at("outputs");
  }
};

const Table& table() {
  static const auto& known = *new Table();
  return known;
}

/// ["math", ["ADD", "NO"], result, data, operands…]
KestrelNodeInstruction parse_step(const JsonNode& node) {
  const std::vector<JsonNode> parts = node.items(4 + std::size(KestrelNodeInstruction{}.operands));
  if (parts.size() < 4) node.fail("expected op, modes, result, data and operands");
  KestrelNodeInstruction step{};
  step.op = static_cast<uint32_t>(parts[0].choice(table().names));
  const Op& op = table().ops[step.op];
  const std::vector<JsonNode> modes = parts[1].items(op.modes.size());
  if (modes.size() != op.modes.size()) parts[1].fail("expected {} modes", op.modes.size());
  uint32_t digit = 1;
  for (size_t i = 0; i < modes.size(); ++i) {
    step.mode += digit * static_cast<uint32_t>(modes[i].choice(op.modes[i]));
    digit *= static_cast<uint32_t>(op.modes[i].size());
  }
  step.result = parts[2].integer(0, kMaximumOperand);
  step.data = parts[3].integer(0, kMaximumOperand);
  if (parts.size() != 4 + op.operands) {
    node.fail("expected {} operands, found {}", op.operands, parts.size() - 4);
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
  for (const JsonNode& step : node.require("steps").items(kMaximumInstructions)) {
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
  outputs.expect_keys(table().outputs);
  for (int i = 0; i < KESTREL_NODE_OUTPUTS; ++i) {
    const auto operand = outputs.find(table().outputs[i]);
    program.outputs[i] =
        operand ? operand->integer(-kMaximumOperand, kMaximumOperand) : KESTREL_NODE_UNSET;
  }
  return program;
}

}  // namespace kestrel::cli
