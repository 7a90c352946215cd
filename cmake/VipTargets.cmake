# vip_flags: the compile options of every target of the project. Warnings are enabled only with VIP_WERROR,
# for developers: they take a tenth of the compile time, and each later compiler warns of other things. nvcc
# gets no warning options.
add_library(vip_flags INTERFACE)
target_include_directories(vip_flags INTERFACE ${PROJECT_SOURCE_DIR})
set(_cxx "$<COMPILE_LANGUAGE:CXX>")
# The code reads neither errno nor floating-point exception flags after calls of <cmath>, so that g++ need not
# set them. NaN and infinity keep their meaning.
target_compile_options(vip_flags INTERFACE $<${_cxx}:-fno-math-errno> $<${_cxx}:-fno-trapping-math>)
set(_unity "$<AND:${_cxx},$<CXX_COMPILER_ID:GNU>,$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>")
# Outside the main file g++ warns if a class has a member of a type from an anonymous namespace. In a unity
# unit the sources are included and so not the main file, and the warning would be a false alarm.
target_compile_options(vip_flags INTERFACE $<${_unity}:-Wno-subobject-linkage>)
if(VIP_WERROR)
  # In a unity unit a local name may equal the name of a constant in another source. There only -Wshadow=local
  # is used, which does not warn of such names.
  target_compile_options(vip_flags INTERFACE
    $<${_cxx}:-Wall> $<${_cxx}:-Wextra> $<IF:${_unity},-Wshadow=local,$<${_cxx}:-Wshadow>>
    $<${_cxx}:-Wnon-virtual-dtor> $<${_cxx}:-Wconversion>
    $<${_cxx}:-Wno-sign-conversion> $<${_cxx}:-Werror>
    # -Wrestrict gives false alarms in g++ 12 inside std::string (GCC bug 105651).
    $<$<AND:${_cxx},$<CXX_COMPILER_ID:GNU>>:-Wno-restrict>)
endif()
# g++ collects garbage only when its heap exceeds 400 MB. This shortens the compilation of larger units by a
# tenth; each then takes up to 1 GB of memory.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(vip_flags INTERFACE "$<${_cxx}:SHELL:--param ggc-min-heapsize=400000>")
endif()
if(VIP_NATIVE)
  # Lists of neighbours have about 40 entries. With vectors of 512 bits too many entries would fall into the
  # last, incomplete vector, so that vectors of 256 bits are preferred.
  target_compile_options(vip_flags INTERFACE $<${_cxx}:-march=native> $<${_cxx}:-mprefer-vector-width=256>)
endif()
if(VIP_SANITIZE)
  target_compile_options(vip_flags INTERFACE $<${_cxx}:-fsanitize=${VIP_SANITIZE}> $<${_cxx}:-fno-omit-frame-pointer>
                         # Every finding ends the test, including undefined behaviour.
                         $<${_cxx}:-fno-sanitize-recover=all>)
  target_link_options(vip_flags INTERFACE -fsanitize=${VIP_SANITIZE})
endif()

if(VIP_LIBFUZZER)
  # The libraries are instrumented for coverage, which guides libFuzzer. Only the fuzz programs link
  # libFuzzer's main().
  target_compile_options(vip_flags INTERFACE $<${_cxx}:-fsanitize=fuzzer-no-link,address,undefined>
                         $<${_cxx}:-fno-sanitize-recover=undefined>)
  target_link_options(vip_flags INTERFACE -fsanitize=address,undefined)
endif()

# vip_precompile(TARGET [HEADERS...]) precompiles the headers that most files of a target include. This only
# shortens the build: each file still includes what it uses, which a build with -DVIP_PRECOMPILE=OFF verifies.
# Without HEADERS the target uses the standard headers that vip_shared_headers() compiled. They are compiled
# with the definitions of vip_flags alone, because g++ refuses precompiled headers with a definition that the
# file lacks.
# vip_precompile(TARGET REUSE_FROM OTHER) uses the precompiled headers of a target that is compiled with the
# same flags. Add only HEADERS that most files need: g++ instantiates their templates in every file, even in
# files that do not use them. CLI11, which few files need, cost each other file 2.6 s.
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
    # g++ 12 does not treat precompiled headers as system headers, so that its false alarms inside std::string
    # would be shown (GCC bug 105329).
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow)
    endif()
  endif()
