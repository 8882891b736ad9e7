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

add_library(rayloom_options INTERFACE)
add_library(rayloom::options ALIAS rayloom_options)
target_include_directories(rayloom_options INTERFACE $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>)
target_compile_features(rayloom_options INTERFACE cxx_std_20)
# Contraction off: a multiply-add the source does not ask for would give other bits on another target (docs/numerics.md).
target_compile_options(rayloom_options INTERFACE -ffp-contract=off -fno-math-errno)

add_library(rayloom_warnings INTERFACE)
target_compile_options(rayloom_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion -Wno-sign-conversion -Wold-style-cast
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # false alarms on std::string's operator+ (GCC bug 105651)
  $<$<BOOL:${RAYLOOM_WARNINGS_AS_ERRORS}>:-Werror>)

if(RAYLOOM_SANITIZE)
  add_compile_options(-fsanitize=${RAYLOOM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${RAYLOOM_SANITIZE})
endif()

# rayloom_library(<name> SOURCES ... PUBLIC <targets> PRIVATE <targets>): the static library rayloom::<name>.
function(rayloom_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(rayloom_${name} STATIC ${arg_SOURCES})
  add_library(rayloom::${name} ALIAS rayloom_${name})
  set_target_properties(rayloom_${name} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(rayloom_${name} PUBLIC rayloom_options ${arg_PUBLIC} PRIVATE $<BUILD_INTERFACE:rayloom_warnings> ${arg_PRIVATE})
endfunction()

# rayloom_test(<name> SOURCES ... LINK <targets> LABELS ...): a Catch2 program, one ctest case a program.
function(rayloom_test name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE rayloom_options rayloom_warnings ${arg_LINK} rayloom_test_main)
  add_test(NAME ${name} COMMAND ${name})
  if(arg_LABELS)
    set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}")
  endif()
endfunction()
