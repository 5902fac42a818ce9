// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/node_program.h"

#include <algorithm>

#include "base/error.h"
#include "shading/node_table.h"

namespace kestrel {
namespace {

constexpr size_t kMaxInstructions = 65536;

/// Checks the numbers of one material's program.
class Checker {
 public:
  Checker(const NodeProgram& program, const std::string& material)
      : program_(program), material_(material) {}

  template <typename... Values>
  [[noreturn]] void refuse(fmt::format_string<Values...> text, Values&&... values) const {
    fail(ErrorCode::invalid_argument, "Material '{}': in its node program {}.", material_,
         fmt::format(text, std::forward<Values>(values)...));
  }

  void instruction(size_t index) const {
    const nodes::NodeInstruction& step = program_.instructions[index];
    if (step.op >= node_table().size()) {
      refuse("instruction {} has op {}; there are {}", index, step.op, node_table().size());
    }
    const NodeOp& op = node_table()[step.op];
    if (step.mode >= op.mode_count()) {
      refuse("instruction {} ({}) has mode {} of {}", index, op.name, step.mode, op.mode_count());
    }
    if (step.result < 0 || step.result >= nodes::kNodeRegisters) {
      refuse("instruction {} ({}) writes register {}; there are {}", index, op.name, step.result,
             nodes::kNodeRegisters);
    }
    for (size_t i = 0; i < op.operands.size(); ++i) operand(step.operands[i], op.name);
    data(step, op);
  }

  void operand(int value, std::string_view user) const {
    const bool constant = value < 0;
    const int64_t number = constant ? -1 - int64_t{value} : value;
    const auto count =
        constant ? static_cast<int64_t>(program_.constants.size()) : nodes::kNodeRegisters;
    if (number >= count) {
      refuse("{} reads {} {}; there are {}", user, constant ? "constant" : "register", number,
             count);
    }
  }

 private:
  void data(const nodes::NodeInstruction& step, const NodeOp& op) const {
    size_t count = 1, used = 1;
    switch (op.data) {
      case NodeData::none:
        return;
      case NodeData::place:
        count = 3;
        break;
      case NodeData::texture:
        count = program_.texture_ids.size();
        break;
      case NodeData::attribute:
        count = program_.attributes.size();
        break;
      case NodeData::table:
        count = program_.constants.size();
        used = nodes::kNodeTableSize + (step.mode == 2 ? 1 : 0);
        break;
      case NodeData::constant:
        count = program_.constants.size();
        break;
    }
    if (step.data < 0 || static_cast<size_t>(step.data) + used > count) {
      refuse("{} has data {}, of {}", op.name, step.data, count);
    }
  }

  const NodeProgram& program_;
  const std::string& material_;
};

/// The instructions that some outputs need, in their order.
std::vector<nodes::NodeInstruction> needed_for(const NodeProgram& program,
                                               std::initializer_list<int> outputs) {
  std::array<bool, nodes::kNodeRegisters> wanted{};
  const auto want = [&](int operand) {
    if (operand >= 0) wanted[operand] = true;
  };
  for (const int output : outputs) {
    if (program.computes(output)) want(program.outputs[output]);
  }
  std::vector<nodes::NodeInstruction> out;
  for (auto step = program.instructions.rbegin(); step != program.instructions.rend(); ++step) {
    if (!wanted[step->result]) continue;
    wanted[step->result] = false;
    const size_t count = node_table()[step->op].operands.size();
    for (size_t i = 0; i < count; ++i) want(step->operands[i]);
    out.push_back(*step);
  }
  std::reverse(out.begin(), out.end());
  return out;
}

bool reads_tangent(const nodes::NodeInstruction& step) {
  return step.op == nodes::kNodeNormalMap ||
         (step.op == nodes::kNodeInput && step.mode == nodes::kInputTangent);
}

}  // namespace

bool NodeProgram::may_be_lit(int output) const {
  if (!computes(output)) return false;
  const int operand = outputs[output];
  return operand >= 0 || vec3(constants[-1 - operand]) != vec3(0.0f);
}

void check_program(NodeProgram& program, const std::string& material) {
  const Checker check(program, material);
  if (program.instructions.size() > kMaxInstructions) {
    check.refuse("there are {} instructions; at most {} are supported", program.instructions.size(),
                 kMaxInstructions);
  }
  for (size_t i = 0; i < program.instructions.size(); ++i) check.instruction(i);
  for (int output = 0; output < nodes::kNodeOutputs; ++output) {
    if (program.computes(output)) check.operand(program.outputs[output], node_outputs()[output]);
  }
  for (const vec4& constant : program.constants) {
    if (!is_finite(vec3(constant)) || !std::isfinite(constant.w)) {
      check.refuse("a constant is not finite");
    }
  }
  program.coverage =
      needed_for(program, {nodes::kNodeAlpha, nodes::kNodeTransmission, nodes::kNodeDiffuse});
  program.reads_tangent =
      std::any_of(program.instructions.begin(), program.instructions.end(), reads_tangent);
}

}  // namespace kestrel
