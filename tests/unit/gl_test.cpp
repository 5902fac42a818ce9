// SPDX-License-Identifier: GPL-3.0-or-later
// Kestrel's own OpenGL context, the owners of GL objects, and the shader library.
#include "gl/context.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "gl/debug.h"
#include "gl/embedded_shaders.h"
#include "gl/objects.h"
#include "gl/octahedral.h"
#include "gl/shader_library.h"

namespace kestrel::gl {
namespace {

/// An environment variable for the length of a test.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Environment() { unsetenv(name_); }

 private:
  const char* name_;
};

class Gl : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = std::make_unique<Context>();
    } catch (const Error& error) {
      GTEST_SKIP() << "No OpenGL here: " << error.what();
    }
  }
  std::unique_ptr<Context> context_;
};

ErrorCode code_of_new_context(std::string* text = nullptr) {
  try {
    Context context;
  } catch (const Error& error) {
    if (text) *text = error.what();
    return error.code();
  }
  return ErrorCode::none;
}

// ---- the context -----------------------------------------------------------------------------

TEST(GlWithout, SwitchedOffIsUnsupportedAndSaysHowToGoOn) {
  const Environment off("KESTREL_NO_GL", "1");
  std::string text;
  EXPECT_EQ(code_of_new_context(&text), ErrorCode::unsupported);
  EXPECT_NE(text.find("primary=rays"), std::string::npos) << text;
  EXPECT_FALSE(hardware_available());
}

TEST_F(Gl, DeviceThatDoesNotExistIsAnErrorThatNamesIt) {
  for (const char* device : {"999", "-1", "first", "0x"}) {
    const Environment chosen("KESTREL_EGL_DEVICE", device);
    std::string text;
    EXPECT_EQ(code_of_new_context(&text), ErrorCode::invalid_argument) << device;
    EXPECT_NE(text.find(device), std::string::npos) << text;
    EXPECT_FALSE(hardware_available());
  }
}

TEST_F(Gl, SaysWhatItRunsOn) {
  const DeviceInfo& info = context_->info();
  EXPECT_FALSE(info.renderer.empty());
  EXPECT_FALSE(info.vendor.empty());
  EXPECT_GE(std::atof(info.version.c_str()), 4.5) << info.version;
  EXPECT_EQ(info.software, info.renderer.find("llvmpipe") != std::string::npos ||
                               info.renderer.find("softpipe") != std::string::npos)
      << info.renderer;
  if (!info.software) {
    EXPECT_TRUE(hardware_available());
  }
}

TEST_F(Gl, WorkRunsOnOneThreadOfItsOwn) {
  std::thread::id first, second;
  context_->run([&] { first = std::this_thread::get_id(); });
  std::thread([&] { context_->run([&] { second = std::this_thread::get_id(); }); }).join();
  EXPECT_NE(first, std::this_thread::get_id());
  EXPECT_EQ(first, second);
}

TEST_F(Gl, ExceptionsReachTheCallerAndTheThreadLivesOn) {
  EXPECT_THROW(context_->run([] { throw std::runtime_error("no"); }), std::runtime_error);
  int done = 0;
  context_->run([&] { done = 1; });
  EXPECT_EQ(done, 1);
}

TEST_F(Gl, WorkMayAskForMoreWork) {
  int done = 0;
  context_->run([&] { context_->run([&] { done = 1; }); });
  EXPECT_EQ(done, 1);
}

TEST_F(Gl, ManyThreadsMayShareAContext) {
  int sum = 0;  // only ever touched on the GL thread
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 200; ++i) context_->run([&] { ++sum; });
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(sum, 1600);
}

TEST_F(Gl, ContextsAreIndependent) {
  Context other;
  GLuint here = 0;
  context_->run([&] { glCreateBuffers(1, &here); });
  GLboolean known_there = GL_TRUE;
  other.run([&] { known_there = glIsBuffer(here); });
  EXPECT_EQ(known_there, GL_FALSE);
}

TEST_F(Gl, ContextsMayComeAndGo) {
  for (int i = 0; i < 5; ++i) {
    Context context;
    context.run([] { glFinish(); });
  }
}

// ---- objects ---------------------------------------------------------------------------------

TEST_F(Gl, ErrorsBecomeExceptionsWithAText) {
  context_->run([] {
    check_errors("doing nothing");
    glBindFramebuffer(GL_TEXTURE_2D, 0);
    try {
      check_errors("testing");
      FAIL() << "a wrong enumerant went unnoticed";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unknown);
      const std::string text = error.what();
      EXPECT_NE(text.find("testing"), std::string::npos) << text;
      EXPECT_NE(text.find("GL_INVALID_ENUM"), std::string::npos) << text;
    }
    check_errors("doing nothing afterwards");
  });
}

TEST_F(Gl, OwnersDeleteOnceAndMove) {
  context_->run([] {
    GLuint name = 0;
    {
      Buffer first("first", 64, nullptr);
      name = first.name();
      EXPECT_EQ(glIsBuffer(name), GL_TRUE);
      Buffer second = std::move(first);
      EXPECT_FALSE(first);
      EXPECT_EQ(second.name(), name);
      first = Buffer("third", 64, nullptr);
      const GLuint third = first.name();
      first = std::move(second);
      EXPECT_EQ(first.name(), name);
      EXPECT_EQ(glIsBuffer(third), GL_FALSE);
      EXPECT_EQ(glIsBuffer(name), GL_TRUE);
    }
    EXPECT_EQ(glIsBuffer(name), GL_FALSE);
    check_errors("moving buffers");
  });
}

std::vector<int> contents(GLuint buffer, size_t count) {
  std::vector<int> out(count);
  glGetNamedBufferSubData(buffer, 0, static_cast<GLsizeiptr>(count * sizeof(int)), out.data());
  return out;
}

