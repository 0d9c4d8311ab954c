# Install rules: the library, its two public headers and find_package(pellucid).
include(CMakePackageConfigHelpers)
install(TARGETS pellucid EXPORT pellucidTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/host/include/pellucid DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TARGET pellucid_cli)
  install(TARGETS pellucid_cli)
endif()
install(EXPORT pellucidTargets NAMESPACE pellucid:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellucid)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/pellucidConfigVersion.cmake COMPATIBILITY SameMinorVersion)
file(WRITE ${CMAKE_BINARY_DIR}/pellucidConfig.cmake
     "include(\${CMAKE_CURRENT_LIST_DIR}/pellucidTargets.cmake)\n")
install(FILES ${CMAKE_BINARY_DIR}/pellucidConfig.cmake ${CMAKE_BINARY_DIR}/pellucidConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellucid)
# Installed next to each other in <prefix>/bin and <prefix>/lib.
