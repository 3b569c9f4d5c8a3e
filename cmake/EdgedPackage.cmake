# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# cpack -G DEB: the packages `edged`, `libedged-dev` and `python3-edged`, a component of the installation each (docs/packages.md). A
# further one needs its component in CPACK_COMPONENTS_ALL, its name, its dependencies and its documents.
set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
if(EDGED_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME edged)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libedged-dev)
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-edged)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Where the build was configured for: the library looks for rigs and networks there. /usr in the preset `package`.
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PACKAGE_CONTACT "Edged USLAM developers")

set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "visual-inertial odometry from events, frames and an IMU
Says where a head of event camera, standard camera and IMU is and how it
moved, from recordings of many formats: ROS bags, HDF5, Prophesee RAW, AEDAT4,
text folders. Brings calibrations of public data sets, a simulator, networks
for the depth of a scene, and tools that judge recordings and trajectories.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# What EdgedDependencies.cmake and EdgedToolboxDependencies.cmake find; scripts/test_packages.sh would miss one.
set(dependencies
    edged # its rigs and networks
    libeigen3-dev libopencv-dev libceres-dev libopengv-dev libyaml-cpp-dev libspdlog-dev nlohmann-json3-dev
    pkg-config libbz2-dev zlib1g-dev liblz4-dev libzstd-dev libsqlite3-dev libtinyxml2-dev libzip-dev libhdf5-dev
    libblosc-dev liblzf-dev liboctomap-dev libpng-dev libturbojpeg0-dev)
list(JOIN dependencies ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "visual-inertial odometry from events, frames and an IMU (development)
Static libraries, headers and a CMake package: the odometry for programs that
bring their own sensors (edged::edged), and the readers, the simulator and the
evaluation of the program edged (edged::toolbox).")

set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
# The module is for one Python: its name holds the version.
math(EXPR next_minor "0${Python3_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python3_VERSION_MINOR}~), python3 (<< 3.${next_minor}~), python3-numpy, edged")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/python/postinst
                                              ${PROJECT_SOURCE_DIR}/packaging/python/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "visual-inertial odometry from events, frames and an IMU (Python 3)
The module edged: measurements go in as numpy arrays, poses with covariances,
tracks, landmarks and images come out; also the readers, the simulator and the
evaluation of the program edged.")

add_custom_command(
  OUTPUT changelog.gz
  COMMAND gzip -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md > changelog.gz
  DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  VERBATIM)
add_custom_target(edged_changelog DEPENDS changelog.gz)
add_dependencies(edged edged_changelog)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/copyright ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME} COMPONENT ${component})
endforeach()
include(CPack)
