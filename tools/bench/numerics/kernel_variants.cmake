# The triangle test by each compiler at hand, optimisation level and mode of contraction, with fused instructions
# allowed, as programs in bin/numerics_kernels (row K6).
set(variant_directory ${PROJECT_BINARY_DIR}/bin/numerics_kernels)
file(MAKE_DIRECTORY ${variant_directory})
find_program(RAYLOOM_GXX g++)
find_program(RAYLOOM_CLANGXX clang++)
set(variant_programs "")
set(variant_sources ${CMAKE_CURRENT_SOURCE_DIR}/kernel_variant.cpp)
foreach(source triangle exact_triangle refined_triangle prepared_ray)
  list(APPEND variant_sources ${PROJECT_SOURCE_DIR}/accel/${source}.cpp)
endforeach()
set(variant_modes "-O0 off" "-O2 off" "-O3 off" "-O1 fast" "-O2 fast" "-O3 fast" "-O2 on")
if(RAYLOOM_SANITIZE)
  set(variant_modes "-O0 off" "-O1 off" "-O1 fast")  # no sanitizer sees these programs: as many as row K6 asks for
endif()
foreach(compiler RAYLOOM_GXX RAYLOOM_CLANGXX)
  if(NOT ${compiler})
    continue()
  endif()
  cmake_path(GET ${compiler} FILENAME compiler_name)
  foreach(mode IN LISTS variant_modes)
    string(REPLACE " " ";" mode "${mode}")
    list(GET mode 0 level)
    list(GET mode 1 contraction)
    set(program ${variant_directory}/${compiler_name}${level}-contract-${contraction})
    add_custom_command(OUTPUT ${program}
      COMMAND ${RAYLOOM_CCACHE} ${${compiler}} -std=c++20 ${level} -ffp-contract=${contraction} -fno-math-errno
        $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},x86_64>:-mavx2> $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},x86_64>:-mfma>
        -I${PROJECT_BINARY_DIR}/include -o ${program} ${variant_sources}
      DEPENDS ${variant_sources}
      COMMENT "Compiling the triangle test: ${compiler_name} ${level} -ffp-contract=${contraction}"
      VERBATIM COMMAND_EXPAND_LISTS)
    list(APPEND variant_programs ${program})
  endforeach()
endforeach()
add_custom_target(rayloom_kernel_variants DEPENDS ${variant_programs})
