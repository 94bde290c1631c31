// SPDX-License-Identifier: MIT
// Sends the H.264 video of an MP4 file by RTSP, from its begin to each new receiver:
//   rtsp-sender FILE PORT     then rtsp://127.0.0.1:PORT/cam
// It runs until a signal ends it.
#include <gst/gst.h>
#include <gst/rtsp-server/rtsp-server.h>

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  gst_init(nullptr, nullptr);
  GstRTSPMediaFactory* const factory = gst_rtsp_media_factory_new();
  const std::string pipeline = std::string("( filesrc location=\"") + argv[1] +
                               "\" ! qtdemux ! rtph264pay name=pay0 pt=96 )";
  gst_rtsp_media_factory_set_launch(factory, pipeline.c_str());
  GstRTSPServer* const server = gst_rtsp_server_new();
  gst_rtsp_server_set_address(server, "127.0.0.1");
  gst_rtsp_server_set_service(server, argv[2]);
  GstRTSPMountPoints* const places = gst_rtsp_server_get_mount_points(server);
  gst_rtsp_mount_points_add_factory(places, "/cam", factory);
  if (gst_rtsp_server_attach(server, nullptr) == 0) {
    std::fprintf(stderr, "the port %s cannot be used\n", argv[2]);
    return 1;
  }
  g_main_loop_run(g_main_loop_new(nullptr, FALSE));
  return 0;
}
