// SPDX-License-Identifier: GPL-3.0-or-later
// One value of a scene file together with where it stands, so that every reader's error names the
// file, the JSON pointer and what was expected.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kestrel::cli {

/// The user's scene file, or a file it names, is wrong. what() reads "FILE: POINTER: reason".
class SceneFileError : public std::runtime_error {
 public:
  SceneFileError(const std::string& file, std::string pointer, const std::string& reason)
      : std::runtime_error(pointer.empty() ? file + ": " + reason
                                           : file + ": " + pointer + ": " + reason),
        pointer_(std::move(pointer)) {}

  /// RFC 6901, "" where the file as a whole is meant.
  const std::string& pointer() const { return pointer_; }

 private:
  std::string pointer_;
};

/// The member of `known` with the fewest edits to `name`, or "" where none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// "; did you mean 'x'?" or "".
std::string did_you_mean(std::string_view name, const std::vector<std::string>& known);

/// Parses text with limits on depth (64) and without duplicate keys. Throws SceneFileError.
nlohmann::json parse_json(const std::string& text, const std::string& file);

/// A JSON value, its file and its pointer. Refers to the document, which must outlive it.
class JsonNode {
 public:
  JsonNode(const std::string& file, const nlohmann::json& value, std::string pointer = "")
      : file_(&file), value_(&value), pointer_(std::move(pointer)) {}

  const nlohmann::json& value() const { return *value_; }
  const std::string& pointer() const { return pointer_; }
  const std::string& file() const { return *file_; }

  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw SceneFileError(*file_, pointer_, fmt::format(format, std::forward<Args>(args)...));
  }

  /// Fails unless this is an object whose keys are all in `known`.
  void expect_keys(const std::vector<std::string>& known) const;
  bool has(const std::string& key) const { return value_->contains(key); }
  std::optional<JsonNode> find(const std::string& key) const;
  JsonNode require(const std::string& key) const;

  /// The entries of an array of at most `limit`.
  std::vector<JsonNode> items(size_t limit) const;

  /// Finite and within [minimum, maximum].
  float number(double minimum, double maximum) const;
  int integer(int minimum, int maximum) const;
  /// A whole number from 0 to 2^64 - 1.
  uint64_t whole() const;
  /// An angle given in degrees within [minimum, maximum], in radians.
  float radians(double minimum, double maximum) const;
  bool boolean() const;
  /// Not empty, no control characters.
  std::string text() const;
  /// As many finite numbers as fit `least` … `most`.
  std::vector<float> numbers(size_t least, size_t most, double minimum, double maximum) const;
  /// The index of the text in `names`.
  int choice(const std::vector<std::string>& names) const;

 private:
  [[noreturn]] void fail_type(std::string_view expected) const;

  const std::string* file_;
  const nlohmann::json* value_;
  std::string pointer_;
};

}  // namespace kestrel::cli
