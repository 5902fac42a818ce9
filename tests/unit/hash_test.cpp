// SPDX-License-Identifier: GPL-3.0-or-later
// The fingerprint of contents: every difference shows.
#include "base/hash.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <utility>
#include <vector>

namespace kestrel {
namespace {

using Known = std::set<std::pair<uint64_t, uint64_t>>;

bool is_new(Known& known, const Hash128& hash) {
  return known.emplace(hash.low, hash.high).second;
}

TEST(Hash, EveryBitAndEveryLengthCounts) {
  std::vector<uint8_t> bytes(150);
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>(37 * i);
  Known known;
  for (size_t length = 0; length <= bytes.size(); ++length) {
    EXPECT_TRUE(is_new(known, hash_bytes({bytes.data(), length})));
  }
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    EXPECT_TRUE(is_new(known, hash_bytes(bytes))) << "bit " << bit;
    bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
  }
}

TEST(Hash, LengthsOfZerosDiffer) {
  const std::vector<uint8_t> zeros(200);
  Known known;
  for (size_t length = 0; length <= zeros.size(); ++length) {
    EXPECT_TRUE(is_new(known, hash_bytes({zeros.data(), length})));
  }
}

TEST(Hash, WhatCameBeforeCounts) {
  const uint8_t a[] = {1, 2, 3}, b[] = {4, 5, 6};
  const Hash128 ab = hash_bytes(b, hash_bytes(a)), ba = hash_bytes(a, hash_bytes(b));
  EXPECT_NE(ab, ba);
  EXPECT_NE(ab, hash_bytes(b));
  EXPECT_EQ(ab, hash_bytes(b, hash_bytes(a)));
}

TEST(Hash, HalfOfTheBitsChangeWithOneBit) {
  std::vector<uint8_t> bytes(96);
  const Hash128 before = hash_bytes(bytes);
  int changed = 0;
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    const Hash128 after = hash_bytes(bytes);
    changed += std::popcount(before.low ^ after.low) + std::popcount(before.high ^ after.high);
    bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
  }
  EXPECT_NEAR(changed / (8.0 * 96.0), 64.0, 2.0);
}

}  // namespace
}  // namespace kestrel
