# Writes OUT from schemas.cpp.in with the bytes of the files HAPTICAST and FOXGLOVE. Run: cmake -D... -P embed_schemas.cmake
foreach(set hapticast foxglove)
  string(TOUPPER ${set} file)
  file(READ ${${file}} hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," ${set}_bytes "${hex}")
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/schemas.cpp.in ${OUT} @ONLY)
