// Shaders: they read nothing that they have not written, and compile as GLSL 4.00 and as GLSL ES
// 3.00. The shipped programs draw scenes that use every kind of shader; a preloaded library hands
// over the texts, or sets what is undefined.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/process.h"
#include "tests/support/undefined_locals.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

struct Drawn {
  const char* name;
  const char* scene;  ///< below the assets, or builtin:
  const char* server;
  const char* viewer;
};

constexpr Drawn kDrawn[] = {
    {"RelitInShadow", "builtin:forest?trees=20&clutter=10", "--shadows on",
     "--light builtin:sun-sweep --relight always"},
    {"ReliefInShadow", "builtin:forest?trees=20&clutter=10&fog=0.02", "--shadows on",
     "--method depth"},
    {"QuadsInFog", "builtin:city?blocks=2&fog=0.02", "", "--method quad"},
    {"RelitQuads", "builtin:clutter?objects=30", "--shadows on",
     "--light builtin:sun-sweep --relight always --method quad --msaa 4"},
    {"Warped", "builtin:clutter?objects=30", "", "--method warp"},
    {"Hulls", "builtin:clutter?objects=30", "", "--method hull"},
    {"Clearcoat", "/assets/features/clearcoat_test.glb", "", ""},
    {"Blended", "/assets/features/alpha_blend_mode_test.glb", "", ""},
    {"Transmission", "/assets/objects/glass_table_blend.glb", "", ""},
    {"Skinned", "/assets/features/fox_skinned.glb", "", "--relight always"},
    {"InTheBrowsersDialect", "builtin:forest?trees=20&clutter=10", "--shadows on", "--gles"},
};

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

// Walks through the scene with `environment` set for both programs. Returns the frames' bytes.
std::string walk(const Drawn& drawn, const std::string& environment) {
  const std::string scene = drawn.scene[0] == '/' ? shared_folder() + drawn.scene : drawn.scene;
  const std::string preload = std::string("LD_PRELOAD=") + MIRAGE_SHADERS;
  const Server server(scene, words_of(drawn.server), {preload, environment});
  EXPECT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  std::vector<std::string> command = {"/usr/bin/env", preload, environment, binary("mirage-view"),
                                      server.url()};
  for (const std::string& word :
       words_of(std::string("--virtual-time --offscreen 128x72 --frames 12 --fps 5 --path "
                            "builtin:walk --net rtt=40,rate=60,server-ms=1,seed=1 --out ") +
                folder + " " + drawn.viewer)) {
    command.push_back(word);
  }
  const Finished done = run(command, 300);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  std::string bytes;
  for (const char* frame : {"05", "08", "11"}) {
    bytes += read_file(folder + "/frame_000" + frame + ".png");
  }
  EXPECT_GT(bytes.size(), 3000u);
  return bytes;
}

// Returns the shader without the lines that a dialect puts before it.
std::string without_heading(const std::string& text) {
  std::istringstream lines(text);
  std::string body;
  for (std::string line; std::getline(lines, line);) {
    const auto begins = [&](const char* with) { return line.rfind(with, 0) == 0; };
    const bool heading = begins("#version") || begins("#extension") || line == "#define precise" ||
                         begins("#define PRECISE_BUILT_IN") ||
                         (begins("precision highp ") && body.empty());
    if (!heading) body += line + "\n";
  }
  return body;
}

const std::string kGlsl400 = "#version 400 core\n#define PRECISE_BUILT_IN(name) precise name;\n";
const std::string kEssl300 =
    "#version 300 es\n#define precise\n#define PRECISE_BUILT_IN(name)\nprecision highp float;\n"
    "precision highp int;\nprecision highp sampler2D;\nprecision highp sampler2DArray;\n"
    "precision highp sampler2DShadow;\n";

void expect_compiles(const std::string& folder) {
  std::vector<std::string> command = {"/usr/bin/env", "glslangValidator"};
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string body = without_heading(read_file(entry.path().string()));
    const std::string file = entry.path().filename().string();
    for (const std::string& heading : {kGlsl400, kEssl300}) {
      const std::string name = scratch_folder() + "/" + file;
      std::ofstream(name) << heading << body;
      command.push_back(name);
    }
  }
  EXPECT_GT(command.size(), 30u);
  const Finished done = run(command, 120);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  std::printf("%zu shaders compiled\n", command.size() - 2);
}

class Shaders : public ::testing::TestWithParam<Drawn> {};

TEST_P(Shaders, CompileInBothDialectsAndReadNothingThatTheyHaveNotWritten) {
  const std::string folder = scratch_folder();
  const std::string as_shipped = walk(GetParam(), "SHADER_DIR=" + folder);
  EXPECT_TRUE(as_shipped == walk(GetParam(), "SHADER_LOCALS=nan")) << "undefined values are NaN";
  EXPECT_TRUE(as_shipped == walk(GetParam(), "SHADER_LOCALS=zero")) << "undefined values are 0";
  expect_compiles(folder);
}

INSTANTIATE_TEST_SUITE_P(Of, Shaders, ::testing::ValuesIn(kDrawn),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(UndefinedLocals, AreSetWhereverTheyBegin) {
  const std::string shader =
      "#version 400 core\n#define A\nprecise out vec4 o_color;  // a comment\n"
      "struct S {\n  vec3 a;\n#ifdef B\n  float b;\n#endif\n};\n"
      "uniform vec3 u;\nvoid f(S s, out float w) { w = 1.0; }\n"
      "void main() {\n  S s;\n  float x, y = u.x;\n#if defined(A) && !defined(B)\n  int n;\n"
      "#else\n  int m;\n#endif\n  for (int i = 0; i < 3; ++i) x += y;\n  o_color = vec4(s.a, "
      "x);\n}\n";
  const std::string zero = with_defined_locals(shader, Undefined::kZero);
  for (const char* part :
       {"S undefined_S() { S s; s.a = vec3(0.0); return s; }", "{ w = float(0.0);",
        "{ o_color = vec4(0.0);", "S s = undefined_S()", "float x = float(0.0), y = u.x;",
        "int n = int(0)", "for (int i = 0; i < 3; ++i) x += y;", "#version 400 core\n"}) {
    EXPECT_NE(zero.find(part), std::string::npos) << part << " in " << zero;
  }
  EXPECT_EQ(zero.find("int m"), std::string::npos);
  EXPECT_EQ(zero.find("s.b"), std::string::npos);
  EXPECT_NE(with_defined_locals(shader, Undefined::kNan).find("uintBitsToFloat(0x7fc00000u)"),
            std::string::npos);
}

}  // namespace
}  // namespace mirage::test
