# SPDX-License-Identifier: BSD-3-Clause
# cmake -DPROGRAM=... -DARGUMENTS="a;b" -DEXIT=1 [-DSTDERR=regex] [-DSTDOUT=regex] -P check.cmake
# Runs a program as a user does and checks its exit code and what it says. A failing run must say one line.
execute_process(COMMAND ${PROGRAM} ${ARGUMENTS}
  RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
set(shown "exit ${code}\n--- stdout\n${out}\n--- stderr\n${err}")
if(NOT code EQUAL EXIT)
  message(FATAL_ERROR "expected exit code ${EXIT}: ${shown}")
endif()
if(NOT EXIT EQUAL 0)
  string(STRIP "${err}" stripped)
  if(stripped STREQUAL "" OR stripped MATCHES "\n")
    message(FATAL_ERROR "expected one line on stderr: ${shown}")
  endif()
endif()
if(DEFINED STDERR AND NOT err MATCHES "${STDERR}")
  message(FATAL_ERROR "stderr does not match '${STDERR}': ${shown}")
endif()
if(DEFINED STDOUT AND NOT out MATCHES "${STDOUT}")
  message(FATAL_ERROR "stdout does not match '${STDOUT}': ${shown}")
endif()
