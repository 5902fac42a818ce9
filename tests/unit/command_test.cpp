// SPDX-License-Identifier: GPL-3.0-or-later
// The kestrel command as a user runs it: what it prints, writes and returns.
#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::steady_clock;

const std::string kCommand = std::string(KESTREL_BINARY_DIR) + "/kestrel";

/// Two glowing cards, red at x = 0 and blue at x = 10; the camera looks along +Y at the red one,
/// and its path ends before the blue one. The sky is green.
constexpr const char* kCards = R"({"kestrel_scene": 1,
  "camera": {"fov": 20, "position": [0, -5, 0], "look_at": [0, 0, 0], "path": [
    {"time": 0, "position": [0, -5, 0], "look_at": [0, 0, 0]},
    {"time": 20, "position": [10, -5, 0], "look_at": [10, 0, 0]}]},
  "settings": {"samples": 1, "primary": "rays"},
  "world": {"color": [0, 0.25, 0]},
  "materials": [{"name": "red", "diffuse": [0, 0, 0], "emission": [0.5, 0, 0]},
                {"name": "blue", "diffuse": [0, 0, 0], "emission": [0, 0, 0.75]}],
  "meshes": [{"name": "card", "primitive": "plane"}],
  "objects": [
    {"name": "Red", "mesh": "card", "material": "red", "rotation": [90, 0, 0]},
    {"name": "Blue", "mesh": "card", "material": "blue", "position": [10, 0, 0],
     "rotation": [90, 0, 0]}]})";

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

struct Picture {
  std::vector<std::string> channels;
  int width, height;
  std::vector<float> middle;  // channels of the pixel in the middle
};

Picture read_picture(const fs::path& path) {
  OIIO::ImageBuf image(path.string());
  EXPECT_TRUE(image.read(0, 0, true, OIIO::TypeFloat)) << image.geterror();
  const OIIO::ImageSpec& spec = image.spec();
  Picture picture{
      {spec.channelnames.begin(), spec.channelnames.end()}, spec.width, spec.height, {}};
  picture.middle.resize(spec.nchannels);
  image.getpixel(spec.width / 2, spec.height / 2, picture.middle.data(), spec.nchannels);
  return picture;
}

class Command : public testing::Test {
 protected:
  Command() {
    std::string name = (fs::temp_directory_path() / "kestrel-command-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    std::ofstream(folder_ / "cards.kscene") << kCards;
  }
  ~Command() override { fs::remove_all(folder_); }

  /// Runs the command in the folder with these words; fills out_ and err_.
  int run(const std::string& words) {
    const std::string line = "cd '" + folder_.string() + "' && '" + kCommand + "' " + words +
                             " >out.txt 2>err.txt </dev/null";
    const int status = std::system(line.c_str());
    out_ = text_of(folder_ / "out.txt");
    err_ = text_of(folder_ / "err.txt");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  /// Whether anything but the scene and what run() writes is in the folder.
  std::set<std::string> written() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name != "cards.kscene" && name != "out.txt" && name != "err.txt") names.insert(name);
    }
    return names;
  }

  json stats() const { return json::parse(text_of(folder_ / "stats.json")); }

  fs::path folder_;
  std::string out_, err_;
};

// ---- info --------------------------------------------------------------------------------------

TEST_F(Command, InfoTellsAboutTheMachineAsJson) {
  ASSERT_EQ(run("info"), 0) << err_;
  const json info = json::parse(out_);
  EXPECT_EQ(info.at("kestrel"), KESTREL_VERSION);
  EXPECT_FALSE(info.at("embree").get<std::string>().empty());
  EXPECT_GE(info.at("threads").get<int>(), 1);
  ASSERT_TRUE(info.contains("gl"));
  if (info.at("gl").is_null()) {
    EXPECT_FALSE(info.at("gl_error").get<std::string>().empty());
  } else {
    EXPECT_FALSE(info.at("gl").at("renderer").get<std::string>().empty());
  }
}

TEST_F(Command, InfoListsTheSettings) {
  ASSERT_EQ(run("info --settings"), 0) << err_;
  bool found = false;
  for (const json& row : json::parse(out_)) {
    EXPECT_TRUE(row.contains("name") && row.contains("default") && row.contains("help"));
    found = found || (row.at("name") == "budget_ms" && row.at("unit") == "ms");
  }
  EXPECT_TRUE(found);
}

TEST_F(Command, VersionAndHelp) {
  EXPECT_EQ(run("--version"), 0);
  EXPECT_NE(out_.find(KESTREL_VERSION), std::string::npos);
  EXPECT_EQ(run("render --help"), 0);
  for (const char* option : {"--size", "--set", "--passes", "--stats", "--frames"}) {
    EXPECT_NE(out_.find(option), std::string::npos) << option;
  }
}

