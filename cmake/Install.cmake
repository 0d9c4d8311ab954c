# Install rules: the library, its public headers, the command, find_package(pellucid) and pkg-config.
include(CMakePackageConfigHelpers)
install(TARGETS pellucid EXPORT pellucidTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/host/include/pellucid DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# The device functions that a renderer may include in its own kernels.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/kernels/lib ${PROJECT_SOURCE_DIR}/kernels/shared
        DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid/kernels)
if(TARGET pellucid_cli)
  set_target_properties(pellucid_cli PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(TARGETS pellucid_cli)
endif()
install(EXPORT pellucidTargets NAMESPACE pellucid:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellucid)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake COMPATIBILITY SameMinorVersion)
file(WRITE ${PROJECT_BINARY_DIR}/pellucidConfig.cmake "include(\${CMAKE_CURRENT_LIST_DIR}/pellucidTargets.cmake)
# The folder that a renderer's own OpenCL kernels include \"lib/...\" from.
get_filename_component(pellucid_KERNELS \"\${CMAKE_CURRENT_LIST_DIR}/../../../${CMAKE_INSTALL_DATADIR}/pellucid/kernels\" ABSOLUTE)\n")
install(FILES ${PROJECT_BINARY_DIR}/pellucidConfig.cmake ${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellucid)
configure_file(${PROJECT_SOURCE_DIR}/cmake/pellucid.pc.in ${PROJECT_BINARY_DIR}/pellucid.pc.in @ONLY)
# The prefix is known at install time only.
install(CODE "
  set(prefix \"\${CMAKE_INSTALL_PREFIX}\")
  configure_file(\"${PROJECT_BINARY_DIR}/pellucid.pc.in\" \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/pkgconfig/pellucid.pc\")")
