# find_package(rayloom CONFIG): the targets of rayloom_library, and the modules their dependencies need.
include(CMakePackageConfigHelpers)
set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/rayloom)

configure_package_config_file(tools/cmake/rayloomConfig.cmake.in rayloomConfig.cmake
  INSTALL_DESTINATION ${package_directory})
write_basic_package_version_file(rayloomConfigVersion.cmake COMPATIBILITY SameMinorVersion)

install(EXPORT rayloom NAMESPACE rayloom:: FILE rayloomTargets.cmake DESTINATION ${package_directory})
install(FILES
  ${PROJECT_BINARY_DIR}/rayloomConfig.cmake ${PROJECT_BINARY_DIR}/rayloomConfigVersion.cmake
  tools/cmake/FindSLEEF.cmake tools/cmake/FindOpenImageIO.cmake
  DESTINATION ${package_directory})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
