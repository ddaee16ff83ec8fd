# Every dependency comes from the distribution; nothing is vendored or downloaded.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(glm REQUIRED)
find_package(OpenGL REQUIRED COMPONENTS OpenGL EGL)
find_package(OpenImageIO REQUIRED)
find_package(PNG REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto SSL)
find_package(FlatBuffers REQUIRED CONFIG NAMES FlatBuffers Flatbuffers flatbuffers)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(glfw3 REQUIRED)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(LWS REQUIRED IMPORTED_TARGET libwebsockets)
pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp)
pkg_check_modules(WEBPMUX REQUIRED IMPORTED_TARGET libwebpmux)
pkg_check_modules(PROMETHEUS REQUIRED IMPORTED_TARGET prometheus-cpp-core)
find_package(meshoptimizer REQUIRED CONFIG)
find_package(TinyGLTF REQUIRED)
# KHR_draco_mesh_compression; without it such files are refused by name.
# libdraco exports a tinygltf of its own, of another layout than the real one, and whichever comes
# first in a program wins: link it after tinygltf, and only through mirage_gltf (a test looks).
pkg_check_modules(DRACO IMPORTED_TARGET draco)
# A store that servers share; without it --store is refused by name.
pkg_check_modules(HIREDIS IMPORTED_TARGET hiredis)
# The video baseline of mirage-report; without it that row of the report is left out.
pkg_check_modules(LIBAV IMPORTED_TARGET libavcodec libavutil libswscale)
if(MIRAGE_TESTS)
  find_package(GTest REQUIRED)
endif()
