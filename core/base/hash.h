// SPDX-License-Identifier: GPL-3.0-or-later
// A fingerprint of bytes: the same bytes in the same order give the same 128 bits, on every machine
// of this byte order. It tells contents apart by chance and not against an attacker.
#pragma once

#include <cstdint>
#include <span>

namespace kestrel {

struct Hash128 {
  uint64_t low = 0;
  uint64_t high = 0;
  bool operator==(const Hash128&) const = default;
};

/// The hash of what `before` is the hash of, followed by `bytes`.
Hash128 hash_bytes(std::span<const uint8_t> bytes, const Hash128& before = {});

}  // namespace kestrel
