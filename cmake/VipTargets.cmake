# vip_flags: what every target of the project is compiled with. Warnings are for who changes the code: they take a tenth of the
# time, and each later compiler has others. They never reach nvcc.
add_library(vip_flags INTERFACE)
target_include_directories(vip_flags INTERFACE ${PROJECT_SOURCE_DIR})
set(_cxx "$<COMPILE_LANGUAGE:CXX>")
# The code reads neither errno nor FP traps of <cmath>; NaN and infinity keep their meaning.
target_compile_options(vip_flags INTERFACE $<${_cxx}:-fno-math-errno> $<${_cxx}:-fno-trapping-math>)
set(_unity "$<AND:${_cxx},$<CXX_COMPILER_ID:GNU>,$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>")
# In a unit, which is no main file to g++, a class may hold a type of its own source.
target_compile_options(vip_flags INTERFACE $<${_unity}:-Wno-subobject-linkage>)
if(VIP_WERROR)
  # A local name may be that of a constant of another source of its unit.
  target_compile_options(vip_flags INTERFACE
    $<${_cxx}:-Wall> $<${_cxx}:-Wextra> $<IF:${_unity},-Wshadow=local,$<${_cxx}:-Wshadow>>
    $<${_cxx}:-Wnon-virtual-dtor> $<${_cxx}:-Wconversion>
    $<${_cxx}:-Wno-sign-conversion> $<${_cxx}:-Werror>
    # False alarms of g++ 12 inside std::string (GCC bug 105651).
    $<$<AND:${_cxx},$<CXX_COMPILER_ID:GNU>>:-Wno-restrict>)
endif()
# g++ frees memory once it holds 400 MB: a tenth less time for the larger units, which then take up to 1 GB each.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(vip_flags INTERFACE "$<${_cxx}:SHELL:--param ggc-min-heapsize=400000>")
endif()
if(VIP_NATIVE)
  # Lists of neighbours have some 40 entries: lanes of 512 bits leave too many for the last, partial step.
  target_compile_options(vip_flags INTERFACE $<${_cxx}:-march=native> $<${_cxx}:-mprefer-vector-width=256>)
endif()
if(VIP_SANITIZE)
  target_compile_options(vip_flags INTERFACE $<${_cxx}:-fsanitize=${VIP_SANITIZE}> $<${_cxx}:-fno-omit-frame-pointer>
                         # What is found ends the test, undefined behaviour too.
                         $<${_cxx}:-fno-sanitize-recover=all>)
  target_link_options(vip_flags INTERFACE -fsanitize=${VIP_SANITIZE})
endif()

if(VIP_LIBFUZZER)
  # The libraries carry the coverage that libFuzzer steers by; the entries alone link its main.
  target_compile_options(vip_flags INTERFACE $<${_cxx}:-fsanitize=fuzzer-no-link,address,undefined>
                         $<${_cxx}:-fno-sanitize-recover=undefined>)
  target_link_options(vip_flags INTERFACE -fsanitize=address,undefined)
endif()

# vip_precompile(TARGET [HEADERS...]) reads once what most files of a target include. It shortens the build and changes nothing
# else: each file still includes what it uses, which -DVIP_PRECOMPILE=OFF shows. Without HEADERS the targets of a folder and those
# below it share the standard headers, which have no definitions but vip_flags': g++ refuses headers that were compiled with a
# definition that the file lacks. vip_precompile(TARGET REUSE_FROM OTHER) takes those of a target that is compiled with the same
# flags. Templates of such headers are instantiated in every file, whether it uses them or not: CLI11, which few files need, cost
# each of the others 2.6 s.
set(vip_standard_headers <algorithm> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <set> <sstream>
    <string> <vector>)
function(vip_precompile target)
  if(VIP_PRECOMPILE)
    if("${ARGV1}" STREQUAL "REUSE_FROM")
      target_precompile_headers(${target} ${ARGN})
    elseif(ARGN)
      target_precompile_headers(${target} PRIVATE ${vip_standard_headers} ${ARGN})
    else()
      target_precompile_headers(${target} REUSE_FROM ${vip_headers})
    endif()
    # What comes from there is no system header to g++ 12: its false alarms inside std::string show (GCC bug 105329).
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow)
    endif()
  endif()
endfunction()

# vip_shared_headers(NAME) compiles the standard headers with the flags that are in force, for vip_precompile after it.
function(vip_shared_headers name)
  if(VIP_PRECOMPILE)
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/headers.cpp CONTENT "")
    add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/headers.cpp)
    target_link_libraries(${name} PRIVATE vip_flags)
    target_precompile_headers(${name} PRIVATE ${vip_standard_headers})
    set(vip_headers ${name} PARENT_SCOPE)
  endif()
endfunction()

