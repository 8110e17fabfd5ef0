# SPDX-License-Identifier: Apache-2.0
# `cmake --install` puts the library, its three headers and a package file for find_package(noli).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(noli_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/noli)
set(noli_exported noli)
if(TARGET noli_cholmod)
  set_target_properties(noli_cholmod PROPERTIES EXPORT_NAME cholmod)
  list(APPEND noli_exported noli_cholmod)
endif()
install(TARGETS ${noli_exported} EXPORT noli_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/noli DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT noli_targets NAMESPACE noli:: DESTINATION ${noli_package_dir})
configure_package_config_file(cmake/noli-config.cmake.in ${PROJECT_BINARY_DIR}/noli-config.cmake
  INSTALL_DESTINATION ${noli_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/noli-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/noli-config.cmake ${PROJECT_BINARY_DIR}/noli-config-version.cmake
  DESTINATION ${noli_package_dir})
