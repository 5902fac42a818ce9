// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <unordered_set>
#include <utility>

namespace kestrel {
namespace {

/// What Cycles calls the material of objects that have none.
constexpr const char* kDefaultMaterial = "default_surface";

uint32_t mixed(uint32_t k) {
  return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u;
}

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

const char* matte_layer(MatteKind kind) {
  constexpr const char* kNames[kMatteKinds] = {"CryptoObject", "CryptoMaterial", "CryptoAsset"};
  return kNames[static_cast<int>(kind)];
}

uint32_t murmur_hash3(std::string_view text) {
  uint32_t h = 0;
  const size_t whole = text.size() / 4;
  for (size_t i = 0; i < whole; ++i) {
    uint32_t k;
    std::memcpy(&k, text.data() + 4 * i, sizeof(k));
    h = std::rotl(h ^ mixed(k), 13) * 5u + 0xe6546b64u;
  }
  uint32_t tail = 0;
  for (size_t i = text.size(); i-- > 4 * whole;) {
    tail = tail << 8 | static_cast<unsigned char>(text[i]);
  }
  h ^= mixed(tail);
  h ^= static_cast<uint32_t>(text.size());
  h = (h ^ h >> 16) * 0x85ebca6bu;
  h = (h ^ h >> 13) * 0xc2b2ae35u;
  return h ^ h >> 16;
}

float matte_id(std::string_view name) {
  const uint32_t hash = murmur_hash3(name);
  // Exponent 0 would make it denormal or 0, exponent 255 infinite or no number.
  const uint32_t exponent = std::clamp(hash >> 23 & 0xffu, 1u, 254u);
  return std::bit_cast<float>((hash & 0x807fffffu) | exponent << 23);
}

MatteIds::MatteIds(const Scene& scene, MatteKind kind) : kind_(kind) {
  std::unordered_set<std::string_view> listed;
  manifest_ = "{";
  const auto add = [&](const std::string& name) {
    ids_.push_back(matte_id(name));
    if (!listed.insert(name).second) return;
    manifest_ += fmt::format("{}{}:\"{:08x}\"", manifest_.size() > 1 ? "," : "", quoted(name),
                             std::bit_cast<uint32_t>(ids_.back()));
  };
  if (kind == MatteKind::material) {
    static const std::string default_material = kDefaultMaterial;
    for (size_t i = 0; i < scene.materials.size(); ++i) {
      add(i == 0 ? default_material : scene.materials[i].name);
    }
  } else {
    for (const Object& object : scene.objects) {
      add(kind == MatteKind::object ? object.name : object.asset);
    }
  }
  manifest_ += "}";
}

void MatteSlots::add(size_t pixel, float id, float weight) const {
  if (!(weight > 0.0f)) return;
  for (size_t level = 0; level < levels(); ++level) {
    float* at = slot(pixel, level);
    if (at[0] != id && at[0] != 0.0f) continue;
    at[0] = id;
    at[1] += weight;
    return;
  }
}

void MatteSlots::finish(size_t pixel, float scale) const {
  std::array<std::pair<float, float>, kMatteLevels> found;  // weight, id
  size_t count = 0;
  for (; count < levels() && slot(pixel, count)[0] != 0.0f; ++count) {
    found[count] = {slot(pixel, count)[1] * scale, slot(pixel, count)[0]};
  }
  std::stable_sort(found.begin(), found.begin() + static_cast<ptrdiff_t>(count),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (size_t level = 0; level < count; ++level) {
    slot(pixel, level)[0] = found[level].second;
    slot(pixel, level)[1] = found[level].first;
  }
}

}  // namespace kestrel
