# The real-time room may call nothing that waits, allocates, throws or speaks: its archive's undefined symbols are
# those of the list below. What runs its ticks and reads the clock between them is another library (hapticast_loop).
# Usage: cmake -DNM=nm -DARCHIVE=libhapticast_haptics.a -P realtime_symbols.cmake
execute_process(COMMAND ${NM} -P ${ARCHIVE} OUTPUT_VARIABLE listing RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${NM} ${ARCHIVE} failed")
endif()

set(allowed
  "mem(cpy|move|set|cmp)"
  "(sin|cos|sincos|tan|tanh|asin|acos|atan|atan2|exp|log|pow|sqrt|cbrt|hypot)f?"
  "(fmod|remainder|floor|ceil|round|trunc|rint|nearbyint|lround|llround|ldexp)f?"
  # Of hapticast_common these and no others: each is noexcept and fixed in size, and realtime_heap_test runs it.
  "_ZNK?9hapticast(9Workspace|13DeviceMapping)[0-9].*"
  "_ZNK9hapticast11HeightField(4edge|6inside|6spline|8bilinear)E.*"
  "_GLOBAL_OFFSET_TABLE_"
  "__stack_chk_fail")
list(JOIN allowed "|" allowed)

string(REPLACE "\n" ";" lines "${listing}")
set(defined "")
set(undefined "")
foreach(line IN LISTS lines)
  if(line MATCHES "^([^ ]+) [Uw]")
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
