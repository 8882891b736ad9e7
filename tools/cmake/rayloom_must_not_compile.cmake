# rayloom_must_not_compile(<name> SOURCE <file> EXPECT <regex> [LINK <targets>] [DEFINES <macros>])
#
# A test that a misuse is refused by the compiler, and for the right reason. The file holds the misuse and its twin, one
# token apart:
#
#   #ifdef CASE_OK
#     return ctx.AcceptHit();
#   #else
#     return;
#   #endif
#
# The twin (compiled with -DCASE_OK) must compile; the case must not, and its diagnostics must match EXPECT. A file that
# holds several cases tells them apart by a macro: DEFINES CASE=3. Dropping a [[nodiscard]] result counts as an error.

set(rayloom_must_not_compile_script ${CMAKE_CURRENT_LIST_DIR}/must_not_compile_test.cmake)

function(rayloom_must_not_compile name)
  cmake_parse_arguments(arg "" "SOURCE;EXPECT" "LINK;DEFINES" ${ARGN})
  get_filename_component(source ${arg_SOURCE} ABSOLUTE)
  # Never built; it collects the flags and include directories a program linking these targets would have.
  add_library(${name}_flags OBJECT EXCLUDE_FROM_ALL ${source})
  target_link_libraries(${name}_flags PRIVATE rayloom_options ${arg_LINK})
  target_compile_definitions(${name}_flags PRIVATE ${arg_DEFINES})
  set(flags ${CMAKE_CURRENT_BINARY_DIR}/${name}.flags)
  set(include_directories $<TARGET_PROPERTY:${name}_flags,INCLUDE_DIRECTORIES>)
  set(definitions $<TARGET_PROPERTY:${name}_flags,COMPILE_DEFINITIONS>)
  set(options $<TARGET_PROPERTY:${name}_flags,COMPILE_OPTIONS>)
  file(GENERATE OUTPUT ${flags} CONTENT "-std=c++20
$<$<BOOL:${include_directories}>:-I$<JOIN:${include_directories},\n-I>>
$<$<BOOL:${definitions}>:-D$<JOIN:${definitions},\n-D>>
$<JOIN:${options},\n>
-Werror=unused-result -Werror=return-type
" TARGET ${name}_flags)
  add_test(NAME ${name} COMMAND ${CMAKE_COMMAND}
    -DCOMPILER=${CMAKE_CXX_COMPILER} -DFLAGS=${flags} -DSOURCE=${source} -DEXPECT=${arg_EXPECT}
    -P ${rayloom_must_not_compile_script})
  set_tests_properties(${name} PROPERTIES LABELS must_not_compile)
endfunction()
