# Writes the commit of the source tree into a header, and touches it only when it changes.
cmake_policy(VERSION 3.22)
execute_process(COMMAND git -C ${SOURCE} -c safe.directory=${SOURCE} describe --always --dirty --abbrev=12
    OUTPUT_VARIABLE ID OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE FAILED)
if(FAILED OR NOT ID)
    set(ID "unknown")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#pragma once\n#define SHEARWAKE_GIT_ID \"@ID@\"\n" @ONLY)
