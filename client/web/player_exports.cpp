// SPDX-License-Identifier: MIT
// What the worker of the player calls (page/player.js): the server of a page that plays a
// recording. Bytes and times are passed as in viewer_exports.cpp. Thread: one.
#include <memory>
#include <utility>

#include "client/web/exports.hpp"
#include "client/web/recorded_server.hpp"

namespace hapticast::client {

namespace {

std::unique_ptr<RecordedServer>& server() {
  static std::unique_ptr<RecordedServer> the_server;
  return the_server;
}

MediaTime toMedia(double now_ms) { return MediaTime(web::toLocal(now_ms).time_since_epoch()); }

}  // namespace

/// Opens the file of the page. Returns 1, or 0 with a phrase as output.
WEB_EXPORT(playOpen) int playOpen() {
  auto opened = RecordedServer::open("recording.mcap");
  if (!opened.ok()) {
    web::setOutput(opened.error().message);
    return 0;
  }
  server() = std::make_unique<RecordedServer>(std::move(opened).value());
  return 1;
}
/// Processes a message of the viewer, the input.
WEB_EXPORT(playReceive) void playReceive(double now_ms) {
  server()->receive(web::input(), toMedia(now_ms));
}
/// Writes the next message for the viewer that is due. Returns its size, or 0.
WEB_EXPORT(playPoll) std::size_t playPoll(double now_ms) {
  auto message = server()->poll(toMedia(now_ms));
  return message ? web::setOutput(std::move(*message)) : 0;
}
/// Writes why the recording ends early. Returns its size, or 0.
WEB_EXPORT(playProblem) std::size_t playProblem() { return web::setOutput(server()->problem()); }

}  // namespace hapticast::client
