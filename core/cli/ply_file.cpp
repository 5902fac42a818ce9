// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/ply_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace kestrel::cli {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class Format { ascii, little_endian, big_endian };

constexpr size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};  // bytes, by Type

struct Property {
  std::string_view name;
  Type type = Type::float32;  // of a list: its items'
  bool is_list = false;
  Type count_type = Type::uint8;
};

struct Element {
  std::string_view name;
  size_t count = 0;
  std::vector<Property> properties;
};

[[noreturn]] void damaged(const std::string& reason) {
  throw std::runtime_error("damaged PLY file: " + reason);
}

/// Takes words and values off the front of the text.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}

  std::string_view rest() const { return rest_; }
  Format format = Format::ascii;

  /// The next line without its end; empty at the end of the text.
  std::string_view line() {
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view out = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (!out.empty() && out.back() == '\r') out.remove_suffix(1);
    return out;
  }

  double value(Type type) { return format == Format::ascii ? ascii_value() : binary_value(type); }

 private:
  double ascii_value() {
    while (!rest_.empty() && std::strchr(" \t\r\n", rest_.front())) rest_.remove_prefix(1);
    double out = 0.0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), out);
    if (error != std::errc()) damaged("a number is missing or is none");
    rest_.remove_prefix(static_cast<size_t>(end - rest_.data()));
    return out;
  }

  template <typename T>
  static double as(const std::array<char, 8>& bytes) {
    T out;
    std::memcpy(&out, bytes.data(), sizeof out);
    return static_cast<double>(out);
  }

  double binary_value(Type type) {
    const size_t size = kSizes[static_cast<int>(type)];
    if (rest_.size() < size) damaged("it ends too early");
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), rest_.data(), size);
    rest_.remove_prefix(size);
    const bool is_native =
        (format == Format::little_endian) == (std::endian::native == std::endian::little);
    if (!is_native) std::reverse(bytes.begin(), bytes.begin() + size);
    switch (type) {
      case Type::int8:
        return as<int8_t>(bytes);
      case Type::uint8:
        return as<uint8_t>(bytes);
      case Type::int16:
        return as<int16_t>(bytes);
      case Type::uint16:
        return as<uint16_t>(bytes);
      case Type::int32:
        return as<int32_t>(bytes);
      case Type::uint32:
        return as<uint32_t>(bytes);
      case Type::float32:
        return as<float>(bytes);
      case Type::float64:
        return as<double>(bytes);
    }
    return 0.0;
  }

  std::string_view rest_;
};

// ---- header ------------------------------------------------------------------------------------

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const size_t end = std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

