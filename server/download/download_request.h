#pragma once
// Downloads that a visitor may ask for, and the programs that make them.

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace mirage {

/// The scene as this server has it.
struct DownloadScene {
  std::string scene, environment, look, device;
  bool geometry = true;  ///< false: meshes stay with the server
};

/// One object, or the whole scene, as impostors for an engine.
struct BakeDownload {
  std::optional<unsigned> object;  ///< its number in the scene; nullopt: all as one
  std::string target = "generic";
  int grid = 12;    ///< frames a side, 2 to 32
  int size = 2048;  ///< texels a side of a picture, 64 to 4096
};

/// The scene as a folder that any web host serves.
struct FolderDownload {
  std::optional<glm::dvec3> eye;   ///< where one stands, metres; nullopt: all around the scene
  std::optional<glm::dvec3> look;  ///< a point that one looks at from there, at first
  double reach_m = 1;              ///< how far one may step from there, on the level; 0 to 100
  int mb = 20;                     ///< 1 to 100, of 10^6 bytes
};

using DownloadRequest = std::variant<BakeDownload, FolderDownload>;

/// Reads the values of `kind=bake|folder&…`. Returns what is wrong with them as a string.
std::variant<DownloadRequest, std::string> read_download_request(
    const std::vector<std::pair<std::string, std::string>>& values);

/// Returns the program for the request.
std::string download_program(const DownloadRequest& request);
/// Returns its arguments, for a result in the folder `out`. Equal downloads have equal arguments.
std::vector<std::string> download_arguments(const DownloadRequest& request,
                                            const DownloadScene& scene, const std::string& out);
/// Returns the name for the file: the scene's, and what it is. It has no slash, quote or space.
std::string download_name(const DownloadRequest& request, const DownloadScene& scene);

}  // namespace mirage