TEST_F(Gl, MirroredBufferSendsOnlyChanges) {
  context_->run([] {
    MirroredBuffer buffer("mirrored");
    buffer.assign(std::vector<int>());
    EXPECT_NE(buffer.name(), 0u) << "an empty one can be bound";
    buffer.assign(std::vector<int>{1, 2, 3, 4});
    EXPECT_EQ(contents(buffer.name(), 4), (std::vector<int>{1, 2, 3, 4}));
    // Written behind its back: stays where the same is assigned again, goes where it changes.
    const int nine = 9;
    glNamedBufferSubData(buffer.name(), 0, sizeof(nine), &nine);
    buffer.assign(std::vector<int>{1, 2, 3, 4});
    EXPECT_EQ(contents(buffer.name(), 1)[0], 9);
    buffer.assign(std::vector<int>{5, 6});
    EXPECT_EQ(contents(buffer.name(), 2), (std::vector<int>{5, 6}));
    std::vector<int> many(1000, 7);
    buffer.assign(many);
    EXPECT_EQ(contents(buffer.name(), 1000), many);
    check_errors("filling buffers");
  });
}

TEST_F(Gl, TexturesReadBackWhatWasUploaded) {
  context_->run([] {
    Texture2D texture("texture", GL_RG32UI, 3, 2);  // rows of 24 bytes
    const std::vector<GLuint> texels = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 4000000000u};
    texture.upload(GL_RG_INTEGER, GL_UNSIGNED_INT, texels.data());
    std::vector<GLuint> out(12);
    texture.read(GL_RG_INTEGER, GL_UNSIGNED_INT, out.data(), out.size() * sizeof(GLuint));
    EXPECT_EQ(out, texels);
    check_errors("reading a texture");
  });
}

TEST_F(Gl, TargetsThatCannotBeDrawnToAreRefused) {
  context_->run([] {
    const Texture2D color("colour", GL_RGBA8, 4, 4);
    const Texture2D not_depth("not a depth", GL_RGBA8, 4, 4);
    EXPECT_THROW(Framebuffer("wrong", {&color}, &not_depth), Error);
    glGetError();
    EXPECT_NO_THROW(Framebuffer("right", {&color}, nullptr));
  });
}

// ---- shaders ---------------------------------------------------------------------------------

TEST(ShaderLibrary, IncludesEachFileOnce) {
  std::string files;
  const std::string source = expand_shader("raster/lighting.frag", files);
  EXPECT_EQ(source.rfind("#version 450 core\n", 0), 0u);
  EXPECT_EQ(source.find("#include"), std::string::npos);
  const size_t first = source.find("struct GpuLight {");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(source.find("struct GpuLight {", first + 1), std::string::npos);
  EXPECT_EQ(files.rfind("0 raster/lighting.frag, 1 ", 0), 0u) << files;
}

TEST(ShaderLibrary, MessagesCountLinesInTheFileTheyName) {
  std::string files;
  const std::string source = expand_shader("raster/gbuffer.vert", files);
  // The line after an include goes on with the number it has in its own file.
  const std::string_view text = embedded_shaders().at("raster/gbuffer.vert");
  const size_t include = text.find("#include");
  const auto line = 2 + std::count(text.begin(), text.begin() + static_cast<long>(include), '\n');
  EXPECT_NE(source.find("#line " + std::to_string(line) + " 0\n"), std::string::npos);
}

TEST(ShaderLibrary, UnknownShaderIsAnError) {
  std::string files;
  EXPECT_THROW(expand_shader("raster/none.frag", files), Error);
}

TEST_F(Gl, EveryStageOfEveryShaderCompiles) {
  context_->run([] {
    int fragments = 0;
    for (const auto& [path, text] : embedded_shaders()) {
      const bool vertex = path.ends_with(".vert");
      if (!vertex && !path.ends_with(".frag")) continue;
      fragments += !vertex;
      EXPECT_NO_THROW(build_program(
          path, {{vertex ? GLenum(GL_VERTEX_SHADER) : GLenum(GL_FRAGMENT_SHADER), path}}))
          << path;
    }
    EXPECT_GE(fragments, 3);
  });
}

TEST_F(Gl, StagesThatDoNotFitAreRefusedWithTheDriversReason) {
  context_->run([] {
    try {
      build_program("mismatch", {{GL_VERTEX_SHADER, "raster/lighting.vert"},
                                 {GL_FRAGMENT_SHADER, "raster/gbuffer.frag"}});
      FAIL() << "a fragment shader got inputs that no vertex shader writes";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unsupported);
      const std::string text = error.what();
      EXPECT_NE(text.find("'mismatch'"), std::string::npos) << text;
      EXPECT_NE(text.find("_ws"), std::string::npos) << text;
    }
  });
}

// ---- encodings -------------------------------------------------------------------------------

TEST(Octahedral, RoundTripsEveryDirection) {
  std::mt19937 random(1);
  std::normal_distribution<float> gauss;
  float largest = 0.0f;
  for (int k = 0; k < 100000; ++k) {
    vec3 n(gauss(random), gauss(random), gauss(random));
    if (k % 10 < 3) n[k % 3] = 0.0f;                          // on the folds
    if (k % 100 == 7) n = vec3(0, 0, k % 200 == 7 ? 1 : -1);  // the poles
    n = glm::normalize(n);
    const vec2 e = encode_octahedral(n);
    ASSERT_LE(std::abs(e.x), 1.0f);
    ASSERT_LE(std::abs(e.y), 1.0f);
    largest = glm::max(largest, glm::length(decode_octahedral(e) - n));
  }
  EXPECT_LT(largest, 3e-7f);
}

}  // namespace
}  // namespace kestrel::gl
