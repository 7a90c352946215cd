# cmake -P, after a test program is linked: writes its ctest entries to ENTRIES. A suite of the label `unit` is one entry, since its
# tests take less time than a start of the program and of ctest's bookkeeping for each; GoogleTest names the test that failed. Every
# other test is an entry, and with ONE_BY_ONE these too: it runs side by side with others of its suite, with a time limit of its own.
# A test in real time counts as two, so that fewer others run beside it.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status TIMEOUT 60)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests ends with ${status}\n${listed}")
endif()
string(REGEX REPLACE " *#[^\n]*" "" listed "${listed}")  # values of parameters
string(REPLACE "\n" ";" listed "${listed}")
set(entries "")
set(suites "")
function(add_entry name filter label timeout)
  # A suite is skipped when all of its tests are, not when one is; what follows in the output says that others failed.
  set(skipped "\\[  PASSED  \\] 0 tests\\.\n\\[  SKIPPED \\] [0-9]+ tests?, listed below:\n(\\[  SKIPPED \\] [^\n]*\n?)+$")
  set(processors 1)
  if(name MATCHES "Real(Time|Clock)")
    set(processors 2)
  endif()
  string(APPEND entries "add_test([=[${name}]=] ${PROGRAM} [=[--gtest_filter=${filter}]=] --gtest_also_run_disabled_tests)\n"
         "set_tests_properties([=[${name}]=] PROPERTIES WORKING_DIRECTORY [=[${FOLDER}]=] LABELS ${label} TIMEOUT ${timeout}"
         " ENVIRONMENT OMP_WAIT_POLICY=passive PROCESSORS ${processors} SKIP_REGULAR_EXPRESSION [=[${skipped}]=])\n")
  set(entries "${entries}" PARENT_SCOPE)
endfunction()
foreach(line IN LISTS listed)
  if(line MATCHES "^([^ ]+)\\.$")
    set(suite ${CMAKE_MATCH_1})
    string(REGEX REPLACE "^.*/" "" subject ${suite})  # of Prefix/Suite
    set(label ${LABEL})
    if(subject MATCHES "(Gl|Gpu|Slow|E2e)$")
      string(TOLOWER ${CMAKE_MATCH_1} label)
    endif()
    if(label STREQUAL unit AND NOT ONE_BY_ONE AND NOT subject IN_LIST suites)
      list(APPEND suites ${subject})
      add_entry(${subject} "${subject}.*:*/${subject}.*" unit 900)
    endif()
  elseif(line MATCHES "^  ([^ ]+)$" AND (ONE_BY_ONE OR NOT label STREQUAL unit))
    if(label STREQUAL LABEL)
      set(timeout 300)
    else()
      set(timeout 900)
    endif()
    add_entry(${suite}.${CMAKE_MATCH_1} ${suite}.${CMAKE_MATCH_1} ${label} ${timeout})
  endif()
endforeach()
file(WRITE ${ENTRIES} "${entries}")
