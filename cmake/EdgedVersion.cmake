# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Run at every build: cmake -DSOURCE_DIR=... -DOUTPUT=version.cpp -DVERSION=0.1.0 -P EdgedVersion.cmake
execute_process(
  COMMAND git -C ${SOURCE_DIR} describe --always --exclude=* --abbrev=8
  OUTPUT_VARIABLE COMMIT
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(
  COMMAND git -C ${SOURCE_DIR} status --porcelain --untracked-files=no
  OUTPUT_VARIABLE CHANGES
  ERROR_QUIET)
set(TEXT "${VERSION}")
if(COMMIT AND CHANGES)
  set(TEXT "${VERSION} (${COMMIT}, changed)")
elseif(COMMIT)
  set(TEXT "${VERSION} (${COMMIT})")
endif()
set(CONTENT "#include \"common/cli.hpp\"\n\nnamespace edged {\nconst char* const kVersion = \"${TEXT}\";\n}  // namespace edged\n")
set(OLD "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} OLD)
endif()
if(NOT OLD STREQUAL CONTENT)
  file(WRITE ${OUTPUT} "${CONTENT}")
endif()
