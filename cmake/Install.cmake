# Install rules: the library, its public headers, the command, find_package(pellucid) and pkg-config, and what a user reads
# and starts from: documentation, licence, examples, the Blender script.
include(CMakePackageConfigHelpers)
install(TARGETS pellucid EXPORT pellucidTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/host/include/pellucid DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# The device functions that a renderer may include in its own kernels.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/kernels/lib ${PROJECT_SOURCE_DIR}/kernels/shared
        DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid/kernels)
if(TARGET pellucid_cli AND NOT PELLUCID_PYTHON)  # the package has a place of its own for it
  set_target_properties(pellucid_cli PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(TARGETS pellucid_cli)
  install(TARGETS pellucid_pictures LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  # Manual pages and completions, made from the command that was built; a command for another machine cannot be asked.
  find_package(Python3 COMPONENTS Interpreter)
  if(Python3_FOUND AND NOT CMAKE_CROSSCOMPILING)
    set(pages ${PROJECT_BINARY_DIR}/command_pages)
    add_custom_command(OUTPUT ${pages}/share/man/man1/pellucid.1
                       COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/packaging/command_pages $<TARGET_FILE:pellucid_cli> --install ${pages}
                       DEPENDS pellucid_cli ${PROJECT_SOURCE_DIR}/packaging/command_pages COMMENT "Manual pages and completions")
    add_custom_target(command_pages ALL DEPENDS ${pages}/share/man/man1/pellucid.1)
    install(DIRECTORY ${pages}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR})
  endif()
endif()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pellucid)
install(EXPORT pellucidTargets NAMESPACE pellucid:: DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake COMPATIBILITY SameMinorVersion)
set(kernels ${CMAKE_INSTALL_DATADIR}/pellucid/kernels)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/pellucidConfig.cmake.in ${PROJECT_BINARY_DIR}/pellucidConfig.cmake
                              INSTALL_DESTINATION ${package_dir} PATH_VARS kernels)
install(FILES ${PROJECT_BINARY_DIR}/pellucidConfig.cmake ${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake DESTINATION ${package_dir})

foreach(dir includedir libdir datadir)
  string(TOUPPER ${dir} upper)
  if(IS_ABSOLUTE ${CMAKE_INSTALL_${upper}})
    set(${dir}_for_pc ${CMAKE_INSTALL_${upper}})
  else()
    set(${dir}_for_pc "\${prefix}/${CMAKE_INSTALL_${upper}}")
  endif()
endforeach()
set(pc ${PROJECT_BINARY_DIR}/pellucid.pc)
configure_file(${PROJECT_SOURCE_DIR}/cmake/pellucid.pc.in ${pc}.in @ONLY)
# The prefix is known at install time only.
install(CODE "
  file(READ \"${pc}.in\" text)
  string(REPLACE \"prefix=\\\${prefix}\" \"prefix=\${CMAKE_INSTALL_PREFIX}\" text \"\${text}\")
  file(WRITE \"${pc}\" \"\${text}\")")
install(FILES ${pc} DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# As in the repository, so that the pages' links to each other hold.
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/LICENSE
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/bindings/blender DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid
        PATTERN "__pycache__" EXCLUDE)
# What the demo shows.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/heads DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid)
