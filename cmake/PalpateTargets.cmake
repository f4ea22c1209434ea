# palpate_library(<folder> SOURCES a.cpp ... DEPS palpate_core Eigen3::Eigen ... PRIVATE_DEPS ...)
#   static library palpate_<folder>; headers are included as "folder/name.hpp".
# palpate_test(<folder> SOURCES a_test.cpp ... DEPS ...)
#   gtest program test_<folder>, one ctest per test case.
# palpate_add_folder(<path>) adds a folder that has a CMakeLists.txt.

# Every program of ours is built with the same warnings, and warnings are errors.
function(palpate_configure_target target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Werror)
  if(PALPATE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${PALPATE_SANITIZE} -fno-omit-frame-pointer
                           -fno-sanitize-recover=all)
    target_link_options(${target} PRIVATE -fsanitize=${PALPATE_SANITIZE})
  endif()
  # No contraction of a*b+c: results must be the same bits on every x86-64 machine.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
endfunction()

function(palpate_library folder)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(palpate_${folder} STATIC ${arg_SOURCES})
  target_include_directories(palpate_${folder} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(palpate_${folder} PUBLIC ${arg_DEPS} PRIVATE ${arg_PRIVATE_DEPS})
  palpate_configure_target(palpate_${folder})
endfunction()

function(palpate_test folder)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(test_${folder} ${arg_SOURCES})
  target_link_libraries(test_${folder} PRIVATE ${arg_DEPS} GTest::gtest_main)
  target_compile_definitions(test_${folder} PRIVATE PALPATE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  palpate_configure_target(test_${folder})
  # GoogleTest's macros bring an `if` and names of their own.
  target_compile_options(test_${folder} PRIVATE -Wno-dangling-else -Wno-shadow)
  gtest_discover_tests(test_${folder} TEST_PREFIX ${folder}. PROPERTIES TIMEOUT 600
                       DISCOVERY_TIMEOUT 120)
endfunction()

function(palpate_add_folder path)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${path}/CMakeLists.txt)
    add_subdirectory(${PROJECT_SOURCE_DIR}/${path})
  endif()
endfunction()