endfunction()

# vip_shared_headers(NAME) precompiles the standard headers with the present flags. Later calls of
# vip_precompile() in this folder and the folders below use them.
function(vip_shared_headers name)
  if(VIP_PRECOMPILE)
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/headers.cpp CONTENT "")
    add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/headers.cpp)
    target_link_libraries(${name} PRIVATE vip_flags)
    target_precompile_headers(${name} PRIVATE ${vip_standard_headers})
    set(vip_headers ${name} PARENT_SCOPE)
  endif()
endfunction()

# vip_unity(TARGET [FIRST regex] [EACH n] [APART sources...]) compiles the sources of a target in units of up
# to 150 kB; with EACH, in units of up to n sources of one folder. Headers are then read, and templates
# instantiated, once for each unit. Therefore a name in an anonymous namespace may occur only once in a target;
# this does not apply to the sources after APART, which are compiled separately. Sources are added to the units
# in the order of their paths, but sources that match FIRST before all others, so that they share units. Each
# file still includes what it uses, which a build with -DVIP_UNITY=OFF verifies.
function(vip_unity target)
  if(NOT VIP_UNITY)
    return()
  endif()
  cmake_parse_arguments(arg "" "FIRST;EACH" "APART" ${ARGN})
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
  set(number 0)
  set(bytes 0)
  foreach(source IN LISTS sources rest)
    get_filename_component(source ${source} ABSOLUTE)
    if(source IN_LIST apart OR NOT source MATCHES "\\.cpp$")
      continue()
    endif()
    if(arg_EACH)
      get_filename_component(folder ${source} DIRECTORY)
      file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${folder})
      string(MAKE_C_IDENTIFIER ${folder} folder)
      list(APPEND sources_${folder} ${source})
      list(LENGTH sources_${folder} count)
      math(EXPR number "(${count} - 1) / ${arg_EACH}")
      set(unit ${folder}_${number})
    else()
      file(SIZE ${source} size)
      math(EXPR bytes "${bytes} + ${size}")
      if(bytes GREATER 150000)
        math(EXPR number "${number} + 1")
        set(bytes ${size})
      endif()
      set(unit ${target}_${number})
    endif()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${unit})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# vip_test_units(TARGET [APART sources...]) compiles the *_test.cpp files of a target in units of up to 24
# files, which unit.cmake writes. Unlike the sources of vip_unity(), these files may define equal names. A
# source with compile options of its own is compiled separately; sources with COMPILE_DEFINITIONS share units
# with those of their folder. List after APART each source that defines something that a header declares, such
# as a printer for GoogleTest. Call vip_test_units() after the properties of the sources are set.
function(vip_test_units target)
  if(NOT VIP_UNITY OR NOT TARGET ${target})
    return()
  endif()
  cmake_parse_arguments(arg "" "" "APART" ${ARGN})
  set(most 24)
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
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    if(NOT definitions)
      string(REGEX REPLACE "^([^/]+/[^/]+)/.*" "\\1" folder "${folder}")
    endif()
    string(MAKE_C_IDENTIFIER "${folder}" group)
    list(APPEND groups ${group})
    list(APPEND sources_${group} ${source})
  endforeach()
  list(REMOVE_DUPLICATES groups)
  foreach(group IN LISTS groups)
    # Divides the sources evenly: nine sources become units of four and five sources.
    list(LENGTH sources_${group} count)
    math(EXPR units "(${count} + ${most} - 1) / ${most}")
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
  # This property selects the warning options for units (vip_flags). CMake adds no units of its own.
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# vip_library(NAME SOURCES...) adds a static library. vip_program(NAME SOURCES...) adds a program and its
# installation.
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
