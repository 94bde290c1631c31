# Checks who may include whom (README.md, "Folders and pages"). Run: cmake -DROOT=. -P tests/include_directions.cmake
# Each rule: files that match -> the only project includes and library includes they may have.
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
set(failures "")

# Which folder may include which (regular expressions over the included path).
set(rules
  "(common|server|client)/include/.*" "^$"
  "common/[^/]*"       "^common/[^/]*$"
  "common/sync/.*"     "^common/([^/]*$|sync/)"
  "common/relief/.*"   "^common/([^/]*$|relief/)"
  "common/codec/.*"    "^common/([^/]*$|codec/|relief/)"
  "common/transport/.*" "^common/([^/]*$|transport/)"
  "common/protocol/.*" "^common/([^/]*$|codec/|transport/|protocol/)"
  "common/recording/.*" "^common/([^/]*$|recording/)"
  "common/playback/.*" "^common/([^/]*$|codec/|protocol/|recording/|playback/)"
  "common/live/.*"     "^common/([^/]*$|recording/|transport/|live/)|^common/protocol/recorded\\.hpp$"
  "common/json/.*"     "^common/([^/]*$|json/)"
  "common/cli/.*"      "^common/([^/]*$|cli/)"
  "common/media/module/.*" "^common/media/(media_module\\.hpp$|module/)"
  "common/media/[^/]*" "^common/([^/]*$|media/[^/]*$)"
  "common/library/.*"  "^common/([^/]*$|library/|include/)"
  "server/source/[a-z_]+\\.hpp"  "^(common/|server/source/[a-z_]+\\.hpp$)"
  "server/source/picture/.*"   "^(common/|server/source/([a-z_]+\\.hpp$|picture/))"
  "server/source/scale/.*"     "^(common/|server/source/([a-z_]+\\.hpp$|(picture|scale)/))"
  "server/source/folder/.*"    "^(common/|server/source/([a-z_]+\\.hpp$|(picture|scale|folder)/))"
  "server/source/video/.*"     "^(common/|server/source/([a-z_]+\\.hpp$|(picture|scale|video)/))"
  "server/source/live/.*"      "^(common/|server/source/([a-z_]+\\.hpp$|(picture|scale|video|live)/))"
  "server/source/recording/.*" "^(common/|server/source/([a-z_]+\\.hpp$|(picture|scale|folder|recording)/))"
  "server/source/child/.*"     "^(common/|server/source/([a-z_]+\\.hpp$|(picture|scale|folder|child)/))"
  "server/source/synthetic/.*" "^(common/|server/source/([a-z_]+\\.hpp$|synthetic/))"
  "server/source/.*"           "^(common|server/source)/"
  "server/vision/vision_settings\\.hpp" "^(common/|server/source/camera_model\\.hpp$)"
  "server/vision/base/.*"    "^(common/|server/source/|server/vision/(vision_settings\\.hpp$|base/))"
  "server/vision/segment/.*" "^(common/|server/source/|server/vision/(vision_settings\\.hpp$|base/|segment/))"
  "server/vision/surface/.*" "^(common/|server/source/|server/vision/(vision_settings\\.hpp$|base/|surface/))"
  "server/vision/motion/.*"  "^(common/|server/source/|server/vision/(vision_settings\\.hpp$|base/|surface/|motion/))"
  "server/vision/.*"         "^(common|server/source|server/vision)/"
  "server/stream/.*"   "^(common|server/stream)/"
  "server/library/(publish/.*|member_names\\.hpp)" "^(common/|server/(stream|library|include)/)"
  "server/library/.*"  "^(common/|server/(source|vision|library|include)/)"
  "server/recording/.*" "^(common/|server/(stream/|recording/))"
  "server/relay/.*"    "^(common/|server/(stream/|relay/))"
  "server/pipeline/pipeline_counts\\.hpp" "^(common/|server/(stream/|vision/vision_settings\\.hpp$))"
  "server/http/.*"     "^(common/|server/(stream/|relay/relay_counts\\.hpp$|pipeline/pipeline_counts\\.hpp$|vision/vision_settings\\.hpp$|http/))"
  "server/page/.*"     "^(common/|server/(http/(host_names|http_request)\\.hpp$|page/))"
  "server/author/.*"   "^(common/|server/(source/[a-z_]+\\.hpp$|vision/vision_settings\\.hpp$|author/))"
  "server/(pipeline|preview)/.*" "^(common/|server/(settings/settings\\.hpp$|author/scene_file\\.hpp$|source/|vision/|stream/|pipeline/|preview/))"
  "server/settings/.*" "^(common/|server/(settings/|author/|source/|vision/vision_settings\\.hpp$|stream/|relay/nats_address\\.hpp$))"
  "server/show/.*"     "^(common/|server/(settings|show|source|vision|stream|recording|relay|pipeline|http|page)/)"
  "server/main\\.cpp"  "^(common|server)/"
  "client/recording/.*" "^(common/|client/(haptics/|net/|device/(loop|profile)/|recording/))"
  "client/library/.*"  "^(common/|client/(haptics|net|recording|device/profile|servers|library|include)/)"
  "client/haptics/.*"  "^(common|client/haptics)/"
  "client/device/loop/.*" "^(common|client/haptics|client/device/loop)/"
  "client/device/.*"   "^(common|client/haptics|client/device)/"
  "client/net/.*"      "^(common|client/haptics|client/net)/"
  "client/report/.*"   "^(common|client/haptics|client/device/loop|client/net|client/report)/"
  "client/study/.*"    "^(common/|client/(haptics|study)/)"
  "client/view/.*"     "^(common|client/haptics|client/view)/"
  "client/web/messages/.*" "^(common/protocol/wire_reader\\.hpp$|client/web/messages/)"
  "client/web/.*"      "^(common|client/(haptics|device|net|view|web))/"
  "client/servers/.*"  "^(common|client/net|client/servers)/"
  "client/settings/.*" "^(common/|client/(haptics|net|device|study|servers|settings)/)"
  "client/desk/.*"     "^(common/|client/(haptics|net|device|servers|view|recording|report|settings|desk)/)"
  "client/study_run/.*" "^(common|client)/"
  "client/commands/.*" "^(common|client)/"
  "client/main\\.cpp"  "^(common|client)/"
  "tests/support/.*"   "^(common|server|client|tests/support)/"
  "tests/scenes/.*"    "^(common|server|client|tests/(support|scenes))/"
  "tests/unit/(evaluate|report)/.*" "^(common|server|client|tests)/"
  "tests/unit/.*"      "^(common|server|client|tests/(support|scenes|unit))/"
  "tests/integration/.*" "^(common|server|client|tests/(support|scenes|integration))/"
)
# One door per library: who may include it.
set(doors
  "^boost/"                          "^(common/transport/asio\\.hpp|client/device/inverse3/websocket\\.cpp|server/http/http_(request|response|server)\\.[ch]pp|server/page/page_responder\\.cpp|common/live/watcher\\.cpp|tests/.*)$"
  "^common/transport/asio\\.hpp$"              "^(common/(transport|live)|server/library/publish|server/stream|server/recording|server/relay|server/http|client/net|client/servers|client/desk|client/study_run|client/commands|server/show|tests)/"
  "\\.pb\\.h$"                       "^(common/protocol/(decode|encode|read_frame|write_frame|fragment|reassembly|relay|recorded)\\.[ch]pp|client/recording/run_codec\\.cpp|server/pipeline/plan_log\\.cpp)$"
  "^google/protobuf"                 "^common/protocol/decode\\.cpp$"
  "^(zlib|zstd|lz4frame)\\.h$"        "^(common/recording/mcap_compression\\.cpp|server/(page/page_files|source/child/depth_cache)\\.cpp|tests/.*)$"
  "^openssl/"                        "^(common/transport/(signature|tls|seal)\\.cpp|common/live/live_protocol\\.cpp|server/stream/access_list\\.cpp|server/source/child/depth_cache\\.cpp|server/page/websocket_handshake\\.cpp)$"
  "^opencv2/"                        "^((server/(source|vision|library)|client/view|tests)/|server/preview)"
  "^opencv2/(imgcodecs|videoio|video|calib3d|tracking)" "^(server|tests)/"
  "^lib(av[a-z]+|swscale)/"           "^(server/source/video/(video_(file\\.cpp|format\\.[ch]pp)|display_matrix\\.hpp)$|common/media/module/)"
  "^common/media/module/"            "^common/media/module/"
  "^common/media/load_media_module\\.hpp$" "^(common/media/load_media_module\\.cpp|client/view/.*|tests/.*)$"
  "^turbojpeg\\.h$"                  "^client/view/picture\\.cpp$"
  "^nlohmann/"                       "^(common/(live/live_protocol\\.cpp|json/json_document\\.hpp)$|server/(source/child/mask_task|http/metrics_text)\\.cpp$|client/(report/summary|device/inverse3/protocol|study/study_folder)\\.cpp$|tests/)"
  "^SDL"                             "^(client/(view/(window/|sound)|device/gamepad)|tests/)"
  "^(imgui|backends/imgui)"          "^(client/view/window/|tests/)"
  "^avahi-"                          "^(common/transport/mdns_session|client/servers/mdns_browser|server/stream/announce)\\.cpp$"
  "^nats/"                           "^server/relay/nats_connection\\.cpp$"
  "^OpenNI\\.h$"                     "^server/source/live/openni_camera\\.cpp$"
  "^systemd/"                        "^server/show/service_manager\\.cpp$"
  "^libusb"                          "^client/device/falcon/usb\\.cpp$"
  "^common/(codec|protocol|transport)/" "^(common/(codec|protocol|transport|live|playback)/|server/(library/publish/|stream/|recording/|relay/|pipeline/|http/|page/|settings/|show/|[^/]*$)|client/(net/|servers/|report/|library/|recording/|web/|settings/|desk/|commands/|study_run/|[^/]*$)|tests/)"
)

