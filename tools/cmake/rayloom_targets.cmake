# How every library, tool and test of Rayloom is made. One place for flags, so that a folder's CMakeLists names only
# its sources and what it links.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(RAYLOOM_CCACHE ccache)
if(RAYLOOM_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${RAYLOOM_CCACHE})
endif()

# <rayloom/accel/...> works in the tree as it does when installed: a link named rayloom to the source directory.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include)
file(CREATE_LINK ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include/rayloom SYMBOLIC)

include(GNUInstallDirs)

add_library(rayloom_options INTERFACE)
add_library(rayloom::options ALIAS rayloom_options)
set_target_properties(rayloom_options PROPERTIES EXPORT_NAME options)
target_include_directories(rayloom_options INTERFACE
  $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_features(rayloom_options INTERFACE cxx_std_20)
# Contraction off: a multiply-add the source does not ask for would give other bits on another target (docs/numerics.md).
target_compile_options(rayloom_options INTERFACE -ffp-contract=off -fno-math-errno)
install(TARGETS rayloom_options EXPORT rayloom)

add_library(rayloom_warnings INTERFACE)
target_compile_options(rayloom_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion -Wno-sign-conversion -Wold-style-cast
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # false alarms on std::string's operator+ (GCC bug 105651)
  $<$<CXX_COMPILER_ID:Clang>:-Wno-bitwise-instead-of-logical>  # & saves a branch in kernels
  $<$<BOOL:${RAYLOOM_WARNINGS_AS_ERRORS}>:-Werror>)

if(RAYLOOM_SANITIZE)
  add_compile_options(-fsanitize=${RAYLOOM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${RAYLOOM_SANITIZE})
  if(RAYLOOM_SANITIZE MATCHES undefined)
    # Checks before every access that AddressSanitizer makes itself or that need types at run time; a tenth of the build.
    add_compile_options(-fno-sanitize=null,object-size,vptr)
  endif()
endif()

if(RAYLOOM_LINKER)
  add_link_options(-fuse-ld=${RAYLOOM_LINKER})
endif()

set(rayloom_installed_libraries base accel runtime hwmodel scenes shaders)

# rayloom_library(<name> SOURCES ... PUBLIC <targets> PRIVATE <targets>): the static library rayloom::<name>. Those of the
# six folders are installed with all their headers; anything else (what tools share) stays in the build tree.
function(rayloom_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(rayloom_${name} STATIC ${arg_SOURCES})
  add_library(rayloom::${name} ALIAS rayloom_${name})
  set_target_properties(rayloom_${name} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(rayloom_${name} PUBLIC rayloom_options ${arg_PUBLIC} PRIVATE $<BUILD_INTERFACE:rayloom_warnings> ${arg_PRIVATE})
  if(name IN_LIST rayloom_installed_libraries)
    install(TARGETS rayloom_${name} EXPORT rayloom ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rayloom/${name}
      FILES_MATCHING PATTERN "*.h")
  endif()
endfunction()

# rayloom_parses_options(<sources>): sources of the calling directory that include CLI11, which is header only. Optimising
# it took a tenth of a build; nothing in these files is hot.
function(rayloom_parses_options)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O0)
endfunction()

# The targets tests_<label> build every test program of a label, and nothing else; tests_libraries the unit and oracle
# tests of the six folders, not those of tools, which have the label tools besides.
foreach(label unit oracle image slow tsan_smoke fuzz libraries)
  add_custom_target(tests_${label})
endforeach()

function(rayloom_label_test name)
  set(labels ${ARGN})
  if(CMAKE_CURRENT_SOURCE_DIR MATCHES "/tests/(tools|numerics)")
    list(APPEND labels tools)
  elseif("unit" IN_LIST labels OR "oracle" IN_LIST labels)
    list(APPEND labels libraries)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${labels}")
  foreach(label IN LISTS labels)
    if(TARGET tests_${label} AND TARGET ${name})
      add_dependencies(tests_${label} ${name})
    endif()
  endforeach()
endfunction()

# A test's own code is compiled for more time than it runs; what it tests is in libraries.
set(rayloom_test_optimisation $<$<CONFIG:Release>:-O1>)

# rayloom_test(<name> SOURCES ... LINK <targets> LABELS ... COST <seconds>): a Catch2 program, one ctest case a program.
# Labels: unit (the default), oracle, image, slow, tsan_smoke, fuzz. Tests of the highest cost begin first.
function(rayloom_test name)
  cmake_parse_arguments(arg "" "COST" "SOURCES;LINK;LABELS" ${ARGN})
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE rayloom_options rayloom_warnings ${arg_LINK} rayloom_test_main)
  target_compile_options(${name} PRIVATE ${rayloom_test_optimisation})
  if(RAYLOOM_PRECOMPILE_TESTS)
    target_precompile_headers(${name} REUSE_FROM rayloom_test_header)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  rayloom_label_test(${name} ${arg_LABELS})
  set_tests_properties(${name} PROPERTIES ENVIRONMENT UBSAN_OPTIONS=print_stacktrace=1)
  if(arg_COST)
    set_tests_properties(${name} PROPERTIES COST ${arg_COST})
  endif()
endfunction()

# rayloom_fuzzer(<name> SOURCES ... LINK <targets> CORPUS <directory>): a libFuzzer program (preset fuzz), started from a
# seed corpus, for a minute a run; what it finds stays in the build directory.
function(rayloom_fuzzer name)
  if(NOT RAYLOOM_SANITIZE MATCHES fuzzer)
    return()
  endif()
  cmake_parse_arguments(arg "" "CORPUS" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE rayloom_options rayloom_warnings ${arg_LINK} -fsanitize=fuzzer)
  set(found ${CMAKE_CURRENT_BINARY_DIR}/${name}_found)
  file(MAKE_DIRECTORY ${found})
  add_test(NAME ${name}
    COMMAND ${name} -max_total_time=60 -timeout=20 -artifact_prefix=${found}/ ${found} ${arg_CORPUS})
  rayloom_label_test(${name} fuzz)
endfunction()
