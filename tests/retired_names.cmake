# Each thing has one name (common/README.md, "Glossary"). retired_names.txt lists the names that were replaced; neither
# a source nor a page uses one of them again.
# Run: cmake -DROOT=. -P tests/retired_names.cmake
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
set(list ${ROOT}/tests/retired_names.txt)
file(STRINGS ${list} names)
list(LENGTH names name_count)
if(name_count LESS 100)
  message(FATAL_ERROR "only ${name_count} names in ${list}: wrong ROOT?")
endif()
execute_process(COMMAND grep -rnwFf ${list} --include=*.hpp --include=*.cpp --include=*.proto --include=*.md
  README.md common server client proto tests
  WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE found RESULT_VARIABLE exit_code)
if(exit_code EQUAL 0)
  message(FATAL_ERROR "retired names are in use (common/README.md has today's):\n${found}")
elseif(NOT exit_code EQUAL 1)
  message(FATAL_ERROR "grep failed (${exit_code})")
endif()
message(STATUS "none of ${name_count} retired names is in use")
