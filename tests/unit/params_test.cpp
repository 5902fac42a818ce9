// SPDX-License-Identifier: GPL-3.0-or-later
// The parameter table: every row, through names and text, as the hosts use it.
#include "params/params.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"

namespace kestrel {
namespace {

/// The message of the error that setting `name` to `value` gives, or "" where it is accepted.
template <typename S>
std::string refusal(std::string_view name, std::string_view value) {
  S settings;
  const std::string before = get_parameter(settings, name);
  try {
    set_parameter(settings, name, value);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_EQ(get_parameter(settings, name), before) << "a refused value must change nothing";
    return error.what();
  }
  return "";
}

std::string refusal(const Parameter& p, std::string_view value) {
  return p.scope == ParameterScope::scene ? refusal<Settings>(p.name, value)
                                          : refusal<ObjectSettings>(p.name, value);
}

template <typename S>
std::string round_trip(std::string_view name, std::string_view value) {
  S settings;
  set_parameter(settings, name, value);
  return get_parameter(settings, name);
}

std::string round_trip(const Parameter& p, std::string_view value) {
  return p.scope == ParameterScope::scene ? round_trip<Settings>(p.name, value)
                                          : round_trip<ObjectSettings>(p.name, value);
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

bool is_number(const Parameter& p) {
  return p.type == ParameterType::integer || p.type == ParameterType::real;
}

TEST(Parameters, EveryDefaultIsThatOfTheStruct) {
  for (const Parameter& p : parameter_table()) {
    const std::string initial = p.scope == ParameterScope::scene
                                    ? get_parameter(Settings(), p.name)
                                    : get_parameter(ObjectSettings(), p.name);
    EXPECT_EQ(initial, round_trip(p, p.default_value)) << p.name;
    EXPECT_EQ(initial, p.default_value) << p.name << ": hosts compare the text";
  }
}

TEST(Parameters, EveryRowIsDocumentedAndItsNameUnique) {
  std::set<std::string> seen;
  for (const Parameter& p : parameter_table()) {
    EXPECT_TRUE(
        seen.insert((p.scope == ParameterScope::scene ? "scene." : "object.") + std::string(p.name))
            .second)
        << p.name;
    EXPECT_GT(p.help.size(), 20u) << p.name;
    EXPECT_EQ(p.type == ParameterType::enumeration, !p.items.empty()) << p.name;
    EXPECT_EQ(is_number(p) || p.type == ParameterType::color, p.minimum < p.maximum) << p.name;
    EXPECT_EQ(find_parameter(p.scope, p.name).help, p.help);
  }
}

TEST(Parameters, NumbersRoundTripAtBothEndsOfTheirRange) {
  for (const Parameter& p : parameter_table()) {
    if (!is_number(p)) continue;
    for (const double value : {p.minimum, p.maximum}) {
      const std::string once = round_trip(p, fmt::format("{}", value));
      EXPECT_FLOAT_EQ(std::stof(once), static_cast<float>(value)) << p.name;
      EXPECT_EQ(round_trip(p, once), once) << p.name << ": what is read can be set again";
    }
  }
}

TEST(Parameters, NumbersOutOfRangeAreRefusedWithTheRange) {
  for (const Parameter& p : parameter_table()) {
    if (!is_number(p)) continue;
    for (const std::string& value :
         {fmt::format("{}", p.minimum - 1), fmt::format("{}", p.maximum * 2), std::string("1e400"),
          std::string("inf"), std::string("nan")}) {
      const std::string message = refusal(p, value);
      EXPECT_TRUE(contains(message, "'" + std::string(p.name) + "'")) << p.name << ": " << message;
      EXPECT_TRUE(contains(message, fmt::format("from {} to {}", p.minimum, p.maximum))) << message;
      EXPECT_TRUE(contains(message, "'" + value + "'")) << message;
    }
  }
}

TEST(Parameters, WhatIsNoNumberIsRefused) {
  for (const char* value : {"", " ", "x", "1x", "1 2", "0x10", "1,5", "--1"}) {
    EXPECT_NE(refusal<Settings>("budget_ms", value), "") << value;
    EXPECT_NE(refusal<Settings>("samples", value), "") << value;
  }
  EXPECT_TRUE(contains(refusal<Settings>("samples", "1.5"), "whole number"));
  EXPECT_EQ(round_trip<Settings>("samples", "64"), "64");
  EXPECT_EQ(round_trip<Settings>("budget_ms", "16.6"), "16.6");
  EXPECT_EQ(round_trip<Settings>("selection_inertia", "1e6"),
            round_trip<Settings>("selection_inertia", "1000000"));
}

TEST(Parameters, EveryItemOfAnEnumerationRoundTripsAndAWrongOneListsThem) {
  for (const Parameter& p : parameter_table()) {
    if (p.type != ParameterType::enumeration) continue;
    for (const std::string_view item : p.items) EXPECT_EQ(round_trip(p, item), item);
    for (const char* value : {"", "no such item", "0"}) {
      const std::string message = refusal(p, value);
      for (const std::string_view item : p.items) EXPECT_TRUE(contains(message, item)) << message;
    }
  }
}

TEST(Parameters, ItemsStandInTheOrderOfTheirEnumeration) {
  Settings s;
  set_parameter(s, "selection", "none");
  EXPECT_EQ(s.selection, SelectionPolicy::none);
  set_parameter(s, "selection", "all");
  EXPECT_EQ(s.selection, SelectionPolicy::all);
  set_parameter(s, "primary", "rays");
  EXPECT_EQ(s.primary, Primary::rays);
  set_parameter(s, "primary", "raster");
  EXPECT_EQ(s.primary, Primary::raster);
  set_parameter(s, "tracer", "embree");
  EXPECT_EQ(s.tracer, TracerKind::embree);
  set_parameter(s, "pixel_filter", "box");
  EXPECT_EQ(s.pixel_filter, PixelFilter::box);
  ObjectSettings o;
  set_parameter(o, "shadows", "never");
  set_parameter(o, "reflections", "always");
  set_parameter(o, "refractions", "auto");
  EXPECT_EQ(o.shadows, EffectMode::never);
  EXPECT_EQ(o.reflections, EffectMode::always);
  EXPECT_EQ(o.refractions, EffectMode::automatic);
}

TEST(Parameters, EachNameSetsItsOwnField) {
  // Every row takes a value that is not its default; after one is set, only its text has changed.
  for (const Parameter& p : parameter_table()) {
    if (p.scope != ParameterScope::scene) continue;
    std::string value = p.type == ParameterType::boolean ? "true" : "0.5 0.25 2";
    if (is_number(p)) value = fmt::format("{}", p.maximum);
    if (p.type == ParameterType::enumeration) value = p.items.back();
    Settings changed;
    set_parameter(changed, p.name, value);
    for (const Parameter& other : parameter_table()) {
      if (other.scope != ParameterScope::scene || other.name == p.name) continue;
      EXPECT_EQ(get_parameter(changed, other.name), get_parameter(Settings(), other.name))
          << p.name << " changed " << other.name;
    }
  }
  ObjectSettings o;
  set_parameter(o, "relevance", "3");
  set_parameter(o, "cost", "2");
  EXPECT_EQ(o.relevance, 3.0f);
  EXPECT_EQ(o.cost, 2.0f);
}

TEST(Parameters, BooleansTakeTrueAndFalse) {
  for (const char* value : {"true", "1"}) {
    EXPECT_EQ(round_trip<Settings>("validate_areas", value), "true");
  }
  for (const char* value : {"false", "0"}) {
    EXPECT_EQ(round_trip<Settings>("validate_areas", value), "false");
  }
  EXPECT_TRUE(contains(refusal<Settings>("validate_areas", "yes"), "true or false"));
}

TEST(Parameters, ColoursTakeThreeNumbersHoweverSpaced) {
  EXPECT_EQ(round_trip<Settings>("ambient", "0.1 0.2 0.3"), "0.1 0.2 0.3");
  EXPECT_EQ(round_trip<Settings>("ambient", "  0.1   0.2 0.3 "), "0.1 0.2 0.3");
  for (const char* value : {"", "1", "1 2", "1 2 3 4", "1,2,3"}) {
    EXPECT_TRUE(contains(refusal<Settings>("ambient", value), "three numbers")) << value;
  }
  EXPECT_TRUE(contains(refusal<Settings>("ambient", "1 -1 1"), "from 0 to 1000000"));
  EXPECT_TRUE(contains(refusal<Settings>("ambient", "1 red 1"), "'red'"));
}

TEST(Parameters, AnUnknownNameIsRefusedWithTheKnownOnes) {
  Settings s;
  try {
    set_parameter(s, "budget", "1");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_TRUE(contains(error.what(), "'budget'"));
    EXPECT_TRUE(contains(error.what(), "budget_ms"));
  }
  EXPECT_THROW(find_parameter(ParameterScope::scene, "relevance"), Error) << "another scope's";
  EXPECT_THROW(find_parameter(ParameterScope::object, "budget_ms"), Error) << "another scope's";
  EXPECT_THROW(get_parameter(ObjectSettings(), ""), Error);
}

TEST(Parameters, TheJsonTableHasEveryRowWhole) {
  const auto table = nlohmann::json::parse(parameter_table_json());
  ASSERT_TRUE(table.is_array());
  ASSERT_EQ(table.size(), parameter_table().size());
  for (size_t i = 0; i < table.size(); ++i) {
    const Parameter& p = parameter_table()[i];
    const auto& entry = table[i];
    EXPECT_EQ(entry.at("name"), p.name);
    EXPECT_EQ(entry.at("scope"), p.scope == ParameterScope::scene ? "scene" : "object");
    EXPECT_EQ(entry.at("default"), p.default_value);
    EXPECT_EQ(entry.at("unit"), p.unit);
    EXPECT_EQ(entry.at("paper"), p.paper);
    EXPECT_EQ(entry.at("help"), p.help);
    const std::string type = entry.at("type");
    EXPECT_EQ(type == "enum", entry.contains("items")) << p.name;
    EXPECT_EQ(type == "int" || type == "float" || type == "color", entry.contains("min")) << p.name;
    EXPECT_EQ(entry.contains("min"), entry.contains("max")) << p.name;
    EXPECT_EQ(entry.value("items", std::vector<std::string>()),
              std::vector<std::string>(p.items.begin(), p.items.end()));
    if (type == "int" || type == "float") {
      EXPECT_EQ(entry["min"], p.minimum);
      EXPECT_EQ(entry["max"], p.maximum);
    }
  }
}

TEST(Parameters, ThePapersFourSettingsAreThere) {
  const auto letter = [](ParameterScope scope, const char* name) {
    return find_parameter(scope, name).paper;
  };
  EXPECT_EQ(letter(ParameterScope::scene, "budget_ms"), "T");
  EXPECT_EQ(letter(ParameterScope::scene, "selection_inertia"), "I");
  EXPECT_EQ(letter(ParameterScope::object, "relevance"), "K");
  EXPECT_EQ(letter(ParameterScope::object, "cost"), "E");
}

}  // namespace
}  // namespace kestrel
