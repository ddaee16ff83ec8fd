message(STATUS "Mirage ${PROJECT_VERSION}: ${CMAKE_BUILD_TYPE}, sanitizers '${MIRAGE_SANITIZE}', "
               "tests ${MIRAGE_TESTS}, fuzz ${MIRAGE_FUZZ}")
