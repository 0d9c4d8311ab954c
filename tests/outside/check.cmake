# Installs the build into a fresh prefix, whose name has a space, and uses it from a project that knows
# nothing else of it, by find_package and by pkg-config; then the examples from there after the tree was
# moved. Arguments: BUILD, SOURCE, WORK, C_FLAGS.
cmake_minimum_required(VERSION 3.20)
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed: ${ARGN}")
  endif()
endfunction()
function(expect file)
  if(NOT EXISTS "${file}")
    message(FATAL_ERROR "${file} is not there")
  endif()
endfunction()
set(prefix "${WORK}/a prefix")
file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${WORK}/build "-DCMAKE_PREFIX_PATH=${prefix}"
    "-DCMAKE_C_FLAGS=${C_FLAGS}" "-DCMAKE_CXX_FLAGS=${C_FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/outside_c)
run(${WORK}/build/outside_cpp)

file(GLOB_RECURSE pc ${prefix}/*/pellucid.pc)
get_filename_component(pc_dir ${pc} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${pc_dir})
execute_process(COMMAND pkg-config --cflags --libs pellucid OUTPUT_VARIABLE flags RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "pkg-config does not know pellucid")
endif()
execute_process(COMMAND pkg-config --variable=kernels pellucid
                OUTPUT_VARIABLE kernels OUTPUT_STRIP_TRAILING_WHITESPACE)
execute_process(COMMAND pkg-config --variable=rpath pellucid
                OUTPUT_VARIABLE rpath OUTPUT_STRIP_TRAILING_WHITESPACE)
string(REPLACE " " "\\ " rpath "${rpath}")  # as a shell would need it
separate_arguments(flags UNIX_COMMAND "${flags} ${rpath} ${C_FLAGS}")
list(APPEND flags "-DKERNELS=\"${kernels}\"")
run(cc -std=c99 -Wall -Wextra -pedantic -Werror ${SOURCE}/main.c -o ${WORK}/outside_pkg_config ${flags})
run(${WORK}/outside_pkg_config)
if(EXISTS ${prefix}/bin/pellucid)
  run(${prefix}/bin/pellucid devices)
endif()

# What a user looks for, and pages whose links hold.
file(GLOB_RECURSE licence ${prefix}/share/doc/pellucid/LICENSE)
expect("${licence}")
expect(${prefix}/share/pellucid/blender/render_gbuffer.py)
file(GLOB_RECURSE pages ${prefix}/share/doc/pellucid/docs/*.md)
foreach(page ${pages})
  get_filename_component(folder ${page} DIRECTORY)
  file(READ ${page} text)
  string(REGEX MATCHALL "\\]\\([^):#]+" links "${text}")
  foreach(link ${links})
    string(SUBSTRING ${link} 2 -1 link)
    # Links into the repository are not installed.
    if(NOT link MATCHES "^https?|^\\.\\./\\.\\./|^\\.\\./(bindings|bench|host|kernels|tests)/")
      expect(${folder}/${link})
    endif()
  endforeach()
endforeach()

# A package is staged somewhere else than where it will be.
set(ENV{DESTDIR} ${WORK}/stage)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix /nowhere/pellucid)
unset(ENV{DESTDIR})
file(GLOB_RECURSE staged ${WORK}/stage/nowhere/pellucid/*/pellucid.pc)
expect("${staged}")
file(STRINGS ${staged} line REGEX "^prefix=/nowhere/pellucid$")
if(NOT line OR EXISTS /nowhere)
  message(FATAL_ERROR "DESTDIR is not where the files went, or pellucid.pc names it")
endif()

# OpenCL's build options cannot quote the folder of a kernel's includes: no space in this one.
file(RENAME ${prefix} ${WORK}/moved)
run(${CMAKE_COMMAND} -G Ninja -S ${WORK}/moved/share/doc/pellucid/examples -B ${WORK}/examples
    "-DCMAKE_PREFIX_PATH=${WORK}/moved" "-DCMAKE_C_FLAGS=${C_FLAGS}" "-DCMAKE_CXX_FLAGS=${C_FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/examples --target example_own_kernel example_progress)
run(${WORK}/examples/example_own_kernel)

# BMP files come from a module beside the library; without it the message names it, and PNG needs none.
set(moved_command ${WORK}/moved/bin/pellucid)
if(EXISTS ${moved_command})
  run(${moved_command} lut specular --size 8x8 -o ${WORK}/table.bmp)
  file(GLOB_RECURSE module ${WORK}/moved/*/pellucid_pictures-*.so)
  expect("${module}")
  file(REMOVE ${module})
  execute_process(COMMAND ${moved_command} lut specular --size 8x8 -o ${WORK}/none.bmp
                  RESULT_VARIABLE result ERROR_VARIABLE said)
  if(NOT result EQUAL 3 OR NOT said MATCHES "none.bmp: needs pellucid_pictures-" OR EXISTS ${WORK}/none.bmp)
    message(FATAL_ERROR "without the module for pictures: ${result}, ${said}")
  endif()
  run(${moved_command} lut specular --size 8x8 -o ${WORK}/table.png)
endif()
