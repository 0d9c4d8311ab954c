# Install rules: the library, its public headers, the command, find_package(pellucid) and pkg-config, and what a user reads
# and starts from: documentation, licence, examples, the Blender script. Components: library, development, command, documentation
# (and python, of bindings/python).
include(CMakePackageConfigHelpers)
install(TARGETS pellucid EXPORT pellucidTargets COMPONENT library
        LIBRARY NAMELINK_COMPONENT development
        ARCHIVE COMPONENT development)
if(TARGET pellucid_build AND NOT SKBUILD)
  install(TARGETS pellucid_build RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/pellucid COMPONENT library)
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/host/include/pellucid DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
# The device functions that a renderer may include in its own kernels.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/kernels/lib ${PROJECT_SOURCE_DIR}/kernels/shared
        DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid/kernels COMPONENT development)
if(TARGET pellucid_cli AND NOT SKBUILD)  # a wheel has a place of its own for it
  set_target_properties(pellucid_cli PROPERTIES INSTALL_RPATH "${PELLUCID_ORIGIN}/../${CMAKE_INSTALL_LIBDIR}")
  install(TARGETS pellucid_cli COMPONENT command)
  foreach(module pellucid_capture pellucid_pictures pellucid_measurements)
    if(TARGET ${module})
      install(TARGETS ${module} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/pellucid COMPONENT command)
    endif()
  endforeach()
  # Manual pages and completions, made from the command that was built; a command for another machine cannot be asked.
  find_package(Python3 COMPONENTS Interpreter)
  if(Python3_FOUND AND NOT CMAKE_CROSSCOMPILING)
    set(pages ${PROJECT_BINARY_DIR}/command_pages)
    set(first ${pages}/share/man/man1/pellucid.1)
    set(as_debian true)
    if(PELLUCID_DEBIAN)
      set(first ${first}.gz)
      set(as_debian sh -c "gzip -9nf ${pages}/share/man/man1/*.1 && rm -rf ${pages}/share/zsh/vendor-completions && mv ${pages}/share/zsh/site-functions ${pages}/share/zsh/vendor-completions")
    endif()
    add_custom_command(OUTPUT ${first}
                       COMMAND ${CMAKE_COMMAND} -E rm -rf ${pages}/share  # no pages of commands that are no more
                       COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/packaging/command_pages $<TARGET_FILE:pellucid_cli> --install ${pages}
                       COMMAND ${as_debian}
                       DEPENDS pellucid_cli ${PROJECT_SOURCE_DIR}/packaging/command_pages COMMENT "Manual pages and completions" VERBATIM)
    add_custom_target(command_pages ALL DEPENDS ${first})
    install(DIRECTORY ${pages}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT command)
  endif()
endif()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pellucid)
install(EXPORT pellucidTargets NAMESPACE pellucid:: DESTINATION ${package_dir} COMPONENT development)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake COMPATIBILITY SameMinorVersion)
set(kernels ${CMAKE_INSTALL_DATADIR}/pellucid/kernels)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/pellucidConfig.cmake.in ${PROJECT_BINARY_DIR}/pellucidConfig.cmake
                              INSTALL_DESTINATION ${package_dir} PATH_VARS kernels)
install(FILES ${PROJECT_BINARY_DIR}/pellucidConfig.cmake ${PROJECT_BINARY_DIR}/pellucidConfigVersion.cmake DESTINATION ${package_dir} COMPONENT development)

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
  file(WRITE \"${pc}\" \"\${text}\")" COMPONENT development)
install(FILES ${pc} DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# As in the repository, so that the pages' links to each other hold.
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/LICENSE
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation
        PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/apps/blender DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid COMPONENT command
        PATTERN "__pycache__" EXCLUDE PATTERN "tests" EXCLUDE)
# What the demo shows, and what the benchmark compares with.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/heads ${PROJECT_SOURCE_DIR}/data/bench DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid COMPONENT command)
install(FILES ${PROJECT_SOURCE_DIR}/kernels/lib/shading/poisson_disk.clh DESTINATION ${CMAKE_INSTALL_DATADIR}/pellucid/bench COMPONENT command)

# The viewer among a desktop's programs.
if(PELLUCID_DEBIAN)
  set(desktop ${PROJECT_SOURCE_DIR}/packaging/desktop/org.pellucid.Viewer)
  install(FILES ${desktop}.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT python)
  install(FILES ${desktop}.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT python)
  install(FILES ${desktop}.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT python)
  include(cmake/Debian.cmake)
endif()
