# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
include(GNUInstallDirs)
# A program in bin/ finds rigs and networks as it does once installed.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/config ${PROJECT_BINARY_DIR}/share/edged SYMBOLIC)

# Options of every target of ours, and of ours alone. No -march and no fused multiply-add: the same bits on every
# machine. What -fPIC keeps from being inlined, may be; nothing reads errno or traps of floating-point functions: 2 to 6 %
# of the processor time, at the same bits.
add_library(edged_options INTERFACE)
target_compile_options(edged_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off
                                               -fno-semantic-interposition -fno-math-errno -fno-trapping-math
                                               -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
  target_compile_options(edged_options INTERFACE -Wno-dangling-reference)  # false where an argument is a temporary
endif()
if(EDGED_WERROR)
  target_compile_options(edged_options INTERFACE -Werror)
endif()
if(EDGED_SANITIZE)
  target_compile_options(edged_options INTERFACE -fsanitize=${EDGED_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
  target_link_options(edged_options INTERFACE -fsanitize=${EDGED_SANITIZE})
  if(EDGED_SANITIZE MATCHES "undefined")
    # A third of the compile time. The address sanitizer finds what these do (and no class here is cast without RTTI).
    target_compile_options(edged_options INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
  # Memory that Eigen's code in libraries took is freed by ours: both must take it from malloc as it is.
  target_compile_definitions(edged_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

# Headers of others that most sources include: read once, not hundreds of times (compilers' caches want
# CMAKE_DISABLE_PRECOMPILE_HEADERS=ON). A source includes what it uses all the same: clang-tidy goes without.
set(EDGED_PRECOMPILED <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory>
                      <optional> <set> <span> <string> <string_view> <tuple> <utility> <variant> <vector> <Eigen/Dense>
                      <opencv2/core.hpp> <spdlog/fmt/fmt.h>)
# edged_precompile(NAME POSITION_INDEPENDENT DEPENDS libs ... HEADERS headers ...): for REUSE_FROM, by targets that are
# compiled with the same options.
function(edged_precompile NAME POSITION_INDEPENDENT)
  cmake_parse_arguments(ARG "" "" "DEPENDS;HEADERS" ${ARGN})
  add_library(${NAME} OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
  target_link_libraries(${NAME} PRIVATE edged_options Eigen3::Eigen opencv_core spdlog::spdlog ${ARG_DEPENDS})
  target_precompile_headers(${NAME} PRIVATE ${EDGED_PRECOMPILED} ${ARG_HEADERS})
  set_target_properties(${NAME} PROPERTIES POSITION_INDEPENDENT_CODE ${POSITION_INDEPENDENT})
endfunction()
edged_precompile(edged_precompiled ON)
if(EDGED_TESTS)
  edged_precompile(edged_precompiled_tests OFF DEPENDS GTest::gtest_main GTest::gmock HEADERS <gmock/gmock.h> <gtest/gtest.h>)
endif()

# edged_module(NAME SOURCES a.cpp ... DEPENDS libs ... TESTS a_test.cpp ... TEST_DEPENDS libs ... TEST_SHARDS number)
# makes the library edged_NAME (alias edged::NAME), a part of EDGED_COMPONENT, and the test program edged_NAME_test. Its
# folder is <root>/edged/NAME, and <root> is where it is included from.
function(edged_module NAME)
  cmake_parse_arguments(ARG "" "TEST_SHARDS" "SOURCES;DEPENDS;TESTS;TEST_DEPENDS" ${ARGN})
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR PARENT_PATH root)
  cmake_path(GET root PARENT_PATH root)
  add_library(edged_${NAME} STATIC ${ARG_SOURCES})
  add_library(edged::${NAME} ALIAS edged_${NAME})
  target_compile_features(edged_${NAME} PUBLIC cxx_std_20)
  target_include_directories(edged_${NAME} PUBLIC $<BUILD_INTERFACE:${root}>
                                                  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(edged_${NAME} PUBLIC ${ARG_DEPENDS} PRIVATE $<BUILD_INTERFACE:edged_options>)
  target_precompile_headers(edged_${NAME} REUSE_FROM edged_precompiled)
  edged_export(edged_${NAME} ${NAME})
  if(EDGED_TESTS AND ARG_TESTS)
    edged_test(edged_${NAME}_test SOURCES ${ARG_TESTS} DEPENDS edged::${NAME} ${ARG_TEST_DEPENDS} SHARDS ${ARG_TEST_SHARDS})
  endif()
endfunction()

# edged_component(modules ...): all that EDGED_COMPONENT is, in the one library edged::EDGED_COMPONENT.
function(edged_component)
  set(target edged_component_${EDGED_COMPONENT})
  add_library(${target} INTERFACE)
  add_library(edged::${EDGED_COMPONENT} ALIAS ${target})
  list(TRANSFORM ARGN PREPEND edged::)
  target_link_libraries(${target} INTERFACE ${ARGN})
  edged_export(${target} ${EDGED_COMPONENT})
endfunction()

# The target is installed, and found by find_package as edged::NAME.
function(edged_export TARGET NAME)
  set_target_properties(${TARGET} PROPERTIES EXPORT_NAME ${NAME})
  if(EDGED_INSTALL)
    install(TARGETS ${TARGET} EXPORT edged_${EDGED_COMPONENT} ARCHIVE COMPONENT development
            DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endif()
endfunction()

# All test programs without a label: what CI runs under the sanitizers.
if(EDGED_TESTS)
  add_custom_target(edged_short_tests)
endif()

# edged_test(NAME SOURCES ... DEPENDS ... TIMEOUT seconds LABELS label SHARDS number | TOGETHER)
# ctest runs each test of the program by itself. With SHARDS it runs the program that many times with a share of the tests
# each, where a program has many short ones; with TOGETHER once, where its tests share what takes long to make. Under
# sanitizers, which take longer to start, it always does, once without SHARDS (GTEST_FILTER of the presets leaves out of it).
function(edged_test NAME)
  cmake_parse_arguments(ARG "TOGETHER" "TIMEOUT;LABELS;SHARDS" "SOURCES;DEPENDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_executable(${NAME} ${ARG_SOURCES})
  if(NOT ARG_LABELS)
    add_dependencies(edged_short_tests ${NAME})
  endif()
  target_link_libraries(${NAME} PRIVATE edged_options ${ARG_DEPENDS} GTest::gtest_main GTest::gmock)
  target_precompile_headers(${NAME} REUSE_FROM edged_precompiled_tests)
  set_target_properties(${NAME} PROPERTIES POSITION_INDEPENDENT_CODE OFF)  # as the headers were compiled
  target_compile_definitions(
    ${NAME} PRIVATE EDGED_SOURCE_DIR="${PROJECT_SOURCE_DIR}" EDGED_BINARY_DIR="${CMAKE_BINARY_DIR}")
  if(EDGED_SANITIZE)
    set_target_properties(${NAME} PROPERTIES UNITY_BUILD ON)
    set(ARG_TIMEOUT 3600)
  endif()
  if(ARG_SHARDS OR ARG_TOGETHER OR EDGED_SANITIZE)
    edged_test_shards(${NAME} "${ARG_SHARDS}" ${ARG_TIMEOUT} "${ARG_LABELS}")
    return()
  endif()
  set(cost 0)
  if(ARG_LABELS)
    set(cost 100)  # the long ones first, or one of them runs alone in the end
  endif()
  gtest_discover_tests(${NAME} DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT} COST ${cost} LABELS "${ARG_LABELS}")
endfunction()

# The program as a whole is the test NAME, or its shards are NAME_0, NAME_1 ...
function(edged_test_shards NAME SHARDS TIMEOUT LABELS)
  if(NOT SHARDS)
    add_test(NAME ${NAME} COMMAND ${NAME})
    set_tests_properties(${NAME} PROPERTIES TIMEOUT ${TIMEOUT} COST 100 LABELS "${LABELS}")
    return()
  endif()
  math(EXPR last "${SHARDS} - 1")
  foreach(shard RANGE ${last})
    add_test(NAME ${NAME}_${shard} COMMAND ${NAME})
    set_tests_properties(
      ${NAME}_${shard} PROPERTIES TIMEOUT ${TIMEOUT} COST 10 LABELS "${LABELS}" ENVIRONMENT
      "GTEST_TOTAL_SHARDS=${SHARDS};GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()
