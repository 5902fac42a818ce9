// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/hash.h"

#include <algorithm>
#include <cstring>

namespace kestrel {
namespace {

// Fractional digits of pi.
constexpr uint64_t kKeys[8] = {0x243F6A8885A308D3, 0x13198A2E03707344, 0xA4093822299F31D0,
                               0x082EFA98EC4E6C89, 0x452821E638D01377, 0xBE5466CF34E90C6C,
                               0xC0AC29B7C97C50DD, 0x3F84D5B5B5470917};

/// Both halves of the 128-bit product.
uint64_t fold(uint64_t a, uint64_t b) {
  const auto product = static_cast<unsigned __int128>(a) * b;
  return static_cast<uint64_t>(product) ^ static_cast<uint64_t>(product >> 64);
}

/// Four chains that do not wait for each other. Every word goes into two of them, beside another
/// word each time, so that a factor that happens to be 0 hides nothing.
struct Chains {
  uint64_t a, b, c, d;

  void add(const uint64_t w[4]) {
    a = fold(w[0] ^ kKeys[0], w[1] ^ a);
    b = fold(w[2] ^ kKeys[1], w[3] ^ b);
    c = fold(w[3] ^ kKeys[2], w[0] ^ c);
    d = fold(w[1] ^ kKeys[3], w[2] ^ d);
  }
};

}  // namespace

Hash128 hash_bytes(std::span<const uint8_t> bytes, const Hash128& before) {
  Chains chains{before.low ^ kKeys[4], before.high ^ kKeys[5], before.high ^ kKeys[6],
                before.low ^ kKeys[7]};
  uint64_t words[4];
  size_t done = 0;
  for (; done + sizeof(words) <= bytes.size(); done += sizeof(words)) {
    std::memcpy(words, bytes.data() + done, sizeof(words));
    chains.add(words);
  }
  std::fill(std::begin(words), std::end(words), 0);
  if (done < bytes.size()) std::memcpy(words, bytes.data() + done, bytes.size() - done);
  chains.add(words);
  const uint64_t length[4] = {bytes.size(), kKeys[5], kKeys[6], bytes.size() ^ kKeys[7]};
  chains.add(length);
  return {fold(chains.a ^ kKeys[2], chains.b ^ kKeys[3]),
          fold(chains.c ^ kKeys[0], chains.d ^ kKeys[1])};
}

}  // namespace kestrel
