# Run as a script: OUTPUT defines MIRAGE_COMMIT as git describes ROOT; untouched when it is the same.
execute_process(COMMAND git -C ${ROOT} describe --always --dirty --tags OUTPUT_VARIABLE commit
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once\n#define MIRAGE_COMMIT \"${commit}\"\n")
