# Compiles for macOS on Apple's own processors by Zig's compiler (PyPI: ziglang), which brings headers and lists of symbols of macOS' C library:
# it tells what compiles and links (docs/guide/install.md). PELLUCID_ZIG is the folder of the programs that
# "packaging/wheel/zig_tools PYTHON FOLDER aarch64-macos.11.0" makes.
set(CMAKE_SYSTEM_NAME Darwin)
set(CMAKE_SYSTEM_PROCESSOR arm64)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PELLUCID_ZIG)
if(NOT PELLUCID_ZIG)
  set(PELLUCID_ZIG $ENV{PELLUCID_ZIG})
endif()
set(CMAKE_C_COMPILER ${PELLUCID_ZIG}/cc)
set(CMAKE_CXX_COMPILER ${PELLUCID_ZIG}/c++)
set(CMAKE_AR ${PELLUCID_ZIG}/ar)
set(CMAKE_RANLIB ${PELLUCID_ZIG}/ranlib)
set(CMAKE_INSTALL_NAME_TOOL true)  # names of folders are right from the beginning
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
set(CMAKE_OSX_ARCHITECTURES "")
set(CMAKE_OSX_SYSROOT "")
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
