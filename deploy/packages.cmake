# Packages for Debian: hapticast-server and hapticast-client. deploy/package makes them. The target package_files makes
# what the programs print themselves: man pages (--help-all, by help2man) and configuration files (--print-config).
find_program(HELP2MAN help2man)
find_program(SHLIBDEPS dpkg-shlibdeps)
if(NOT HELP2MAN OR NOT SHLIBDEPS)
  message(STATUS "help2man or dpkg-dev was not found: left out: packages")
  return()
endif()
set(source ${PROJECT_SOURCE_DIR}/deploy/debian)
set(made ${PROJECT_BINARY_DIR}/package_files)
file(MAKE_DIRECTORY ${made})
add_custom_command(OUTPUT ${made}/changelog.gz
  COMMAND sh -c "\"$0\" \"$@\" >changelog" ${source}/changelog ${PROJECT_VERSION}
    ${PROJECT_SOURCE_DIR}/deploy/CHANGES.md
  COMMAND gzip -9nkf changelog
  DEPENDS ${source}/changelog ${PROJECT_SOURCE_DIR}/deploy/CHANGES.md WORKING_DIRECTORY ${made} VERBATIM)
set(made_files ${made}/changelog.gz)

# The files of both packages. `section`: of the man page.
function(hapticast_package name section description)
  set(program hapticast-${name})
  set(page ${program}.${section})
  add_custom_command(OUTPUT ${made}/${page}.gz ${made}/${name}.conf
    COMMAND ${HELP2MAN} --no-info --help-option=--help-all --section=${section} --name=${description}
      --version-string=${PROJECT_VERSION} --output=${page} $<TARGET_FILE:${program}>
    COMMAND gzip -9nf ${page}
    COMMAND sh -c "\"$0\" --print-config >${name}.conf" $<TARGET_FILE:${program}>
    DEPENDS ${program} WORKING_DIRECTORY ${made} VERBATIM)
  set(made_files ${made_files} ${made}/${page}.gz ${made}/${name}.conf PARENT_SCOPE)
  install(TARGETS ${program} DESTINATION usr/bin COMPONENT ${name})
  install(FILES ${made}/${page}.gz DESTINATION usr/share/man/man${section} COMPONENT ${name})
  install(FILES ${made}/${name}.conf DESTINATION etc/hapticast COMPONENT ${name})
  install(FILES ${made}/changelog.gz ${source}/copyright DESTINATION usr/share/doc/${program} COMPONENT ${name})
  file(GLOB_RECURSE pages RELATIVE ${PROJECT_SOURCE_DIR}/${name} ${PROJECT_SOURCE_DIR}/${name}/*.md)
  foreach(document IN LISTS pages)  # in folders as here, so that links between them work
    cmake_path(GET document PARENT_PATH folder)
    install(FILES ${PROJECT_SOURCE_DIR}/${name}/${document} DESTINATION usr/share/doc/${program}/${folder}
      COMPONENT ${name})
  endforeach()
  file(GLOB scripts ${source}/${name}/*)
  string(TOUPPER ${name} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${program} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA "${scripts}" PARENT_SCOPE)
endfunction()

hapticast_package(server 8 "streams video that viewers can touch")
install(FILES ${source}/hapticast-server.service DESTINATION usr/lib/systemd/system COMPONENT server)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/README.md DESTINATION usr/share/doc/hapticast-server/deploy COMPONENT server)
set(CPACK_DEBIAN_SERVER_DESCRIPTION "server of video that viewers can touch
hapticast-server reads video with a depth for every pixel, finds an object
and its motion, and streams both to hapticast-client.")
set(CPACK_DEBIAN_SERVER_PACKAGE_SECTION video)
set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS procps)  # the unit's ExecReload
set(CPACK_DEBIAN_SERVER_PACKAGE_RECOMMENDS avahi-daemon)
set(CPACK_DEBIAN_SERVER_PACKAGE_SUGGESTS "hapticast-client, nats-server")

hapticast_package(client 1 "touch a video that hapticast-server streams")
install(TARGETS hapticast-device hapticast-media DESTINATION usr/lib/hapticast COMPONENT client)
install(FILES ${PROJECT_SOURCE_DIR}/client/device/hapticast_device.h DESTINATION usr/include COMPONENT client)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/70-hapticast-falcon.rules DESTINATION usr/lib/udev/rules.d COMPONENT client)
install(FILES ${source}/hapticast-limits.conf DESTINATION etc/security/limits.d RENAME hapticast.conf COMPONENT client)
set(CPACK_DEBIAN_CLIENT_DESCRIPTION "touch video that hapticast-server streams
hapticast-client drives a haptic device 1,000 times a second, so that its user
touches the objects of a video. Without a device it has a mouse, a gamepad and
a virtual hand.")
set(CPACK_DEBIAN_CLIENT_PACKAGE_SECTION video)
set(CPACK_DEBIAN_CLIENT_PACKAGE_DEPENDS adduser)  # the group for real-time rights
set(CPACK_DEBIAN_CLIENT_PACKAGE_RECOMMENDS fonts-dejavu-core)
set(CPACK_DEBIAN_CLIENT_PACKAGE_SUGGESTS avahi-daemon)

# The library and the Python package: deploy/library.cmake and deploy/python install their files.
set(about ${made}/changelog.gz ${source}/copyright)
install(FILES ${about} DESTINATION usr/share/doc/libhapticast-dev COMPONENT library OPTIONAL)  # without package_files
install(FILES ${PROJECT_SOURCE_DIR}/common/include/README.md DESTINATION usr/share/doc/libhapticast-dev COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/deploy/examples DESTINATION usr/share/doc/libhapticast-dev COMPONENT library
  PATTERN *.py EXCLUDE)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libhapticast-dev)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "touch video: the library of hapticast for C++ programs
Headers, a static library and a CMake package: a renderer of forces, a
receiver and a publisher of haptic video, a reader of recordings, and vision.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libavcodec-dev, libavformat-dev, libavutil-dev, libeigen3-dev, libopencv-dev, \
liblz4-dev, libprotobuf-dev, libspdlog-dev, libssl-dev, libswscale-dev, libzip-dev, libzstd-dev, pkg-config, zlib1g-dev")
foreach(package avahi-client openni2)  # what was found, the archive needs
  string(REGEX REPLACE "-.*" "" name ${package})
  if(TARGET hapticast_${name})
    string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", lib${package}-dev")
  endif()
endforeach()
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "cmake, g++")
if(TARGET hapticast_python)
  install(FILES ${about} ${PROJECT_SOURCE_DIR}/deploy/python/README.md DESTINATION usr/share/doc/python3-hapticast
    COMPONENT python)
  install(FILES ${PROJECT_SOURCE_DIR}/deploy/examples/force_over_a_slice.py
    DESTINATION usr/share/doc/python3-hapticast/examples COMPONENT python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-hapticast)
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "touch video: the library of hapticast for Python
Reads haptic video and recordings of it, renders its forces, publishes it,
and makes it of images with depth, all in numpy arrays.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  # A module of one version of Python.
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
  set(python_component python)
endif()

add_custom_target(package_files DEPENDS ${made_files})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hapticast)
set(CPACK_PACKAGE_CONTACT "the hapticast authors <hapticast@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /)
set(CPACK_COMPONENTS_ALL server client library ${python_component})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
include(CPack)
