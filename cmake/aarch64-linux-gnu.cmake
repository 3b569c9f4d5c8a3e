# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
# Toolchain for 64-bit ARM with Debian's g++-aarch64-linux-gnu. EDGED_SYSROOT names a folder with the libraries of an
# arm64 Debian 12:
#   cmake --toolchain cmake/aarch64-linux-gnu.cmake -DEDGED_SYSROOT=/path -DEDGED_PYTHON=OFF -DEDGED_TESTS=OFF ...
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
# Also of the small projects by which CMake tries the compiler.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES EDGED_SYSROOT)
if(NOT IS_DIRECTORY "${EDGED_SYSROOT}/usr/lib/aarch64-linux-gnu")
  message(FATAL_ERROR "EDGED_SYSROOT='${EDGED_SYSROOT}' holds no usr/lib/aarch64-linux-gnu: name the root of an arm64 Debian")
endif()
set(CMAKE_SYSROOT ${EDGED_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${EDGED_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${EDGED_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${EDGED_SYSROOT}/usr/share/pkgconfig)
