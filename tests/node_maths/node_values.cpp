// SPDX-License-Identifier: GPL-3.0-or-later
// Prints values of the nodes' functions, so that tests can hold them against Blender's.
//
//     node_values < request
//
// The request's first line is a function of evaluate.h and its parameters, each other line a point
// "x y z w". One line "x y z w" is printed for each point. Exit status 2: the request is wrong.
#include <iostream>

#include "evaluate.h"

int main() {
  std::string line;
  std::getline(std::cin, line);
  auto call = kestrel::nodes::parse_call(line);
  if (!call) {
    std::cerr << "node_values: '" << line << "' is no function with its parameters\n";
    return 2;
  }
  std::cout.precision(9);
  kestrel::nodes::vec4 at;
  while (std::cin >> at.x >> at.y >> at.z >> at.w) {
    const auto value = (*call)(at);
    std::cout << value.x << ' ' << value.y << ' ' << value.z << ' ' << value.w << '\n';
  }
  if (std::cin.eof()) return 0;
  std::cerr << "node_values: a point is not four numbers\n";
  return 2;
}
