# Finds the dependencies. All come from the distribution; nothing is vendored or downloaded. First those of the client library.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(glm REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto SSL)
find_package(FlatBuffers REQUIRED CONFIG NAMES FlatBuffers Flatbuffers flatbuffers)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(LWS REQUIRED IMPORTED_TARGET libwebsockets)
pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp)
find_package(meshoptimizer REQUIRED CONFIG)
if(MIRAGE_LIBRARY_ONLY)
  find_package(OpenGL REQUIRED COMPONENTS OpenGL)
  return()
endif()

find_package(OpenGL REQUIRED COMPONENTS OpenGL EGL)
find_package(OpenImageIO REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(glfw3 REQUIRED)
pkg_check_modules(WEBPMUX REQUIRED IMPORTED_TARGET libwebpmux)
pkg_check_modules(PROMETHEUS REQUIRED IMPORTED_TARGET prometheus-cpp-core)
find_package(TinyGLTF REQUIRED)
# Draco reads KHR_draco_mesh_compression; without it such files are refused by name.
# libdraco exports its own tinygltf with another layout, and the first one in a program wins. So link libdraco after tinygltf,
# and only through mirage_gltf. A test checks this.
pkg_check_modules(DRACO IMPORTED_TARGET draco)
# Recast finds the ground that people walk on.
find_library(RECAST_LIBRARY Recast REQUIRED)
# hiredis is for the store that servers share; without it --store is refused by name.
pkg_check_modules(HIREDIS IMPORTED_TARGET hiredis)
# libqrencode writes the page's address for phones; without it there is no code.
pkg_check_modules(QRENCODE IMPORTED_TARGET libqrencode)
# libav is for the video baseline of mirage-report; without it the report leaves that row out.
pkg_check_modules(LIBAV IMPORTED_TARGET libavcodec libavutil libswscale)
if(MIRAGE_TESTS)
  find_package(GTest REQUIRED)
endif()
