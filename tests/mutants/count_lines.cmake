# Included by the build of run.py: what is not a test counts how often each of its lines runs.
function(count_lines)
  foreach(target pellucid pellucid_batch pellucid_bc6h pellucid_io pellucid_sample pellucid_cli)
    if(TARGET ${target})
      target_compile_options(${target} PRIVATE --coverage -fprofile-update=atomic -fprofile-exclude-files=/usr/.*)
    endif()
  endforeach()
endfunction()
cmake_language(DEFER DIRECTORY ${CMAKE_SOURCE_DIR} CALL count_lines)
