# Debian packages by CPack, one for each component of the installation (./run deb; cmake -DPELLUCID_DEBIAN=ON):
#   libpellucid0  libpellucid-dev  pellucid (command)  python3-pellucid  pellucid-doc
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pellucid)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each has its own
set(CPACK_PACKAGE_VENDOR Pellucid)
set(CPACK_PACKAGE_CONTACT "Pellucid maintainers <maintainers@pellucid.invalid>")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL library development command python documentation)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})  # the library of this build, which no package has yet
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# package COMPONENT NAME SECTION "SUMMARY" "DEPENDS" "DESCRIPTION"
macro(package component name section summary depends description)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${description}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  install(FILES ${PROJECT_BINARY_DIR}/debian/changelog.Debian.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/debian/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endmacro()

set(same "(= ${PROJECT_VERSION}-1)")
set(about "Pellucid shades skin, wax, jade and other translucent materials in a\nrenderer's G-buffer, by OpenCL kernels.\n.\n")
package(library libpellucid0 libs "subsurface scattering for deferred renderers" "" "${about}This is the shared library.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/library/triggers)
package(development libpellucid-dev libdevel "subsurface scattering for deferred renderers (headers)" "libpellucid0 ${same}"
        "${about}This has the headers for C and C++, the kernels' functions for kernels\nof one's own, and files for CMake and pkg-config.")
package(command pellucid graphics "subsurface scattering for deferred renderers (command)" "libpellucid0 ${same}"
        "${about}This is the command pellucid: look-up tables, curvature of meshes,\nshading of OpenEXR G-buffers, a demo and measurements.")
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS "python3-pellucid, pellucid-doc")
package(python python3-pellucid python "subsurface scattering for deferred renderers (Python 3)" "libpellucid0 ${same}, python3 (>= 3.11), python3 (<< 3.12), python3-numpy"
        "${about}This is the package for Python, with the viewer.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "pellucid")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-tqdm")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/python/postinst ${PROJECT_SOURCE_DIR}/packaging/debian/python/prerm)
package(documentation pellucid-doc doc "subsurface scattering for deferred renderers (guides, examples)" "" "${about}These are the guides, the mathematics and the examples.")
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)

# Debian's changelog has the packages' own history: one entry for each version.
file(WRITE ${PROJECT_BINARY_DIR}/debian/changelog.Debian
"pellucid (${PROJECT_VERSION}-1) unstable; urgency=medium

  * Packages of this version; CHANGELOG.md of pellucid-doc says what it does.

 -- ${CPACK_PACKAGE_CONTACT}  Thu, 01 Jan 2026 00:00:00 +0000
")
execute_process(COMMAND gzip -9nkf ${PROJECT_BINARY_DIR}/debian/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
include(CPack)
