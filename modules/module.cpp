#include "modules/module.h"

#include <dlfcn.h>

#include <filesystem>

namespace mirage {
namespace {

namespace fs = std::filesystem;

std::string loader_message() {
  const char* const text = dlerror();
  return text ? text : "the loader gives no reason";
}

}  // namespace

Result<void*> load_module(const std::string& name, const char* entry) {
  std::error_code failed;
  const fs::path programs = fs::read_symlink("/proc/self/exe", failed).parent_path();
  const std::string file = "lib" + name + ".so";
  std::string looked;
  for (const fs::path& folder : {programs, programs / "../lib/mirage", programs / "../lib"}) {
    const std::string path = (folder / file).lexically_normal().string();
    looked += (looked.empty() ? "" : ", ") + path;
    if (!fs::exists(path, failed)) continue;
    void* const module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!module) {
      return make_error(ErrorId::kModule, "cannot load " + path + ": " + loader_message(),
                        "install the library that the line names");
    }
    if (void* const function = dlsym(module, entry)) return function;
    return make_error(ErrorId::kModule, path + " is of another build than the program",
                      "install programs and modules of one build");
  }
  return make_error(ErrorId::kModule, file + " is missing; looked for " + looked,
                    "install the modules together with the programs");
}

}  // namespace mirage
