# The library for other programs: one archive libhapticast.a of position-independent code, the public headers, and the
# CMake package `hapticast` with the components haptics, stream, recording and vision. A component names what a program links with
# the archive; what a program does not use is not linked.
include(CMakePackageConfigHelpers)

add_library(hapticast_archive STATIC)
set_target_properties(hapticast_archive PROPERTIES OUTPUT_NAME hapticast EXPORT_NAME archive)
foreach(part frames common haptics profile api_haptics proto wire net servers api_receive stream api_publish
    recording loop run_recording api_recording
    json source vision api_vision)
  target_sources(hapticast_archive PRIVATE $<TARGET_OBJECTS:hapticast_${part}>)
endforeach()
target_link_libraries(hapticast_archive INTERFACE Threads::Threads Eigen3::Eigen)
target_compile_features(hapticast_archive INTERFACE cxx_std_20)
foreach(side common client server)
  target_include_directories(hapticast_archive INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/${side}/include>)
endforeach()
target_include_directories(hapticast_archive INTERFACE $<INSTALL_INTERFACE:usr/include>)

# hapticast_component(NAME LIBRARY...): what a program links with the archive.
function(hapticast_component name)
  add_library(hapticast_component_${name} INTERFACE)
  set_target_properties(hapticast_component_${name} PROPERTIES EXPORT_NAME ${name})
  target_link_libraries(hapticast_component_${name} INTERFACE hapticast_archive ${ARGN})
  add_library(hapticast::${name} ALIAS hapticast_component_${name})
  install(TARGETS hapticast_component_${name} EXPORT hapticast COMPONENT library)
endfunction()
set(stream_packages "")
set(vision_packages "")
foreach(package avahi openni2)
  if(TARGET hapticast_${package})
    set(${package}_library PkgConfig::${package})
  endif()
endforeach()
hapticast_component(haptics)
set(stream_libraries protobuf::libprotobuf-lite OpenSSL::SSL OpenSSL::Crypto spdlog::spdlog ${avahi_library})
hapticast_component(stream ${stream_libraries})
hapticast_component(recording ${stream_libraries} ZLIB::ZLIB PkgConfig::compressions)
# lld links a member of the archive for any symbol that a shared library lacks, such as a function of std::string. Then the
# program needs the libraries of that member.
hapticast_component(vision ${OpenCV_LIBS} PkgConfig::libav PkgConfig::libzip ZLIB::ZLIB PkgConfig::compressions
  OpenSSL::Crypto spdlog::spdlog ${openni2_library} -Wl,--push-state,--as-needed ${stream_libraries} -Wl,--pop-state)

set(package_folder usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/hapticast)
install(TARGETS hapticast_archive EXPORT hapticast
  ARCHIVE DESTINATION usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} COMPONENT library)
install(EXPORT hapticast NAMESPACE hapticast:: FILE hapticastTargets.cmake DESTINATION ${package_folder} COMPONENT library)
foreach(side common client server)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${side}/include/hapticast DESTINATION usr/include COMPONENT library
    FILES_MATCHING PATTERN *.hpp)
endforeach()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/hapticastConfig.cmake.in hapticastConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
# There is no stable interface yet: a program asks for the version that it was written for.
write_basic_package_version_file(hapticastConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hapticastConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/hapticastConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT library)
