# Writes tests/bench/commit.h into FOLDER: the commit of the build, followed by "+" when files have been changed.
cmake_policy(VERSION 3.25)
# Run at each build; the file is touched only when it says something new.
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND git -C ${SOURCE} status --porcelain --untracked-files=no -- server protocol tests/bench/*.cpp
  OUTPUT_VARIABLE changes ERROR_QUIET)
if(NOT commit)
  set(commit "unknown")
elseif(changes)
  string(APPEND commit "+")
endif()
file(CONFIGURE OUTPUT ${FOLDER}/tests/bench/commit.h CONTENT
  "#pragma once\n\nnamespace wobble::bench {\ninline constexpr char kCommit[] = \"@commit@\";\n}\n" @ONLY)
