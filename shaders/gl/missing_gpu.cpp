#include "shaders/gl/missing_gpu.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace mirage::gl {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> files_in(const std::string& folder, const std::string& start) {
  std::vector<std::string> out;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(start, 0) == 0) out.push_back(entry.path().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool is_card_node(const std::string& path) {
  return std::isdigit(static_cast<unsigned char>(path.back())) != 0;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, at);) out.push_back(part);
  return out;
}

/// Returns the files that libglvnd reads, by its own rules.
std::vector<std::string> vendor_files() {
  if (const char* files = std::getenv("__EGL_VENDOR_LIBRARY_FILENAMES")) return split(files, ':');
  const char* const folders = std::getenv("__EGL_VENDOR_LIBRARY_DIRS");
  std::vector<std::string> out;
  for (const std::string& folder :
       split(folders ? folders : "/etc/glvnd/egl_vendor.d:/usr/share/glvnd/egl_vendor.d", ':')) {
    for (const std::string& file : files_in(folder, "")) {
      if (fs::path(file).extension() == ".json") out.push_back(file);
    }
  }
  return out;
}

EglVendor read_vendor(const std::string& path) {
  EglVendor out;
  out.file = fs::path(path).filename().string();
  std::ifstream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::string key = "\"library_path\"";
  const std::size_t at = text.find(key);
  const std::size_t from = at == std::string::npos ? at : text.find('"', at + key.size());
  const std::size_t to = from == std::string::npos ? from : text.find('"', from + 1);
  if (to == std::string::npos) {
    out.load_error = "the file names no library";
    return out;
  }
  out.library = text.substr(from + 1, to - from - 1);
  if (!dlopen(out.library.c_str(), RTLD_LAZY | RTLD_LOCAL)) out.load_error = dlerror();
  return out;
}

Error missing(std::string text, std::string hint) {
  return make_error(ErrorId::kGraphicsDevice, std::move(text), std::move(hint));
}

bool of_nvidia(const EglVendor& vendor) {
  return (vendor.file + vendor.library).find("nvidia") != std::string::npos;
}

/// True if a value of NVIDIA_DRIVER_CAPABILITIES brings NVIDIA's EGL into the container.
bool brings_graphics(const std::string& capabilities) {
  const std::vector<std::string> names = split(capabilities, ',');
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "graphics" || name == "all" || name == "display";
  });
}

std::string vendor_list(const std::vector<EglVendor>& vendors) {
  std::string out;
  for (const EglVendor& vendor : vendors) out += (out.empty() ? "" : ", ") + vendor.file;
  return out.empty() ? "none" : out;
}

void add_nvidia(const GpuFacts& facts, std::vector<Error>& out) {
  const auto& capabilities = facts.nvidia_capabilities;
  if (capabilities && !brings_graphics(*capabilities)) {
    out.push_back(missing("NVIDIA_DRIVER_CAPABILITIES is '" + *capabilities +
                              "' and lacks graphics, so the container has no EGL of NVIDIA",
                          "start it with NVIDIA_DRIVER_CAPABILITIES=graphics,utility"));
  }
  const auto vendor = std::find_if(facts.vendors.begin(), facts.vendors.end(), of_nvidia);
  if (vendor == facts.vendors.end()) {
    out.push_back(missing(
        "/dev/nvidia* is there, but no EGL vendor file of NVIDIA (found: " +
            vendor_list(facts.vendors) + ")",
        "install the OpenGL and EGL libraries of NVIDIA's driver; a container gets them with "
        "NVIDIA_DRIVER_CAPABILITIES=graphics,utility"));
  }
}

}  // namespace

GpuFacts gpu_facts() {
  GpuFacts out;
  const std::vector<std::string> nvidia = files_in("/dev", "nvidia");
  out.nvidia_nodes = std::any_of(nvidia.begin(), nvidia.end(), is_card_node);
  out.render_nodes = files_in("/dev/dri", "renderD");
  for (const std::string& node : out.render_nodes) {
    if (access(node.c_str(), R_OK | W_OK) != 0) out.closed_nodes.push_back(node);
  }
  for (const std::string& file : vendor_files()) out.vendors.push_back(read_vendor(file));
  if (const char* set = std::getenv("NVIDIA_DRIVER_CAPABILITIES")) out.nvidia_capabilities = set;
  return out;
}

std::vector<Error> why_no_gpu(const GpuFacts& facts) {
  std::vector<Error> out;
  if (!facts.nvidia_nodes && facts.render_nodes.empty()) {
    out.push_back(missing("there is neither /dev/nvidia0 nor /dev/dri/renderD*: no card is visible",
                          "give a container the card with --gpus all or --device /dev/dri"));
  }
  if (facts.nvidia_nodes) add_nvidia(facts, out);
  for (const std::string& node : facts.closed_nodes) {
    out.push_back(
        missing("this user may not open " + node, "add the user to the groups video and render"));
  }
  if (facts.vendors.empty()) {
    out.push_back(missing("there is no EGL vendor file in /usr/share/glvnd/egl_vendor.d",
                          "install the card's driver, or Mesa: libegl1 and libgl1-mesa-dri"));
  }
  for (const EglVendor& vendor : facts.vendors) {
    if (vendor.load_error.empty()) continue;
    out.push_back(missing(vendor.file + ": its library does not load: " + vendor.load_error,
                          "install the driver anew, or the library that the line names"));
  }
  if (out.empty()) {
    out.push_back(missing("the card is visible, but its driver draws nothing (EGL vendor files: " +
                              vendor_list(facts.vendors) + ")",
                          "install the driver of this card; kernel and libraries of one version"));
  }
  return out;
}

}  // namespace mirage::gl
