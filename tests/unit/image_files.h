// SPDX-License-Identifier: GPL-3.0-or-later
// Image files made byte by byte from their specifications, to check readers against.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace kestrel::test {

using Bytes = std::vector<uint8_t>;

/// The plug-in of this build, unless the environment names another.
inline const bool kPluginNamed =
    setenv("KESTREL_IMAGE_PLUGIN", KESTREL_BINARY_DIR "/libkestrel_oiio.so", 0) == 0;

inline void put_be(Bytes& out, uint32_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

/// The checksum of PNG (specification, annex D).
inline uint32_t crc32(const uint8_t* data, size_t count) {
  uint32_t crc = 0xFFFFFFFFu;
  for (size_t i = 0; i < count; ++i) {
    crc ^= data[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xEDB88320u : 0);
  }
  return ~crc;
}

inline void put_chunk(Bytes& out, const char* type, const Bytes& data) {
  put_be(out, static_cast<uint32_t>(data.size()), 4);
  const size_t begin = out.size();
  out.insert(out.end(), type, type + 4);
  out.insert(out.end(), data.begin(), data.end());
  put_be(out, crc32(&out[begin], out.size() - begin), 4);
}

/// zlib's format with a single stored block; at most 65535 bytes.
inline Bytes stored_zlib(const Bytes& data) {
  Bytes out = {0x78, 0x01, 0x01};
  const auto size = static_cast<uint16_t>(data.size());
  for (const uint16_t v : {size, static_cast<uint16_t>(~size)}) {
    out.push_back(static_cast<uint8_t>(v));
    out.push_back(static_cast<uint8_t>(v >> 8));
  }
  uint32_t a = 1, b = 0;
  for (const uint8_t byte : data) {
    out.push_back(byte);
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  put_be(out, (b << 16) | a, 4);
  return out;
}

enum PngColor : uint8_t { kPngGrey = 0, kPngRgb = 2, kPngGreyAlpha = 4, kPngRgba = 6 };

/// `samples`: the top row first, as in every PNG. 16-bit samples are big-endian pairs of bytes.
inline Bytes make_png(uint32_t width, uint32_t height, PngColor color, uint8_t bits,
                      const Bytes& samples) {
  Bytes out = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  Bytes header;
  put_be(header, width, 4);
  put_be(header, height, 4);
  header.insert(header.end(), {bits, color, 0, 0, 0});
  put_chunk(out, "IHDR", header);
  Bytes rows;
  const size_t row_bytes = height ? samples.size() / height : 0;
  for (size_t y = 0; y < height && row_bytes; ++y) {
    rows.push_back(0);  // no filter
    rows.insert(rows.end(), &samples[y * row_bytes], &samples[y * row_bytes] + row_bytes);
  }
  put_chunk(out, "IDAT", stored_zlib(rows));
  put_chunk(out, "IEND", {});
  return out;
}

/// Radiance's format, flat; `rgbe`: the top row first.
inline Bytes make_hdr(int width, int height, const Bytes& rgbe) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) +
                             " +X " + std::to_string(width) + "\n";
  Bytes out(header.begin(), header.end());
  out.insert(out.end(), rgbe.begin(), rgbe.end());
  return out;
}

/// A folder that goes with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "kestrel-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  size_t file_count() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string save(const std::string& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  return path;
}

inline Bytes load(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), {});
}

}  // namespace kestrel::test
