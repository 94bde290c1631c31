// SPDX-License-Identifier: MIT
// Settings of hapticast-server and their defaults; command_line.hpp fills them. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/endpoint.hpp"
#include "common/live/output_settings.hpp"
#include "common/transport/signature.hpp"
#include "server/author/scene_file.hpp"
#include "server/relay/nats_address.hpp"
#include "server/source/child/child_settings.hpp"
#include "server/source/video_layout.hpp"
#include "server/stream/multicast_group.hpp"
#include "server/stream/server_tls.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// The subcommand of the program.
enum class Command : std::uint8_t { kServe, kRelay, kPreview, kBake };

/// Values of the flags that only a bake has.
struct BakeChoices {
  /// FILE.mcap, which does not exist, or the folder of a page, with a slash at its end.
  std::string out;
  bool resume = false;
  int picture_quality = 80;  ///< of the JPEGs, 1..100
  std::string flags;         ///< the flags that change the frames, as one text
};

/// Values of the flags; --help describes each.
struct Settings {
  Command command = Command::kServe;
  BakeChoices bake;
  std::string source;
  double fps = 0.0;  ///< frames/s; 0: the source's own rate
  bool loop = false;
  bool to_and_fro = false;
  VideoLayout layout;   ///< place and code of the depth in a video
  ChildSettings child;  ///< the user's own programs
  bool wait_for_viewer = false;
  std::uint64_t frames = 0;  ///< number of frames to stream; 0: no limit
  Endpoint listen{"::", kDefaultPort};
  bool datagrams = true;  ///< viewers may receive datagrams (--transport udp)
  std::optional<MulticastChoice> multicast;
  std::uint64_t multicast_hops = 1;
  std::size_t max_clients = 64;
  std::optional<Endpoint> http;         ///< port for operators; nullopt: none
  bool page = true;                     ///< browsers get the page on the port of the viewers
  std::vector<std::string> host_names;  ///< more names of this server in requests of HTTP
  std::optional<NatsAddress> publish;   ///< channel that edges receive; nullopt: no edges
  NatsCredentials nats;
  std::vector<KeyBytes> origin_keys;  ///< verifying keys that (other) origins may have; empty: any
  std::string signing_key_file;       ///< file of the signing key; empty: a new key in each run
  TlsFiles tls;
  std::string tokens_file;  ///< --tokens; empty: everybody may connect
  bool insecure = false;    ///< tokens may travel without TLS
  std::string announce;     ///< the server's name on the LAN; empty: not announced
  std::string name;         ///< name of the stream for viewers; empty: the source's name
  VisionSettings vision;
  Scene scene;                         ///< the author's work, from the scene file and from flags
  std::vector<KeyMaskFile> key_masks;  ///< those of the scene file
  std::string preview;     ///< output of the preview: FILE.png or a folder; empty: no preview
  bool on_demand = false;  ///< each viewer of a recording has a time line of its own
  OutputSettings outputs;  ///< recording of the stream, and watchers
  bool quiet = false;
  bool is_recording = false;  ///< isRecording(), once the flags are read
  FlagTexts flags;            ///< all flags that were set, in any way, with their texts
};

/// Returns whether the source is the channel of an origin, so that this server is an edge.
[[nodiscard]] bool isEdge(const Settings& settings);

inline constexpr std::string_view kRecordingEnding = ".mcap";
/// Returns whether the source is a recording of hapticast, which is played without vision. Reads
/// the head of the file. A file that cannot be read is none.
[[nodiscard]] bool isRecording(const Settings& settings);

}  // namespace hapticast::server
