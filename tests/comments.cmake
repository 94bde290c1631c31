# Comments and pages stand by themselves: nothing in the repository points to a page outside it (a design paper,
# somebody's working papers). They may cite a page of the repository, a publication or an equation.
# Run: cmake -DROOT=. -P tests/comments.cmake
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
set(outside "(^|[^A-Za-z_\"])(DESIGN|notes)([^A-Za-z_]|$)|reference/|reference: |house\\.md")
foreach(example "// (DESIGN section 3)" "// proxy notes, section 2" "/// notes." "see reference/motion.md")
  if(NOT example MATCHES "${outside}")
    message(FATAL_ERROR "'${example}' is not recognised")
  endif()
endforeach()

file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/proto/* ${ROOT}/common/* ${ROOT}/server/* ${ROOT}/client/*
     ${ROOT}/deploy/* ${ROOT}/tests/*.?pp ${ROOT}/tests/*.md ${ROOT}/tests/*.txt ${ROOT}/tests/*.cmake)
list(FILTER files EXCLUDE REGEX "^tests/(comments\\.cmake|evaluate/report/)")
list(APPEND files README.md CMakeLists.txt CMakePresets.json .clang-tidy .clang-format .ci/run)
list(LENGTH files file_count)
if(file_count LESS 300)
  message(FATAL_ERROR "only ${file_count} files under '${ROOT}': wrong ROOT?")
endif()

set(pointers "")
foreach(file ${files})
  file(READ ${ROOT}/${file} text)
  if(NOT text MATCHES "${outside}")
    continue()
  endif()
  # A semicolon or a bracket would part or join the elements of a list.
  string(REGEX REPLACE "[][;]" " " text "${text}")
  string(REPLACE "\n" ";" lines "${text}")
  set(number 0)
  foreach(line IN LISTS lines)
    math(EXPR number "${number} + 1")
    if(line MATCHES "${outside}")
      string(STRIP "${line}" line)
      string(APPEND pointers "\n  ${file}:${number}: ${line}")
    endif()
  endforeach()
endforeach()

if(pointers)
  message(FATAL_ERROR "these point outside the repository:${pointers}")
endif()
message(STATUS "${file_count} files stand by themselves")
