# The real-time room may call nothing that waits, allocates, throws or speaks: its archive's undefined symbols are
# those of the list below. (loop.cpp, which runs the ticks, may also read the clock between them.)
# Usage: cmake -DNM=nm -DARCHIVE=libhapticast_haptics.a -P realtime_symbols.cmake
execute_process(COMMAND ${NM} -P ${ARCHIVE} OUTPUT_VARIABLE listing RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${NM} ${ARCHIVE} failed")
endif()

set(allowed
  "mem(cpy|move|set|cmp)"
  "(sin|cos|sincos|tan|tanh|asin|acos|atan|atan2|exp|log|pow|sqrt|cbrt|hypot)f?"
  "(fmod|remainder|floor|ceil|round|trunc|rint|nearbyint|lround|llround|ldexp)f?"
  "_ZNK?9hapticast[0-9].*" # ours, of hapticast_common
  "_GLOBAL_OFFSET_TABLE_"
  "__stack_chk_fail")
list(JOIN allowed "|" allowed)

string(REPLACE "\n" ";" lines "${listing}")
set(defined "")
set(undefined "")
set(member "")
foreach(line IN LISTS lines)
  if(line MATCHES "\\[(.*)\\]:$")
    set(member "${CMAKE_MATCH_1}")
  elseif(member STREQUAL "loop.cpp.o" AND line MATCHES "^_ZNSt6chrono3_V212steady_clock3nowEv U")
    continue()
  elseif(line MATCHES "^([^ ]+) [Uw]")
    list(APPEND undefined "${CMAKE_MATCH_1}")
  elseif(line MATCHES "^([^ ]+) [A-Za-z] ")
    list(APPEND defined "${CMAKE_MATCH_1}")
  endif()
endforeach()
list(REMOVE_DUPLICATES undefined)
list(LENGTH defined count)
if(count LESS 20)
  message(FATAL_ERROR "${ARCHIVE}: only ${count} symbols, is this the right archive?")
endif()
list(REMOVE_ITEM undefined ${defined})
list(FILTER undefined EXCLUDE REGEX "^(${allowed})$")
if(undefined)
  list(JOIN undefined "\n  " undefined)
  message(FATAL_ERROR "The real-time room must not need:\n  ${undefined}")
endif()
