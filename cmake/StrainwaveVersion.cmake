# Sets STRAINWAVE_VERSION from pyproject.toml, the one place where the version is written.

if(SKBUILD_PROJECT_VERSION)
  set(STRAINWAVE_VERSION "${SKBUILD_PROJECT_VERSION}")
else()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
               "${CMAKE_CURRENT_LIST_DIR}/../pyproject.toml")
  file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../pyproject.toml" _version_line
       REGEX "^version = \"[0-9]+\\.[0-9]+\\.[0-9]+\"$" LIMIT_COUNT 1)
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" STRAINWAVE_VERSION "${_version_line}")
  if(NOT STRAINWAVE_VERSION)
    message(FATAL_ERROR "pyproject.toml has no line of the form: version = \"1.2.3\"")
  endif()
endif()
