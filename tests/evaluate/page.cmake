# The committed report.md is what its CSV files give. Run: cmake -DPROGRAM=hapticast-evaluate -DREPORT=FOLDER -DOUT=FOLDER
# -P tests/evaluate/page.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${OUT})
file(COPY ${REPORT}/ DESTINATION ${OUT})
execute_process(COMMAND ${PROGRAM} report --out ${OUT} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${REPORT}/report.md ${OUT}/report.md RESULT_VARIABLE differs)
if(differs)
  message(FATAL_ERROR "${REPORT}/report.md is old: hapticast-evaluate report --out ${REPORT}")
endif()
