set(video "left out (no libavcodec, libavutil, libswscale)")
if(LIBAV_FOUND)
  set(video "libavcodec ${LIBAV_libavcodec_VERSION}")
endif()
message(STATUS "Mirage ${PROJECT_VERSION}: ${CMAKE_BUILD_TYPE}, sanitizers '${MIRAGE_SANITIZE}', "
               "tests ${MIRAGE_TESTS}, fuzz ${MIRAGE_FUZZ}, video baseline ${video}")
