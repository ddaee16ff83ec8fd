# Writes OUTPUT, a header that defines MIRAGE_COMMIT as git describes ROOT. It leaves an equal file alone. Run it with cmake -P.
execute_process(COMMAND git -C ${ROOT} describe --always --dirty --tags OUTPUT_VARIABLE commit
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once\n#define MIRAGE_COMMIT \"${commit}\"\n")
