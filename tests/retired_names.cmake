# Each thing has one name (common/README.md, "Glossary"). retired_names.txt lists the names that were replaced; neither
# a source nor a page uses one of them again. A line *NAME is a part of identifiers, which no C++ source of the tests
# has.
# Run: cmake -DROOT=. -P tests/retired_names.cmake
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
set(list ${ROOT}/tests/retired_names.txt)
file(STRINGS ${list} names)
list(LENGTH names name_count)
if(name_count LESS 100)
  message(FATAL_ERROR "only ${name_count} names in ${list}: wrong ROOT?")
endif()
set(parts ${names})
list(FILTER parts INCLUDE REGEX "^[*]")
list(TRANSFORM parts REPLACE "^[*]" "-e")
if(NOT parts)
  message(FATAL_ERROR "no line *NAME in ${list}")
endif()

# Ends with an error if grep finds one of the names.
function(require_none)
  execute_process(COMMAND grep -rnF ${ARGN} WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE found RESULT_VARIABLE exit_code)
  if(exit_code EQUAL 0)
    message(FATAL_ERROR "retired names are in use (common/README.md has today's):\n${found}")
  elseif(NOT exit_code EQUAL 1)
    message(FATAL_ERROR "grep failed (${exit_code})")
  endif()
endfunction()

# A line *NAME is no word of the sources, so that this search does not find it.
require_none(-wf ${list} --include=*.hpp --include=*.cpp --include=*.proto --include=*.md
  README.md common server client proto tests)
require_none(${parts} --include=*.hpp --include=*.cpp tests)
message(STATUS "none of ${name_count} retired names is in use")
