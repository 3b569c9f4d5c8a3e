# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# cmake --install: the program, what it reads when it runs, and what others need to link the library. The tree may be
# moved afterwards.
include(CMakePackageConfigHelpers)

if(EDGED_APPS)
  install(TARGETS edged RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
endif()
set(public_headers ${PROJECT_SOURCE_DIR}/include/ ${PROJECT_BINARY_DIR}/include/)
if(EDGED_TOOLBOX)
  list(APPEND public_headers ${PROJECT_SOURCE_DIR}/toolbox/include/)
endif()
install(DIRECTORY ${public_headers}
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN "*.hpp")
foreach(kind rigs presets foxglove)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/config/${kind} DESTINATION ${CMAKE_INSTALL_DATADIR}/edged COMPONENT program)
endforeach()
if(EDGED_DEPTH_NETWORK)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/config/depth DESTINATION ${CMAKE_INSTALL_DATADIR}/edged COMPONENT program)
endif()

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/edged)
install(EXPORT edged_edged NAMESPACE edged:: FILE edgedTargets.cmake DESTINATION ${package_folder}
        COMPONENT development)
set(package_files EdgedDependencies.cmake)
if(EDGED_TOOLBOX)
  install(EXPORT edged_toolbox NAMESPACE edged:: FILE edgedToolboxTargets.cmake DESTINATION ${package_folder}
          COMPONENT development)
  list(APPEND package_files EdgedToolboxDependencies.cmake)
endif()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/edgedConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/edgedConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/edgedConfigVersion.cmake COMPATIBILITY SameMinorVersion)
list(TRANSFORM package_files PREPEND ${PROJECT_SOURCE_DIR}/cmake/)
install(FILES ${package_files} ${PROJECT_BINARY_DIR}/edgedConfig.cmake ${PROJECT_BINARY_DIR}/edgedConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT development)
