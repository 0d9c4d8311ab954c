# Turns every file under kernels/ into bytes inside the library, so that nothing is read at run time.
# pellucid_embed_kernels(OUT_CPP) defines: pel::cl::kernelFiles() (name, text).
function(pellucid_embed_kernels out_cpp)
  file(GLOB_RECURSE kernel_files CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/kernels
       ${PROJECT_SOURCE_DIR}/kernels/*.cl ${PROJECT_SOURCE_DIR}/kernels/*.clh ${PROJECT_SOURCE_DIR}/kernels/shared/*.h)
  list(SORT kernel_files)
  set(absolute "")
  foreach(f ${kernel_files})
    list(APPEND absolute ${PROJECT_SOURCE_DIR}/kernels/${f})
  endforeach()
  add_custom_command(
    OUTPUT ${out_cpp}
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR}/kernels "-DFILES=${kernel_files}" -DOUT=${out_cpp}
            -P ${PROJECT_SOURCE_DIR}/cmake/EmbedKernelsScript.cmake
    DEPENDS ${absolute} ${PROJECT_SOURCE_DIR}/cmake/EmbedKernelsScript.cmake
    COMMENT "Embedding kernels" VERBATIM)
endfunction()