// ---- mistakes ----------------------------------------------------------------------------------

struct Mistake {
  const char* words;
  int status;
  const char* message;
};

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.words;
}

class CommandMistakes : public Command, public testing::WithParamInterface<Mistake> {};

TEST_P(CommandMistakes, AreToldAndWriteNothing) {
  EXPECT_EQ(run(GetParam().words), GetParam().status);
  EXPECT_NE((out_ + err_).find(GetParam().message), std::string::npos) << out_ << err_;
  EXPECT_EQ(written(), std::set<std::string>());
}

const Mistake kMistakes[] = {
    {"", 2, "subcommand"},
    {"paint", 2, "subcommand"},
    {"render", 2, "required"},
    {"render cards.kscene", 2, "--output is required"},
    {"render cards.kscene -o out.exr --colour red", 2, "--colour"},
    {"render cards.kscene -o out.jpg", 2, ".exr or .png"},
    {"render cards.kscene -o nowhere/out.exr", 2, "nowhere"},
    {"render cards.kscene -o out.exr --size 64", 2, "WIDTHxHEIGHT"},
    {"render cards.kscene -o out.exr --size 0x64", 2, "WIDTHxHEIGHT"},
    {"render cards.kscene -o out.exr --size 64x64x64", 2, "WIDTHxHEIGHT"},
    {"render cards.kscene -o out.exr --size 99999999999x1", 2, "WIDTHxHEIGHT"},
    {"render cards.kscene -o out.exr --set samples", 2, "NAME=VALUE"},
    {"render cards.kscene -o out.exr --set smaples=4", 2, "samples"},
    {"render cards.kscene -o out.exr --set samples=0", 2, "from 1 to"},
    {"render cards.kscene -o out.exr --frames 0", 2, "--frames"},
    {"render cards.kscene -o out.exr --frames many", 2, "--frames"},
    {"render cards.kscene -o out.exr --stats nowhere/s.json", 2, "nowhere"},
    {"render gone.kscene -o out.exr", 1, "gone.kscene: no such file"},
    {"render /etc/passwd -o out.exr", 1, "not valid JSON"},
    {"render cards.kscene -o out.exr --size 8x8 --passes Combined,Glitter", 1, "Glitter"},
};
INSTANTIATE_TEST_SUITE_P(Usage, CommandMistakes, testing::ValuesIn(kMistakes));

TEST_F(Command, BrokenSceneIsToldWithItsPlace) {
  std::ofstream(folder_ / "cards.kscene") << R"({"kestrel_scene": 1, "camera": {"fov": 50},
    "meshes": [{"name": "cube", "primitive": "cube"}], "objects": [{"mesh": "cubes"}]})";
  EXPECT_EQ(run("render cards.kscene -o out.exr"), 1);
  EXPECT_EQ(err_,
            "kestrel: cards.kscene: /objects/0/mesh: there is no mesh 'cubes'; did you mean "
            "'cube'?\n");
  EXPECT_EQ(written(), std::set<std::string>());
}

// ---- pictures ----------------------------------------------------------------------------------