file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/common/*.?pp ${ROOT}/server/*.?pp ${ROOT}/client/*.?pp
     ${ROOT}/tests/*.?pp)
list(LENGTH files file_count)
if(file_count LESS 10)
  message(FATAL_ERROR "only ${file_count} sources under '${ROOT}': wrong ROOT?")
endif()

function(check_direction file included)
  set(rest ${rules})
  while(rest)
    list(POP_FRONT rest where allowed)
    if(file MATCHES "^${where}$")
      if(NOT included MATCHES "${allowed}")
        set(failures "${failures}\n  ${file} includes ${included}" PARENT_SCOPE)
      endif()
      return()
    endif()
  endwhile()
endfunction()

foreach(file ${files})
  file(STRINGS ${ROOT}/${file} lines REGEX "^#include [\"<]")
  foreach(line ${lines})
    string(REGEX REPLACE "^#include [\"<]([^\">]+)[\">].*" "\\1" included "${line}")
    if(included MATCHES "^(proto|common|server|client|tests)/")
      check_direction(${file} ${included})
    endif()
    set(rest ${doors})
    while(rest)
      list(POP_FRONT rest library who)
      if(included MATCHES "${library}" AND NOT file MATCHES "${who}")
        string(APPEND failures "\n  ${file} includes ${included}, which has another door")
      endif()
    endwhile()
  endforeach()
endforeach()

if(failures)
  message(FATAL_ERROR "include directions broken:${failures}")
endif()
message(STATUS "${file_count} sources keep the include directions")
