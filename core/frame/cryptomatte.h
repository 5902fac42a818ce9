// SPDX-License-Identifier: GPL-3.0-or-later
// Cryptomatte (specification 1.2.0): mattes of everything in the picture, told apart by a hash of
// its name. Every pixel lists what is in it with the share that it covers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace kestrel {

enum class MatteKind : uint8_t { object, material, asset };
inline constexpr int kMatteKinds = 3;

/// "CryptoObject": what the names of its passes begin with.
const char* matte_layer(MatteKind kind);

/// How many things a pixel can list, as in Cycles; each pass holds two.
inline constexpr int kMatteLevels = 16;
inline constexpr int kMattePasses = kMatteLevels / 2;

/// MurmurHash3 for 32 bits (x86), with 0 as its seed.
uint32_t murmur_hash3(std::string_view text);

/// The hash of a name as a number; its bits are changed where they are no ordinary number. Never 0.
float matte_id(std::string_view name);

/// The ids of one kind of a scene's items.
class MatteIds {
 public:
  /// Knows nothing.
  MatteIds() = default;
  MatteIds(const Scene& scene, MatteKind kind);

  /// Id of what a pixel shows; `object` and `material` as in the G-buffer, not nothing.
  float of(uint32_t object, uint32_t material) const {
    return kind_ == MatteKind::material ? ids_[material] : ids_[object - 1];
  }

  /// JSON object: the hexadecimal digits of the id's bits by name.
  const std::string& manifest() const { return manifest_; }

 private:
  MatteKind kind_ = MatteKind::object;
  std::vector<float> ids_;  // by object, or by material
  std::string manifest_ = "{}";
};

/// The slots of one pixel, spread over planes of two (id, weight) pairs a pixel; id 0: empty.
class MatteSlots {
 public:
  /// `planes`: one for each pass. They must outlive it.
  explicit MatteSlots(std::vector<float*> planes) : planes_(std::move(planes)) {}

  /// Adds a sample. Where every slot is taken by something else it is left out.
  void add(size_t pixel, float id, float weight) const;

  /// Multiplies the weights, and puts the largest first.
  void finish(size_t pixel, float scale) const;

 private:
  float* slot(size_t pixel, size_t level) const {
    return planes_[level / 2] + 4 * pixel + 2 * (level % 2);
  }
  size_t levels() const { return 2 * planes_.size(); }

  std::vector<float*> planes_;
};

}  // namespace kestrel
