# OpenImageIO's own package, without the include directories it names that do not exist. Debian 12 builds it with OpenCV,
# whose headers nobody needs who only reads and writes images; CMake refuses a target with a missing directory.
block(PROPAGATE OpenImageIO_FOUND OpenImageIO_CONFIG OpenImageIO_VERSION)
  set(CMAKE_MESSAGE_LOG_LEVEL NOTICE)  # Imath reports a Python library Debian does not ship
  find_package(OpenImageIO ${OpenImageIO_FIND_VERSION} CONFIG QUIET)
endblock()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO CONFIG_MODE)

if(OpenImageIO_FOUND)
  foreach(target OpenImageIO::OpenImageIO OpenImageIO::OpenImageIO_Util)
    get_target_property(directories ${target} INTERFACE_INCLUDE_DIRECTORIES)
    set(existing)
    foreach(directory IN LISTS directories)
      if(EXISTS "${directory}")
        list(APPEND existing "${directory}")
      endif()
    endforeach()
    set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${existing}")
  endforeach()
endif()
