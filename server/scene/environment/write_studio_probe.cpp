// Writes the source of studio_probe(): a program of the build.
//   mirage_write_studio_probe FILE
#include <cstdio>

#include "server/scene/environment/builtin_environment.h"
#include "server/scene/environment/probe_filter.h"

int main(int argc, char** argv) {
  std::FILE* const out = argc == 2 ? std::fopen(argv[1], "w") : nullptr;
  if (!out) {
    std::fprintf(stderr, "cannot write: usage is mirage_write_studio_probe FILE\n");
    return 1;
  }
  const mirage::LightProbe probe =
      mirage::make_probe(*mirage::builtin_environment("studio"), mirage::Workers());
  std::fprintf(out,
               "// Made by write_studio_probe.cpp.\n"
               "#include \"server/scene/environment/studio_probe.h\"\n\n"
               "namespace mirage {\nnamespace {\n\nconst std::uint32_t kTexels[] = {\n");
  for (std::size_t i = 0; i < probe.texels.size(); ++i) {
    std::fprintf(out, "%#x,%c", probe.texels[i], i % 16 == 15 ? '\n' : ' ');
  }
  std::fprintf(out,
               "};\n\n}  // namespace\n\nLightProbe studio_probe() {\n  LightProbe out;\n"
               "  out.id = %lluull;\n",
               static_cast<unsigned long long>(probe.id));
  for (std::size_t i = 0; i < probe.irradiance.size(); ++i) {
    const glm::vec3& term = probe.irradiance[i];  // %a is exact
    std::fprintf(out, "  out.irradiance[%zu] = {%af, %af, %af};\n", i, double{term.r},
                 double{term.g}, double{term.b});
  }
  std::fprintf(out,
               "  out.texels.assign(std::begin(kTexels), std::end(kTexels));\n  return out;\n}\n\n"
               "}  // namespace mirage\n");
  return std::fclose(out) == 0 ? 0 : 1;
}
