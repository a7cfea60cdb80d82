# SPDX-License-Identifier: BSD-3-Clause
# find_package(cellist COMPONENTS sort) and its version file; uninstall.
include(CMakePackageConfigHelpers)

get_property(CELLIST_INSTALLED_MODULES GLOBAL PROPERTY CELLIST_INSTALLED_MODULES)
set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/cellist)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/cellist-config.cmake.in ${PROJECT_BINARY_DIR}/cellist-config.cmake
  INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/cellist-config-version.cmake COMPATIBILITY SameMinorVersion)
get_property(dependencies GLOBAL PROPERTY CELLIST_STATIC_DEPENDENCIES)
list(REMOVE_DUPLICATES dependencies)
list(JOIN dependencies "\n" dependencies)
file(WRITE ${PROJECT_BINARY_DIR}/cellist-dependencies.cmake "${dependencies}\n")
install(FILES ${PROJECT_BINARY_DIR}/cellist-dependencies.cmake ${PROJECT_BINARY_DIR}/cellist-config.cmake ${PROJECT_BINARY_DIR}/cellist-config-version.cmake
  DESTINATION ${config_folder})
install(EXPORT cellist-targets NAMESPACE cellist:: DESTINATION ${config_folder})

if(PROJECT_IS_TOP_LEVEL)
  add_custom_target(uninstall COMMAND xargs rm -fv < ${PROJECT_BINARY_DIR}/install_manifest.txt VERBATIM
    COMMENT "Removing what the last install put in place")
endif()
