// SPDX-License-Identifier: GPL-3.0-or-later
// Prints values of the nodes' functions, so that tests can hold them against Blender's.
//
//     node_values < request
//
// The request's first line is a function of evaluate.h and its parameters, each other line a point
// "x y z w". One line "x y z w" is printed for each point. Exit status 2: the request is wrong.
#include <iostream>
#include <sstream>
#include <string>

#include "evaluate.h"

namespace {

using namespace kestrel::nodes;

/// The function's place in the table, or -1.
int find_function(std::string_view name) {
  for (size_t i = 0; i < kNodeFunctions.size(); ++i) {
    if (kNodeFunctions[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/// How many parameters the function has.
size_t parameter_count(int function) {
  std::istringstream words{std::string(kNodeFunctions[static_cast<size_t>(function)].parameters)};
  size_t count = 0;
  for (std::string word; words >> word;) ++count;
  return count;
}

int fail(const std::string& text) {
  std::cerr << "node_values: " << text << '\n';
  return 2;
}

}  // namespace

int main() {
  std::string line, name;
  if (!std::getline(std::cin, line)) return fail("the request is empty");
  std::istringstream words(line);
  words >> name;
  const int function = find_function(name);
  if (function < 0) return fail("there is no function '" + name + "'");
  float parameters[kParameters] = {};
  size_t count = 0;
  for (float value; count < kParameters && words >> value;) parameters[count++] = value;
  if (count != parameter_count(function)) return fail(name + " has other parameters");
  std::cout.precision(9);
  vec4 at;
  while (std::cin >> at.x >> at.y >> at.z >> at.w) {
    const vec4 value = evaluate(function, parameters, at);
    std::cout << value.x << ' ' << value.y << ' ' << value.z << ' ' << value.w << '\n';
  }
  return std::cin.eof() ? 0 : fail("a point is not four numbers");
}