# vip_unity(TARGET [FIRST regex] [APART sources...]) compiles the sources of a target in units of up to 150 kB, so that what they
# include is read, and its templates are instantiated, once in a unit. A name in an anonymous namespace therefore occurs once in a
# target, apart from the sources listed after APART. Sources are taken by path; those that match FIRST come first and so share
# their units. Each file still includes what it uses, which -DVIP_UNITY=OFF shows.
function(vip_unity target)
  if(NOT VIP_UNITY)
    return()
  endif()
  cmake_parse_arguments(arg "" "FIRST" "APART" ${ARGN})
  set(apart)
  foreach(source IN LISTS arg_APART)
    get_filename_component(source ${source} ABSOLUTE)
    list(APPEND apart ${source})
  endforeach()
  get_target_property(rest ${target} SOURCES)
  list(SORT rest)
  set(sources)
  if(arg_FIRST)
    set(sources ${rest})
    list(FILTER sources INCLUDE REGEX "${arg_FIRST}")
    list(FILTER rest EXCLUDE REGEX "${arg_FIRST}")
  endif()
  set(unit 0)
  set(bytes 0)
  foreach(source IN LISTS sources rest)
    get_filename_component(source ${source} ABSOLUTE)
    if(source IN_LIST apart OR NOT source MATCHES "\\.cpp$")
      continue()
    endif()
    file(SIZE ${source} size)
    math(EXPR bytes "${bytes} + ${size}")
    if(bytes GREATER 150000)
      math(EXPR unit "${unit} + 1")
      set(bytes ${size})
    endif()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${target}_${unit})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# vip_test_units(TARGET [EACH n] [APART sources...]) compiles the *_test.cpp of each folder n at a time (default: 8) as one, which
# unit.cmake writes. Unlike those of vip_unity they may hold equal names. A source with options of its own stays apart, as must one
# that defines what a header declares (a printer of GoogleTest's too). Call it when the properties of the sources are set.
function(vip_test_units target)
  if(NOT VIP_UNITY OR NOT TARGET ${target})
    return()
  endif()
  cmake_parse_arguments(arg "" "EACH" "APART" ${ARGN})
  if(NOT arg_EACH)
    set(arg_EACH 8)
  endif()
  set(apart)
  foreach(source IN LISTS arg_APART)
    get_filename_component(source ${source} ABSOLUTE)
    list(APPEND apart ${source})
  endforeach()
  get_target_property(sources ${target} SOURCES)
  set(groups)
  foreach(source IN LISTS sources)
    get_filename_component(source ${source} ABSOLUTE)
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    if(options OR source IN_LIST apart OR NOT source MATCHES "_test\\.cpp$")
      continue()
    endif()
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
    string(MAKE_C_IDENTIFIER "${folder}" group)
    list(APPEND groups ${group})
    list(APPEND sources_${group} ${source})
  endforeach()
  list(REMOVE_DUPLICATES groups)
  foreach(group IN LISTS groups)
    # Units of equal size: nine sources are five and four.
    list(LENGTH sources_${group} count)
    math(EXPR units "(${count} + ${arg_EACH} - 1) / ${arg_EACH}")
    if(count EQUAL 1)
      continue()
    endif()
    foreach(number RANGE 1 ${units})
      math(EXPR first "${count} * (${number} - 1) / ${units}")
      math(EXPR length "${count} * ${number} / ${units} - ${first}")
      list(SUBLIST sources_${group} ${first} ${length} members)
      set(unit ${CMAKE_CURRENT_BINARY_DIR}/${target}_units/${group}_${number}.cpp)
      add_custom_command(OUTPUT ${unit} VERBATIM DEPENDS ${members} ${PROJECT_SOURCE_DIR}/cmake/unit.cmake
        COMMAND ${CMAKE_COMMAND} -DUNIT=${unit} -DROOT=${PROJECT_SOURCE_DIR} "-DSOURCES=${members}"
                -P ${PROJECT_SOURCE_DIR}/cmake/unit.cmake)
      list(GET members 0 any)
      get_source_file_property(definitions ${any} COMPILE_DEFINITIONS)
      if(definitions)
        set_source_files_properties(${unit} PROPERTIES COMPILE_DEFINITIONS "${definitions}")
      endif()
      set_source_files_properties(${members} PROPERTIES HEADER_FILE_ONLY ON)
      target_sources(${target} PRIVATE ${unit})
    endforeach()
  endforeach()
  # For the warnings of units; none of CMake's own is made.
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# vip_library(NAME SOURCES... ) a static library; vip_program(NAME ...) an installed program.
function(vip_library name)
  add_library(${name} STATIC ${ARGN})
  set_target_properties(${name} PROPERTIES LINKER_LANGUAGE CXX)
  target_link_libraries(${name} PUBLIC vip_flags)
endfunction()

function(vip_program name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE vip_flags)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  install(TARGETS ${name} RUNTIME DESTINATION bin)
endfunction()