Type type_of(std::string_view name) {
  static constexpr std::string_view kNames[][2] = {
      {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
      {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
  for (int i = 0; i < 8; ++i) {
    if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<Type>(i);
  }
  damaged("its header names an unknown type");
}

Format format_of(std::string_view name) {
  if (name == "ascii") return Format::ascii;
  if (name == "binary_little_endian") return Format::little_endian;
  if (name == "binary_big_endian") return Format::big_endian;
  damaged("its header names an unknown format");
}

/// Reads up to "end_header"; sets the reader's format.
std::vector<Element> read_header(Reader& reader) {
  if (reader.line() != "ply") damaged("it does not begin with 'ply'");
  std::vector<Element> elements;
  bool has_format = false;
  while (true) {
    if (reader.rest().empty()) damaged("its header has no end");
    const auto words = words_of(reader.line());
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() >= 2) {
      reader.format = format_of(words[1]);
      has_format = true;
    } else if (words[0] == "element" && words.size() == 3) {
      Element element{words[1], 0, {}};
      const char* end = words[2].data() + words[2].size();
      if (std::from_chars(words[2].data(), end, element.count).ptr != end) {
        damaged("its header has a count that is no number");
      }
      elements.push_back(std::move(element));
    } else if (words[0] == "property" && !elements.empty() && words.size() == 3) {
      elements.back().properties.push_back({words[2], type_of(words[1])});
    } else if (words[0] == "property" && !elements.empty() && words.size() == 5 &&
               words[1] == "list") {
      elements.back().properties.push_back({words[4], type_of(words[3]), true, type_of(words[2])});
    } else {
      damaged("its header has a line that is not understood");
    }
  }
  if (!has_format) damaged("its header names no format");
  return elements;
}

/// A text of this length cannot hold more rows than this; keeps wrong counts from taking memory.
void expect_room(const Element& element, const Reader& reader) {
  size_t row = 0;
  for (const Property& p : element.properties) {
    const Type first = p.is_list ? p.count_type : p.type;
    row += reader.format == Format::ascii ? 2 : kSizes[static_cast<int>(first)];
  }
  if (row > 0 && element.count > reader.rest().size() / row + 1) damaged("it ends too early");
}

// ---- body --------------------------------------------------------------------------------------

size_t list_length(Reader& reader, const Property& property) {
  const double count = reader.value(property.count_type);
  const double limit = static_cast<double>(reader.rest().size());
  if (!(count >= 0.0 && count <= limit && count == std::floor(count))) {
    damaged("a list has an impossible length");
  }
  return static_cast<size_t>(count);
}

void skip_row(Reader& reader, const Element& element) {
  for (const Property& p : element.properties) {
    const size_t count = p.is_list ? list_length(reader, p) : 1;
    for (size_t i = 0; i < count; ++i) reader.value(p.type);
  }
}

/// Where the vertex property of this name goes: 0…2 position, 3…5 normal, 6…7 UV, 8 nowhere.
int vertex_target(std::string_view name) {
  static constexpr std::string_view kNames[][4] = {{"x"},
                                                   {"y"},
                                                   {"z"},
                                                   {"nx"},
                                                   {"ny"},
                                                   {"nz"},
                                                   {"u", "s", "texture_u", "texture_s"},
                                                   {"v", "t", "texture_v", "texture_t"}};
  for (int i = 0; i < 8; ++i) {
    for (const std::string_view known : kNames[i]) {
      if (!known.empty() && name == known) return i;
    }
  }
  return 8;
}

struct Vertices {
  std::vector<vec3> positions, normals;  // normals: empty where the file has none
  std::vector<vec2> uvs;
};

void read_vertices(Reader& reader, const Element& element, Vertices& out) {
  std::vector<int> targets;
  std::array<bool, 9> has{};
  for (const Property& p : element.properties) {
    targets.push_back(p.is_list ? 8 : vertex_target(p.name));
    has[targets.back()] = true;
  }
  if (!has[0] || !has[1] || !has[2]) damaged("its vertices have no x, y and z");
  for (size_t row = 0; row < element.count; ++row) {
    std::array<float, 9> v{};
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const Property& p = element.properties[i];
      const size_t count = p.is_list ? list_length(reader, p) : 1;
      for (size_t k = 0; k < count; ++k) v[targets[i]] = static_cast<float>(reader.value(p.type));
    }
    out.positions.emplace_back(v[0], v[1], v[2]);
    if (has[3] && has[4] && has[5]) out.normals.emplace_back(v[3], v[4], v[5]);
    if (has[6] && has[7]) out.uvs.emplace_back(v[6], v[7]);
  }
}

void read_faces(Reader& reader, const Element& element, std::vector<uvec3>& triangles) {
  std::vector<double> corners;
  for (size_t row = 0; row < element.count; ++row) {
    corners.clear();
    for (const Property& p : element.properties) {
      const bool is_face = p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
      const size_t count = p.is_list ? list_length(reader, p) : 1;
      for (size_t i = 0; i < count; ++i) {
        const double v = reader.value(p.type);
        if (is_face) corners.push_back(v);
      }
    }
    for (const double c : corners) {
      if (!(c >= 0.0 && c < 4294967296.0)) damaged("a face refers to a vertex that is not there");
    }
    for (size_t i = 2; i < corners.size(); ++i) {
      triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
    }
  }
}

}  // namespace

MeshDescription read_ply(const std::string& text) {
  Reader reader(text);
  const std::vector<Element> elements = read_header(reader);
  Vertices vertices;
  MeshDescription mesh;
  for (const Element& element : elements) {
    expect_room(element, reader);
    if (element.name == "vertex") {
      read_vertices(reader, element, vertices);
    } else if (element.name == "face") {
      read_faces(reader, element, mesh.triangles);
    } else if (!element.properties.empty()) {
      for (size_t row = 0; row < element.count; ++row) skip_row(reader, element);
    }
  }
  for (const uvec3& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      if (t[i] >= vertices.positions.size()) damaged("a face refers to a vertex that is not there");
      if (!vertices.normals.empty()) mesh.corner_normals.push_back(vertices.normals[t[i]]);
      if (!vertices.uvs.empty()) mesh.corner_uvs.push_back(vertices.uvs[t[i]]);
    }
  }
  mesh.positions = std::move(vertices.positions);
  return mesh;
}

}  // namespace kestrel::cli
