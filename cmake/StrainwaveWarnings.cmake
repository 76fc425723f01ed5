# strainwave_strict(target): the warnings of the project's own builds. PRIVATE always, so that
# nothing of it reaches a consumer of strainwave::core. They are errors where the Makefile builds;
# someone who installs the package with a compiler newer than ours is not stopped by its opinions.

option(STRAINWAVE_WERROR "Treat the warnings of the project's own targets as errors" OFF)

function(strainwave_strict target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow)
  if(STRAINWAVE_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 takes the joining of two std::string at -O3 for an overlap (GCC bug 105329).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
endfunction()
