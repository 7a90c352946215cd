# vip_flags: what every target of the project is compiled with. Warnings are for who changes the code: they take a tenth of the
# time, and each later compiler has others. They never reach nvcc.
add_library(vip_flags INTERFACE)
target_include_directories(vip_flags INTERFACE ${PROJECT_SOURCE_DIR})
set(_cxx "$<COMPILE_LANGUAGE:CXX>")
# The code reads neither errno nor FP traps of <cmath>; NaN and infinity keep their meaning.
target_compile_options(vip_flags INTERFACE $<${_cxx}:-fno-math-errno> $<${_cxx}:-fno-trapping-math>)
if(VIP_WERROR)
  # Compiled with other sources, a local name may be that of their constants, and a class may hold a type of its own file.
  set(_unity "$<AND:${_cxx},$<CXX_COMPILER_ID:GNU>,$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>")
  target_compile_options(vip_flags INTERFACE
    $<${_cxx}:-Wall> $<${_cxx}:-Wextra> $<IF:${_unity},-Wshadow=local,$<${_cxx}:-Wshadow>>
    $<${_unity}:-Wno-subobject-linkage> $<${_cxx}:-Wnon-virtual-dtor> $<${_cxx}:-Wconversion>
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

# vip_precompile(TARGET HEADERS...) what most files of a target include is read once. It shortens the build and changes nothing
# else: each file still includes what it uses, which -DVIP_PRECOMPILE=OFF shows. vip_precompile(TARGET REUSE_FROM OTHER) takes
# those of a target that is compiled with the same flags. Templates of such headers are instantiated in every file, whether it
# uses them or not: CLI11, which few files need, cost each of the others 2.6 s.
function(vip_precompile target)
  if(VIP_PRECOMPILE)
    if("${ARGV1}" STREQUAL "REUSE_FROM")
      target_precompile_headers(${target} ${ARGN})
    else()
      target_precompile_headers(${target} PRIVATE <algorithm> <cmath> <cstdint> <filesystem> <functional> <map> <memory>
                                <optional> <set> <sstream> <string> <vector> ${ARGN})
    endif()
    # What comes from there is no system header to g++ 12: its false alarms inside std::string show (GCC bug 105329).
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow)
    endif()
  endif()
endfunction()

# vip_unity(TARGET [FIRST regex] [APART sources...]) compiles the sources of each folder eight at a time as one, so that what they
# include is read, and its templates are instantiated, once. A name in an anonymous namespace occurs once in a folder, apart from
# the sources named here. Sources whose names match FIRST share their units. Each file still includes what it uses, which
# -DVIP_UNITY=OFF shows.
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
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(source ${source} ABSOLUTE)
    if(source IN_LIST apart)
      continue()
    endif()
    get_filename_component(folder ${source} DIRECTORY)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
    get_filename_component(name ${source} NAME)
    if(arg_FIRST AND name MATCHES "${arg_FIRST}")
      set(folder ${arg_FIRST})
    endif()
    string(MAKE_C_IDENTIFIER "${folder}" group)
    if(NOT DEFINED count_${group})
      set(count_${group} 0)
    endif()
    math(EXPR unit "${count_${group}} / 8")
    math(EXPR count_${group} "${count_${group}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group}_${unit})
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
