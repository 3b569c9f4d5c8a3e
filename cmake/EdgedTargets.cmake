# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

# Options of every target of ours. No -march and no fused multiply-add: the same bits on every machine.
add_library(edged_options INTERFACE)
target_compile_features(edged_options INTERFACE cxx_std_20)
target_include_directories(edged_options INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(edged_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror -ffp-contract=off)
if(EDGED_SANITIZE)
  target_compile_options(edged_options INTERFACE -fsanitize=${EDGED_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
  target_link_options(edged_options INTERFACE -fsanitize=${EDGED_SANITIZE})
  # Memory that Eigen's code in libraries took is freed by ours: both must take it from malloc as it is.
  target_compile_definitions(edged_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

# edged_module(NAME SOURCES a.cpp ... DEPENDS libs ... TESTS a_test.cpp ...)
# makes the library edged_NAME (alias edged::NAME) and the test program edged_NAME_test.
function(edged_module NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;TESTS;TEST_DEPENDS" ${ARGN})
  if(ARG_SOURCES)
    add_library(edged_${NAME} STATIC ${ARG_SOURCES})
    target_link_libraries(edged_${NAME} PUBLIC edged_options ${ARG_DEPENDS})
  else()
    add_library(edged_${NAME} INTERFACE)
    target_link_libraries(edged_${NAME} INTERFACE edged_options ${ARG_DEPENDS})
  endif()
  add_library(edged::${NAME} ALIAS edged_${NAME})
  if(EDGED_TESTS AND ARG_TESTS)
    edged_test(edged_${NAME}_test SOURCES ${ARG_TESTS} DEPENDS edged::${NAME} ${ARG_TEST_DEPENDS})
  endif()
endfunction()

# edged_test(NAME SOURCES ... DEPENDS ... TIMEOUT seconds LABELS label)
function(edged_test NAME)
  cmake_parse_arguments(ARG "" "TIMEOUT;LABELS" "SOURCES;DEPENDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_executable(${NAME} ${ARG_SOURCES})
  target_link_libraries(${NAME} PRIVATE ${ARG_DEPENDS} GTest::gtest_main GTest::gmock)
  target_compile_definitions(
    ${NAME} PRIVATE EDGED_SOURCE_DIR="${PROJECT_SOURCE_DIR}" EDGED_BINARY_DIR="${CMAKE_BINARY_DIR}")
  gtest_discover_tests(${NAME} DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()
