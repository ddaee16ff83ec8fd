# Provides the libraries of the browser's client. Emscripten sees only its own headers and those named here. zstd,
# meshoptimizer and libwebp are compiled from the distribution's source packages, the decoders alone. scripts/web fetches the
# packages to MIRAGE_WEB_SOURCES.
set(MIRAGE_WEB_SOURCES ${PROJECT_SOURCE_DIR}/build/web-sources CACHE PATH "Unpacked source packages: zstd, meshoptimizer, webp")
foreach(source zstd/lib meshoptimizer/src webp/src)
  if(NOT EXISTS ${MIRAGE_WEB_SOURCES}/${source})
    message(FATAL_ERROR "there is no ${MIRAGE_WEB_SOURCES}/${source}: run scripts/web, which fetches it")
  endif()
endforeach()
find_program(FLATC flatc REQUIRED NO_CMAKE_FIND_ROOT_PATH)

# Links only header-only libraries of the machine, so that the headers of its C library stay out.
set(headers ${PROJECT_BINARY_DIR}/include)
foreach(header glm flatbuffers xxhash.h xxh3.h)
  if(EXISTS /usr/include/${header})
    file(MAKE_DIRECTORY ${headers})
    file(CREATE_LINK /usr/include/${header} ${headers}/${header} SYMBOLIC)
  endif()
endforeach()

function(mirage_header_library name)
  add_library(${name} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${name} SYSTEM INTERFACE ${headers})
endfunction()
mirage_header_library(glm::glm)
mirage_header_library(flatbuffers::flatbuffers)
mirage_header_library(PkgConfig::XXHASH)
target_compile_definitions(PkgConfig::XXHASH INTERFACE XXH_INLINE_ALL)
add_library(OpenGL::OpenGL INTERFACE IMPORTED GLOBAL)
add_executable(flatbuffers::flatc IMPORTED GLOBAL)
set_target_properties(flatbuffers::flatc PROPERTIES IMPORTED_LOCATION ${FLATC})

function(mirage_decoder name alias include)
  add_library(${name} STATIC ${ARGN})
  # Less inlining saves bytes and costs no time; -Os decodes a WebP image in 2.8 times the time.
  target_compile_options(${name} PRIVATE -O2 -w "SHELL:-mllvm -inline-threshold=30")
  target_include_directories(${name} SYSTEM PUBLIC ${include})
  add_library(${alias} ALIAS ${name})
endfunction()
set(zstd ${MIRAGE_WEB_SOURCES}/zstd/lib)
file(GLOB zstd_files ${zstd}/common/*.c ${zstd}/decompress/*.c)
mirage_decoder(zstd_decoder PkgConfig::ZSTD ${zstd} ${zstd_files})
# These macros of its own leave out second decoders for other trade-offs, and texts of errors.
target_compile_definitions(zstd_decoder PRIVATE ZSTD_DISABLE_ASM=1 HUF_FORCE_DECOMPRESS_X1 ZSTD_FORCE_DECOMPRESS_SEQUENCES_SHORT
                           ZSTD_STRIP_ERROR_STRINGS=1)

set(meshopt ${MIRAGE_WEB_SOURCES}/meshoptimizer/src)
file(GLOB meshopt_files ${meshopt}/*codec.cpp ${meshopt}/allocator.cpp)
mirage_decoder(meshopt_decoder meshoptimizer::meshoptimizer ${meshopt} ${meshopt_files})

set(webp ${MIRAGE_WEB_SOURCES}/webp)
file(GLOB webp_files ${webp}/src/dec/*.c)
foreach(file dsp/alpha_processing dsp/cpu dsp/dec dsp/dec_clip_tables dsp/filters dsp/lossless dsp/rescaler dsp/upsampling dsp/yuv
        utils/bit_reader_utils utils/color_cache_utils utils/filters_utils utils/huffman_utils utils/quant_levels_dec_utils
        utils/random_utils utils/rescaler_utils utils/thread_utils utils/utils)
  list(APPEND webp_files ${webp}/src/${file}.c)
endforeach()
mirage_decoder(webp_decoder PkgConfig::WEBP ${webp}/src ${webp_files})
target_include_directories(webp_decoder PRIVATE ${webp})
target_compile_definitions(webp_decoder PRIVATE WEBP_REDUCE_SIZE WEBP_REDUCE_CSP)  # no scaling; RGBA and few other orders
