# SPDX-License-Identifier: BSD-3-Clause
# Writes the commit of the source tree to a header, which is only touched when the commit changes. For
# uncommitted changes the id ends in -dirty and a hash of the changes, so that different trees have different
# ids. A tree that is not a repository of its own, such as an unpacked archive, has the id of its VERSION.
cmake_policy(VERSION 3.22)
set(GIT git -C ${SOURCE} -c safe.directory=${SOURCE})
execute_process(COMMAND ${GIT} rev-parse --show-prefix OUTPUT_VARIABLE PREFIX OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND ${GIT} describe --always --dirty --abbrev=12
    OUTPUT_VARIABLE ID OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE FAILED)
if(FAILED OR PREFIX OR NOT ID)
    set(ID "v${VERSION}")
endif()
if(ID MATCHES "-dirty$")
    execute_process(COMMAND ${GIT} diff HEAD --no-ext-diff --no-color --full-index
        OUTPUT_VARIABLE CHANGES ERROR_QUIET)
    string(SHA256 HASH "${CHANGES}")
    string(SUBSTRING ${HASH} 0 8 HASH)
    string(APPEND ID "-${HASH}")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#pragma once\n#define SHEARWAKE_GIT_ID \"@ID@\"\n" @ONLY)
