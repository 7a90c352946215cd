# Writes a unit: a source file that includes SOURCES, so that they are compiled together even if their
# anonymous namespaces define equal names.
#   cmake -DUNIT=unit.cpp -DROOT=folder "-DSOURCES=a_test.cpp;b_test.cpp" -P unit.cmake
# The unit first includes all headers that any of SOURCES includes. It then includes each source inside a
# namespace of its own. The source's #include lines have no effect there, because each header is read only
# once. If a source reopens the namespace `study`, its own namespace gets a `study` in which the names of
# ::study are visible, and a `study::test` in which those of ::study::test and ::test are visible.
set(includes)
set(namespaces test)
set(body)
foreach(source IN LISTS SOURCES)
  file(STRINGS ${source} lines REGEX "^#include ")
  list(APPEND includes ${lines})
  file(RELATIVE_PATH own ${ROOT} ${source})
  string(MAKE_C_IDENTIFIER ${own} own)
  string(APPEND body "\nnamespace ${own} {\n")
  set(reopened)
  file(STRINGS ${source} lines REGEX "^namespace [A-Za-z_0-9:]+ {")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^namespace ([^ ]+) .*" "\\1" name ${line})
    string(REGEX REPLACE "::.*" "" outer ${name})
    list(APPEND reopened ${outer} ${outer}::test ${name})
  endforeach()
  list(REMOVE_DUPLICATES reopened)
  foreach(name IN LISTS reopened)
    string(APPEND body "namespace ${name} {\nusing namespace ::${name};\n")
    if(name MATCHES "::test$")
      string(APPEND body "using namespace ::test;\n")
    endif()
    string(APPEND body "}\n")
  endforeach()
  list(APPEND namespaces ${reopened})
  string(APPEND body "#include \"${source}\"\n}\n")
endforeach()
list(REMOVE_DUPLICATES includes)
list(JOIN includes "\n" includes)
list(REMOVE_DUPLICATES namespaces)
list(TRANSFORM namespaces REPLACE "(.+)" "namespace \\1 {}\n")
list(JOIN namespaces "" namespaces)
# file(CONFIGURE) does not touch a unit that is unchanged, so that it is not compiled again.
file(CONFIGURE OUTPUT ${UNIT} CONTENT "// Written by cmake/unit.cmake.\n${includes}\n\n${namespaces}${body}" @ONLY)
