// SPDX-License-Identifier: GPL-3.0-or-later
// Image files through the plug-in.
#include "images/images.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include "base/error.h"
#include "image_files.h"

namespace kestrel {
namespace {

using images::Layer;
using test::Bytes;
using test::TemporaryFolder;

Texture read(const std::string& path, bool srgb = false) {
  Texture texture;
  texture.srgb = srgb;
  images::read_file(path, texture);
  return texture;
}

Texture read(const Bytes& bytes, bool srgb = false) {
  Texture texture;
  texture.srgb = srgb;
  images::read_memory(bytes.data(), bytes.size(), texture);
  return texture;
}

/// The error of reading `bytes`; empty where there is none.
std::string failure(const Bytes& bytes) {
  try {
    read(bytes);
    return {};
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    return error.what();
  }
}

// ---- Reading ------------------------------------------------------------------------------------

TEST(ReadImage, RowZeroIsTheBottomOfThePicture) {
  // Top: red, green. Bottom: blue, white.
  const Bytes png =
      test::make_png(2, 2, test::kPngRgb, 8, {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255});
  const Texture t = read(png);
  EXPECT_EQ(t.width, 2);
  EXPECT_EQ(t.height, 2);
  EXPECT_EQ(t.channels8, 3) << "no alpha in the file";
  EXPECT_EQ(t.texels8, (Bytes{0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255, 0}));
  EXPECT_TRUE(t.texels_float.empty());
}

TEST(ReadImage, GreyBecomesGreyRgb) {
  EXPECT_EQ(read(test::make_png(2, 1, test::kPngGrey, 8, {10, 200})).texels8,
            (Bytes{10, 10, 10, 200, 200, 200}));
}

TEST(ReadImage, AlphaStaysStraight) {
  EXPECT_EQ(read(test::make_png(1, 1, test::kPngRgba, 8, {200, 100, 50, 3})).texels8,
            (Bytes{200, 100, 50, 3}));
  EXPECT_EQ(read(test::make_png(1, 1, test::kPngGreyAlpha, 8, {77, 128})).texels8,
            (Bytes{77, 77, 77, 128}));
  EXPECT_EQ(read(test::make_png(1, 1, test::kPngRgba, 8, {200, 100, 50, 0})).texels8,
            (Bytes{200, 100, 50, 0}))
      << "what lies under a transparent texel bleeds in at its edges, so it must not turn black";
}

TEST(ReadImage, SixteenBitsKeepTheirDigitsAndObeySrgb) {
  const Bytes png = test::make_png(1, 1, test::kPngRgb, 16, {0x80, 0x01, 0xFF, 0xFF, 0, 0});
  const float encoded = 32769.0f / 65535.0f;
  const Texture plain = read(png, false);
  ASSERT_EQ(plain.texels_float.size(), 4u);
  EXPECT_FLOAT_EQ(plain.texels_float[0], encoded);
  EXPECT_FLOAT_EQ(plain.texels_float[3], 1.0f);
  const Texture color = read(png, true);
  EXPECT_NEAR(color.texels_float[0], std::pow((encoded + 0.055) / 1.055, 2.4), 1e-6);
  EXPECT_FLOAT_EQ(color.texels_float[1], 1.0f);
  EXPECT_FLOAT_EQ(color.texels_float[2], 0.0f);
}

TEST(ReadImage, RadianceFilesAreLinearWhateverIsSaidOfSrgb) {
  // Top: (1, 0.5, 0.25) = mantissas 128, 64, 32 with exponent 129. Bottom: eight times 1.
  const Bytes hdr = test::make_hdr(1, 2, {128, 64, 32, 129, 128, 128, 128, 132});
  const Texture t = read(hdr, true);
  ASSERT_EQ(t.texels_float.size(), 8u);
  EXPECT_NEAR(t.texels_float[0], 8.0f, 0.05f);
  EXPECT_NEAR(t.texels_float[4], 1.0f, 0.01f);
  EXPECT_NEAR(t.texels_float[5], 0.5f, 0.01f);
  EXPECT_NEAR(t.texels_float[6], 0.25f, 0.01f);
}

TEST(ReadImage, FileAndMemoryGiveTheSameTexels) {
  const TemporaryFolder folder;
  const Bytes png =
      test::make_png(3, 1, test::kPngRgba, 8, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  EXPECT_EQ(read(test::save(folder.file("a.png"), png)).texels8, read(png).texels8);
}

TEST(ReadImage, TheFormatIsTakenFromTheBytesNotTheName) {
  const TemporaryFolder folder;
  const Bytes png = test::make_png(1, 1, test::kPngGrey, 8, {9});
  EXPECT_EQ(read(test::save(folder.file("a.jpg"), png)).texels8, (Bytes{9, 9, 9}));
}

TEST(ReadImage, ErrorsNameTheFileAndTheCause) {
  const TemporaryFolder folder;
  const auto message = [](const std::string& path) -> std::string {
    try {
      read(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::file);
      return error.what();
    }
    return "read without an error";
  };
  const std::string missing = message(folder.file("missing.png"));
  EXPECT_NE(missing.find("missing.png"), std::string::npos) << missing;
  EXPECT_NE(missing.find("no such file"), std::string::npos) << missing;
  EXPECT_NE(message(folder.file("")).find("folder"), std::string::npos);
  const std::string text = test::save(folder.file("notes.txt"), {'h', 'e', 'l', 'l', 'o'});
  EXPECT_NE(message(text).find("notes.txt"), std::string::npos);
  EXPECT_NE(message(test::save(folder.file("empty.png"), {})).find("empty.png"), std::string::npos);
}

TEST(ReadImage, TruncatedFilesAreErrors) {
  Bytes samples(64 * 64 * 3);
  std::mt19937 random(1);
  for (uint8_t& s : samples) s = static_cast<uint8_t>(random());
  const Bytes png = test::make_png(64, 64, test::kPngRgb, 8, samples);
  ASSERT_EQ(failure(png), "");
  for (size_t size = 0; size < png.size() - 64; size += 97) {
    EXPECT_NE(failure(Bytes(png.begin(), png.begin() + static_cast<long>(size))), "") << size;
  }
}

TEST(ReadImage, DamagedFilesNeverCrash) {
  const TemporaryFolder folder;
  std::vector<float> pixels(32 * 32 * 4, 0.5f);
  images::write_file(folder.file("a.exr"), 32, 32, {{"Combined", "RGBA", pixels.data()}});
  const Bytes exr = test::load(folder.file("a.exr"));
  const Bytes png = test::make_png(32, 32, test::kPngGrey, 8, Bytes(32 * 32, 7));
  std::mt19937 random(2);
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    Bytes bytes = i % 2 ? exr : png;
    for (int flips = 0; flips < 4; ++flips) {
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    }
    refused += !failure(bytes).empty();
  }
  EXPECT_GT(refused, 100);
}

TEST(ReadImage, HugeSizesAreRefusedBeforeMemoryIsTaken) {
  const std::string reason = failure(test::make_png(40000, 40000, test::kPngRgba, 8, {}));
  EXPECT_NE(reason.find("40000 x 40000"), std::string::npos) << reason;
  EXPECT_NE(reason.find("32768"), std::string::npos) << reason;
}

TEST(ReadImage, TheStandInIsMagenta) {
  Texture t;
  t.texels_float = {1, 2, 3, 4};
  images::fill_missing(t);
  EXPECT_EQ(t.width * t.height, 1);
  EXPECT_EQ(t.texels8, (Bytes{255, 0, 255, 255}));
  EXPECT_TRUE(t.texels_float.empty());
}

// ---- Writing ------------------------------------------------------------------------------------

/// Channel names and their types (1 half, 2 float) of an EXR file, and its compression (3 ZIP),
/// from the header as OpenEXR's file layout describes it.
struct ExrHeader {
  std::map<std::string, int> channels;
  int compression = -1;
  std::vector<std::string> attributes;
};

ExrHeader exr_header(const Bytes& file) {
  ExrHeader header;
  size_t at = 8;
  const auto text = [&] {
    const std::string s = reinterpret_cast<const char*>(&file.at(at));
    at += s.size() + 1;
    return s;
  };
  const auto int32 = [&](size_t from) {
    int32_t v;
    std::memcpy(&v, &file.at(from), 4);
    return v;
  };
  while (file.at(at) != 0) {
    const std::string name = text();
    text();  // type
    const size_t size = static_cast<size_t>(int32(at));
    at += 4;
    const size_t end = at + size;
    if (name == "compression") header.compression = file.at(at);
    if (name == "channels") {
      while (file.at(at) != 0) {
        const std::string channel = text();
        header.channels[channel] = int32(at);
        at += 16;
      }
    }
    header.attributes.push_back(name);
    at = end;
  }
  return header;
}

TEST(WriteImage, ExrHoldsAllLayersAndNothingOfTheMachine) {
  const TemporaryFolder folder;
  const std::vector<float> color(4, 1.0f), one(1, 1.0f), xyz(3, 1.0f);
  images::write_file(folder.file("a.exr"), 1, 1,
                     {{"Combined", "RGBA", color.data()},
                      {"Depth", "Z", one.data()},
                      {"Position", "XYZ", xyz.data()},
                      {"ObjectId", "X", one.data()},
                      {"Shadow", "RGB", xyz.data()}});
  const Bytes file = test::load(folder.file("a.exr"));
  const ExrHeader header = exr_header(file);
  const std::map<std::string, int> expected = {
      {"R", 1},          {"G", 1},          {"B", 1},          {"A", 1},
      {"Depth.Z", 2},    {"Position.X", 2}, {"Position.Y", 2}, {"Position.Z", 2},
      {"ObjectId.X", 2}, {"Shadow.R", 1},   {"Shadow.G", 1},   {"Shadow.B", 1}};
  EXPECT_EQ(header.channels, expected);
  EXPECT_EQ(header.compression, 3);
  for (const std::string& name : header.attributes) {
    EXPECT_TRUE(name != "Software" && name != "HostComputer" && name != "Artist") << name;
  }
  const std::string text(file.begin(), file.end());
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  EXPECT_EQ(text.find(host), std::string::npos);
  EXPECT_EQ(text.find(":20"), std::string::npos);
}

TEST(WriteImage, CryptomatteKeepsAllBitsAndItsAttributes) {
  const TemporaryFolder folder;
  const std::vector<float> slots = {-1.2345678e-20f, 0.7f, 9.8765432e30f, 0.3f};
  images::write_file(folder.file("a.exr"), 1, 1, {{"CryptoObject00", "rgba", slots.data()}},
                     {{"cryptomatte/0123456/manifest", R"({"Wärme":"a0b1c2d3"})"}});
  const Bytes file = test::load(folder.file("a.exr"));
  const ExrHeader header = exr_header(file);
  for (const char* letter : {"r", "g", "b", "a"}) {
    EXPECT_EQ(header.channels.at(std::string("CryptoObject00.") + letter), 2) << letter;
  }
  const std::string text(file.begin(), file.end());
  EXPECT_NE(text.find("cryptomatte/0123456/manifest"), std::string::npos);
  EXPECT_NE(text.find(R"({"Wärme":"a0b1c2d3"})"), std::string::npos);
}

TEST(WriteImage, ExrKeepsValuesAndOrientation) {
  const TemporaryFolder folder;
  // Bottom row first; alpha associated. Values above 1 and below 0 are radiances like others.
  const std::vector<float> pixels = {4.0f, -0.5f,  0.0f, 1.0f, 0.25f, 0.5f, 0.0f, 0.5f,
                                     1.0f, 0.125f, 8.0f, 1.0f, 0.0f,  0.0f, 0.0f, 0.0f};
  images::write_file(folder.file("a.exr"), 2, 2, {{"Combined", "RGBA", pixels.data()}});
  const Texture t = read(folder.file("a.exr"), true);
  const std::vector<float> straight = {4.0f, -0.5f,  0.0f, 1.0f, 0.5f, 1.0f, 0.0f, 0.5f,
                                       1.0f, 0.125f, 8.0f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  EXPECT_EQ(t.texels_float, straight);
}

TEST(WriteImage, ExrDepthKeepsAllDigitsAndColoursStayFinite) {
  const TemporaryFolder folder;
  const float depth = 1234.56789f, bright = 1e9f;
  images::write_file(folder.file("d.exr"), 1, 1, {{"Depth", "Z", &depth}});
  EXPECT_EQ(read(folder.file("d.exr")).texels_float[0], depth);
  images::write_file(folder.file("c.exr"), 1, 1, {{"Shade", "X", &bright}});
  EXPECT_EQ(read(folder.file("c.exr")).texels_float[0], 65504.0f);
}

TEST(WriteImage, SamePictureSameBytes) {
  const TemporaryFolder folder;
  const std::vector<float> pixels(64 * 64 * 4, 0.3f);
  for (const char* ending : {".exr", ".png"}) {
    for (const char* name : {"a", "b"}) {
      images::write_file(folder.file(name + std::string(ending)), 64, 64,
                         {{"Combined", "RGBA", pixels.data()}});
    }
    EXPECT_EQ(test::load(folder.file("a" + std::string(ending))),
              test::load(folder.file("b" + std::string(ending))));
  }
}

TEST(WriteImage, PngIsSrgbWithStraightAlpha) {
  const TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // Encoded 8-bit values by hand from the sRGB curve: 0.5 -> 188, 0.0031308 -> 10, 0.2 -> 124.
  const std::vector<float> pixels = {0.0f,  1.0f, 0.5f, 1.0f, 0.2f, 0.0031308f, 7.0f, 1.0f,
                                     0.25f, 0.0f, 0.1f, 0.5f, nan,  -3.0f,      0.0f, 0.0f};
  images::write_file(folder.file("a.png"), 2, 2, {{"Combined", "RGBA", pixels.data()}});
  EXPECT_EQ(read(folder.file("a.png")).texels8, (Bytes{0, 255, 188, 255, 124, 10, 255, 255,  //
                                                       188, 0, 124, 128, 0, 0, 0, 0}));
}

TEST(WriteImage, PngTakesTheFirstLayer) {
  const TemporaryFolder folder;
  const std::vector<float> white(3, 1.0f), black(3, 0.0f);
  images::write_file(folder.file("a.png"), 1, 1,
                     {{"Shadow", "RGB", white.data()}, {"Lighting", "RGB", black.data()}});
  EXPECT_EQ(read(folder.file("a.png")).texels8, (Bytes{255, 255, 255}));
}

TEST(WriteImage, UnknownEndingNamesTheRemedy) {
  const TemporaryFolder folder;
  const float value = 1.0f;
  try {
    images::write_file(folder.file("a.xyz"), 1, 1, {{"Depth", "Z", &value}});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    EXPECT_NE(std::string(error.what()).find(".exr"), std::string::npos) << error.what();
  }
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(WriteImage, MissingFolderIsAnErrorThatNamesIt) {
  const float value = 1.0f;
  EXPECT_THROW(images::write_file("/nowhere/a.exr", 1, 1, {{"Depth", "Z", &value}}), Error);
}

TEST(WriteImage, AFullDiskLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const std::string path = test::save(folder.file("a.exr"), {'o', 'l', 'd'});
  std::vector<float> noise(128 * 128 * 4);
  std::mt19937 random(3);
  for (float& v : noise) v = std::uniform_real_distribution<float>(0, 1)(random);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  rlimit full = before;
  full.rlim_cur = 4096;  // bytes a file may have
  setrlimit(RLIMIT_FSIZE, &full);
  EXPECT_THROW(images::write_file(path, 128, 128, {{"Combined", "RGBA", noise.data()}}), Error);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(test::load(path), (Bytes{'o', 'l', 'd'}));
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(WriteImage, ALinkStaysALink) {
  const TemporaryFolder folder;
  test::save(folder.file("real.exr"), {'o', 'l', 'd'});
  std::filesystem::create_symlink("real.exr", folder.file("link.exr"));
  const float value = 2.0f;
  images::write_file(folder.file("link.exr"), 1, 1, {{"Depth", "Z", &value}});
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.exr")));
  EXPECT_EQ(read(folder.file("real.exr")).texels_float[0], value);
}

// ---- The plug-in itself -------------------------------------------------------------------------

TEST(ImagePlugin, SaysItsVersion) {
  ASSERT_TRUE(images::plugin_available()) << images::plugin_version();
  EXPECT_EQ(images::plugin_version().rfind("OpenImageIO ", 0), 0u) << images::plugin_version();
}

/// Exits with 0 where reading fails as it should without a plug-in, its reason on stderr.
[[noreturn]] void read_with_plugin(const char* plugin) {
  setenv("KESTREL_IMAGE_PLUGIN", plugin, 1);
  try {
    read("a.png");
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::exit(error.code() == ErrorCode::unsupported && !images::plugin_available() ? 0 : 1);
  }
  std::exit(2);
}

// Each in a process of its own, since the plug-in is loaded once.
TEST(ImagePluginDeathTest, WithoutItErrorsSayWhatToDo) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(read_with_plugin("/nowhere/plugin.so"), testing::ExitedWithCode(0),
              "/nowhere/plugin.so.*KESTREL_IMAGE_PLUGIN");
}

TEST(ImagePluginDeathTest, AnotherLibraryIsRefused) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(read_with_plugin("libm.so.6"), testing::ExitedWithCode(0), "no image plug-in");
}

}  // namespace
}  // namespace kestrel
