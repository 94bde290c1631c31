# No test depends on the speed of the machine (README.md, "Waiting and ports"): a test waits for an event by the one
# loop of its language, and the kernel chooses each port. What rests, or has a number of a port, is in the list below.
# Run: cmake -DROOT=. -P tests/waiting.cmake
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
string(CONCAT rests "\\b(sleep|usleep|(clock_)?nanosleep|sleep_for|sleep_until|sleep_ms|restBetweenTurns|setTimeout)\\b"
  "|wait_for\\(std::chrono|performance\\.now\\(\\) *>|steady_timer +[a-z_]+\\(io, |\\brun_for\\(")
string(CONCAT ports
  "\\b(freePort|findPort|findFreePort|free_port|find_port|find_free_port)\\b"
  "|getpid\\(\\) *%"                                                 # a number that this process alone has
  "|\\bk?[A-Za-z]*P(ort|ORT) *= *[1-9][0-9]{2,4}\\b"                   # a constant
  "|--listen[\"' ,=]+([^\"' ]*:)?[1-9][0-9]{2,4}([\"' ,)]|$)"         # of the programs
  "|loopback\\(\\), *[1-9][0-9]{2,4}\\b"                               # of asio
  "|(bind|create_server|Server)\\(\\([\"'][^\"']*[\"'], *[1-9]"        # of Python
  "|\\blisten +([0-9.]+:)?[1-9][0-9]{2,4};")                          # of nginx

# FILE: WORDS: reason. Everything else that the patterns find is refused, and so is an entry that they do not find.
set(allowed
  "support/waiting.hpp: sleep_for|restBetweenTurns: the loop of C++"
  "support/waiting.py: time.sleep: the loop of Python"
  "support/device/light_device.h: sleep: a device that answers late"
  "support/device/standin.c: sleep: a device that ticks, and one that answers late"
  "support/device/fake_dhd.c: sleep_ms: a device that answers late"
  "support/device/fake_hd.c: sleep: a library that ticks, and one that answers late"
  "falcon/usb_port.cpp: sleep_for: a cable on which the answers hang"
  "falcon/client_test.cpp: sleep_for: runs in real time, alone, in deploy/test ci"
  "openni/driver.cpp: sleep_until|restBetweenTurns: a camera delivers frames at its rate"
  "v4l2/kernel.cpp: restBetweenTurns: a poll() of the kernel waits for the frame of a camera"
  "unit/haptics/loop_thread_test.cpp: restBetweenTurns: a thread that still ran would tick meanwhile"
  "unit/server/child_source_test.cpp: restBetweenTurns: a live camera has a rate, and a reader is slower than the pause before a new child"
  "unit/server/network_stream_test.cpp: restBetweenTurns: a live sender has a rate"
  "integration/programs_attacks_test.cpp: restBetweenTurns: attackers below the limits of rates, beside viewers that poll"
  "integration/programs_malicious_test.cpp: restBetweenTurns: a malicious server polls its sockets"
  "integration/programs_relay_malicious_test.cpp: restBetweenTurns: a malicious origin sends at a rate"
  "integration/programs_multicast_test.cpp: kPort: a group needs a port, and both hosts are namespaces of the test"
  "integration/programs_live_test.cpp: kPort: FFmpeg needs a port, and the network is a namespace of the test"
  "integration/stream_fixture.hpp: run_for: a turn of the loop of events, before the condition is read again"
  "integration/datagram_client_test.cpp: steady_timer: after the link's next look, which is due before, no second ends any more"
  "openni/camera_test.cpp: wait_for: a camera that is gone stays gone for longer than the pause before it is opened again"
  "recording/watch_live.mjs: setTimeout: counts messages for as long as deploy/check-recording wants"
  "page/trust_test.py: performance: a page that failed does not try again within its longest pause"
  "page/bad_input_test.py: performance: as in trust_test.py"
  "page/measure.py: time.sleep|setTimeout: a measurement by hand")

# Sets `name` to the lines of the tests in which grep finds the pattern.
function(find_lines name pattern)
  execute_process(COMMAND grep -rnIE --exclude-dir=bench --exclude-dir=evaluate --exclude-dir=data --exclude-dir=corpus
    --exclude=*.md --exclude=*.cmake --exclude=*.txt -e "${pattern}" .
    WORKING_DIRECTORY ${ROOT}/tests OUTPUT_VARIABLE found RESULT_VARIABLE exit_code)
  if(exit_code GREATER 1)
    message(FATAL_ERROR "grep failed (${exit_code})")
  endif()
  string(REGEX REPLACE "[][;\\]" " " found "${found}")  # they would part or join the elements of a list
  string(REPLACE "\n./" ";" found "\n${found}")
  set(${name} "${found}" PARENT_SCOPE)
endfunction()

find_lines(lines "${rests}|${ports}")
set(refused "")
set(used "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE ":.*" "" file "${line}")
  set(entry ${allowed})
  list(FILTER entry INCLUDE REGEX "^${file}: ")
  string(REGEX REPLACE "^[^:]*: ([^:]*): .*" "\\1" words "${entry}")
  if(entry AND line MATCHES "${words}")
    list(APPEND used "${file}")
  elseif(line)
    string(STRIP "${line}" line)
    string(APPEND refused "\n  tests/${line}")
  endif()
endforeach()
if(refused)
  message(FATAL_ERROR "these wait for a time or choose a port (tests/README.md, \"Waiting and ports\"):${refused}")
endif()
foreach(entry IN LISTS allowed)
  string(REGEX REPLACE ": .*" "" file "${entry}")
  if(NOT file IN_LIST used)
    message(FATAL_ERROR "tests/${file} waits for no time and has no port: remove it from the list")
  endif()
endforeach()
list(LENGTH allowed count)
message(STATUS "no test waits for a time or chooses a port, apart from ${count} files")
