# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# The target `docs`: the API reference, in docs/html of the build folder, from what a program that feeds the odometry
# includes. A warning is an error. Comments say what names do not, so that not everything has one.
if(EDGED_TESTS)
  find_package(Doxygen 1.9 REQUIRED)
else()
  find_package(Doxygen 1.9)
endif()
if(NOT DOXYGEN_FOUND)
  return()
endif()
set(DOXYGEN_PROJECT_NAME "Edged USLAM")
set(DOXYGEN_PROJECT_BRIEF "visual-inertial odometry from events, frames and an IMU")
set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/docs)
set(DOXYGEN_STRIP_FROM_PATH ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include ${PROJECT_SOURCE_DIR}/src)
set(DOXYGEN_FILE_PATTERNS *.hpp)
set(DOXYGEN_EXTRACT_ALL YES)
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
set(DOXYGEN_QUIET YES)
set(DOXYGEN_HAVE_DOT NO)
# What the public headers lean on.
set(documented core/config.hpp core/timing.hpp depth/depth_config.hpp estimator/estimator_config.hpp
               estimator/region_depth.hpp events/events_config.hpp frontend/frontend_config.hpp frontend/track.hpp
               pipeline/counters.hpp)
list(TRANSFORM documented PREPEND ${PROJECT_SOURCE_DIR}/src/edged/)
doxygen_add_docs(docs ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include ${documented})
if(EDGED_TESTS)
  add_test(NAME reference COMMAND Doxygen::doxygen ${CMAKE_CURRENT_BINARY_DIR}/Doxyfile.docs)
endif()