TEST_F(Command, WritesLinearExrAndSrgbPng) {
  ASSERT_EQ(run("render cards.kscene -o out.exr --size 40x30"), 0) << err_;
  const Picture exr = read_picture(folder_ / "out.exr");
  EXPECT_EQ(exr.width, 40);
  EXPECT_EQ(exr.height, 30);
  EXPECT_EQ(exr.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_NEAR(exr.middle[0], 0.5f, 1e-3f);
  EXPECT_NEAR(exr.middle[1], 0.0f, 1e-3f);
  ASSERT_EQ(run("render cards.kscene -o out.png --size 40x30"), 0) << err_;
  // 0.5 encoded as sRGB is 188 of 255.
  EXPECT_NEAR(read_picture(folder_ / "out.png").middle[0], 188.0f / 255.0f, 1.1f / 255.0f);
  EXPECT_EQ(err_.find('\r'), std::string::npos) << "the progress line is for terminals";
}

TEST_F(Command, WritesEveryPassAsALayer) {
  ASSERT_EQ(run("render cards.kscene -o out.exr --size 16x9 --passes all"), 0) << err_;
  const Picture all = read_picture(folder_ / "out.exr");
  const std::set<std::string> channels(all.channels.begin(), all.channels.end());
  for (const char* name : {"R", "A", "Depth.Z", "Normal.X", "Position.Z", "Diffuse.A", "Shadow.R",
                           "Reflection.G", "Refraction.B", "Lighting.R", "HeuristicMask.X"}) {
    EXPECT_EQ(channels.count(name), 1u) << name;
  }
  ASSERT_EQ(run("render cards.kscene -o two.exr --size 16x9 --passes Combined,Depth"), 0) << err_;
  const Picture two = read_picture(folder_ / "two.exr");
  EXPECT_EQ(two.channels.size(), 5u);
}

TEST_F(Command, StatsHaveTheAgreedKeys) {
  ASSERT_EQ(run("render cards.kscene -o out.exr --size 16x9 --stats stats.json"), 0) << err_;
  EXPECT_GE(stats().at("load_ms").get<double>(), 0.0);
  ASSERT_EQ(stats().at("frames").size(), 1u);
  const json frame = stats().at("frames")[0];
  EXPECT_GT(frame.at("frame_ms").get<double>(), 0.0);
  for (const char* stage : {"raster", "heuristic", "trace", "blend"}) {
    EXPECT_TRUE(frame.at("stages_ms").at(stage).is_number()) << stage;
  }
  EXPECT_EQ(frame.at("primary"), "rays");
  EXPECT_GE(frame.at("rays").at("primary").get<int>(), 16 * 9);
  for (const char* kind : {"shadow", "reflection", "refraction"}) {
    EXPECT_EQ(frame.at("rays").at(kind), 0) << kind << ": nothing here asks for any";
  }
  EXPECT_TRUE(frame.at("trace_calls_ms").is_number());
  EXPECT_TRUE(frame.at("budget_ms").is_number());
  ASSERT_EQ(frame.at("objects").size(), 2u);
  const json& red = frame.at("objects")[0];
  EXPECT_EQ(red.at("name"), "Red");
  EXPECT_GT(red.at("area_px").get<int>(), 0);
  for (const char* key :
       {"P", "D", "V", "Q", "cost", "relevance", "selected", "effects", "tracer", "ms"}) {
    EXPECT_TRUE(red.contains(key)) << key;
  }
}

TEST_F(Command, SetOverridesTheScenesSettings) {
  ASSERT_EQ(run("render cards.kscene -o out.exr --size 16x9 --stats stats.json --set samples=3 "
                "--set budget_ms=7.5"),
            0)
      << err_;
  const json frame = stats().at("frames")[0];
  EXPECT_EQ(frame.at("budget_ms"), 7.5);
  EXPECT_GE(frame.at("rays").at("primary").get<int>(), 3 * 16 * 9);
}

TEST_F(Command, FramesFollowTheCamerasPath) {
  ASSERT_EQ(run("render cards.kscene -o f####.exr --size 16x9 --frames 3 --stats stats.json"), 0)
      << err_;
  EXPECT_EQ(written(),
            (std::set<std::string>{"f0001.exr", "f0002.exr", "f0003.exr", "stats.json"}));
  EXPECT_EQ(stats().at("frames").size(), 3u);
  const auto middle = [&](const char* name) { return read_picture(folder_ / name).middle; };
  EXPECT_NEAR(middle("f0001.exr")[0], 0.5f, 1e-3f) << "starts before the red card";
  EXPECT_NEAR(middle("f0002.exr")[1], 0.25f, 1e-3f) << "half way there is only sky";
  EXPECT_NEAR(middle("f0003.exr")[2], 0.75f, 1e-3f) << "ends before the blue card";
}

TEST_F(Command, OneFrameStandsWhereTheCameraStands) {
  ASSERT_EQ(run("render cards.kscene -o last.exr --size 16x9 --frames 2"), 0) << err_;
  EXPECT_EQ(written(), (std::set<std::string>{"last.exr"})) << "without ####, the last frame";
  EXPECT_NEAR(read_picture(folder_ / "last.exr").middle[2], 0.75f, 1e-3f);
  ASSERT_EQ(run("render cards.kscene -o out.exr --size 16x9"), 0) << err_;
  EXPECT_NEAR(read_picture(folder_ / "out.exr").middle[0], 0.5f, 1e-3f);
}

// ---- interruption ------------------------------------------------------------------------------

TEST_F(Command, CtrlCEndsALongRenderWithoutAPicture) {
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0) _exit(99);
    execl(kCommand.c_str(), "kestrel", "render", "cards.kscene", "-o", "out.exr", "--size",
          "640x360", "--set", "samples=65536", static_cast<char*>(nullptr));
    _exit(99);
  }
  ASSERT_GT(child, 0);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  ASSERT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "65536 samples take minutes";
  kill(child, SIGINT);
  const auto begin = steady_clock::now();
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (steady_clock::now() - begin > std::chrono::seconds(30)) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      FAIL() << "still running 30 s after Ctrl-C";
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_EQ(written(), std::set<std::string>());
}

}  // namespace
