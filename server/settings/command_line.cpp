// SPDX-License-Identifier: MIT
#include "server/settings/command_line.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

#include "common/build_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "server/author/author_options.hpp"
#include "server/settings/child_options.hpp"
#include "server/settings/flag_rules.hpp"
#include "server/settings/scene_option.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

namespace {

const std::map<std::string, bool> kTransports{{"udp", true}, {"tcp", false}};
const std::map<std::string, bool> kSwitch{{"on", true}, {"off", false}};

const std::map<std::string, Layout> kLayouts{{"separate", Layout::kSeparate},
                                             {"side-by-side", Layout::kSideBySide},
                                             {"top-bottom", Layout::kTopBottom}};
const std::map<std::string, DepthCode> kDepthCodes{
    {"grey", DepthCode::kGrey}, {"inverse", DepthCode::kInverse}, {"hue", DepthCode::kHue}};
const std::map<std::string, DepthCode> kDepthNear{{"bright", DepthCode::kGrey},
                                                  {"dark", DepthCode::kInverse}};

/// Adds the flags about the files, the place, the code and the unit of depth.
void addLayoutOptions(CLI::App& app, VideoLayout& layout) {
  addChoice(
      app, "--layout", layout.layout, kLayouts,
      "The place of the depth in a single video file: a track of its own (separate), or a half "
      "of the picture. Colour is on the left or at the top; with --depth-code hue it is on the "
      "right or below. Default: separate");
  CLI::Option* const code =
      addChoice(app, "--depth-code", layout.code, kDepthCodes,
                "Depth with 8 bits: grey (near is bright), inverse (as --depth-near dark), or, in "
                "videos, hue (Record3D: 3 m for the whole circle of hues). Default: grey");
  addChoice(app, "--depth-near", layout.code, kDepthNear,
            "Where grey depth with 8 bits is near, in folders and videos. Default: bright")
      ->default_str("")  // a configuration file with all defaults would have both
      ->excludes(code);
  addNumber(app, "--depth-unit", layout.depth_unit_mm, 1e-3, 1e4, "MM",
            "mm of one unit of depth, in folders, videos, recordings and v4l2: 0.2 for TUM and "
            "ORB-SLAM (1/5000 m), 1 for mm, 1000 for metres. Default: as the source states, else 1 "
            "for integers and 1000 for floats");
  app.add_option("--color", layout.color_glob,
                 "The colour images of a folder, as a pattern relative to it, e.g. 'frame_*.jpg'; "
                 "needs --depth or --depth-from. Default: the server recognises the layout")
      ->type_name("GLOB");
  app.add_option("--depth", layout.depth_glob,
                 "The depth images of a folder, as a pattern relative to it, e.g. 'depth_*.png'")
      ->type_name("GLOB");
  app.add_option("--topics", layout.topics,
                 "The topics of colour and depth in a recording of ROS 2 or Foxglove (MCAP), e.g. "
                 "/camera/color/image_raw,/camera/depth/image_raw. Default: the only ones")
      ->type_name("COLOR,DEPTH");
}

void addSourceOptions(CLI::App& app, Settings& settings) {
  app.add_option(
         "--source", settings.source,
         "The video to stream: synthetic:bounce|approach|tumble|still, a folder of RGB-D "
         "images (rgb/ and depth/, or TUM's rgb.txt and depth.txt), COLOR,DEPTH (two video "
         "files; depth may also be a folder of images or an array NPY, NPZ), FILE (one video file "
         "with "
         "colour and depth), camera:N,M (colour camera, depth "
         "camera), openni:[DEVICE] (a camera of OpenNI2), v4l2:COLOR,DEPTH (two nodes of "
         "a camera, 16-bit depth), URL (a live stream with colour and depth: rtsp, rtsps, srt, "
         "http, "
         "https, udp, tcp or rtp), or nats://HOST[:PORT][,HOST2]/CHANNEL (an edge: it forwards the "
         "stream that an origin "
         "publishes), or FILE.mcap (a recording that --record has made, or one of ROS 2 or "
         "Foxglove with colour and depth images)")
      ->required();
  addNumber(app, "--fps", settings.fps, 1.0, 240.0, "1..240",
            "Frames a second; default: the source's own");
  addLayoutOptions(app, settings.layout);
  addChildOptions(app, settings.child);
  app.add_flag("--loop", settings.loop, "Start again at the end of the clip");
  app.add_flag("--on-demand", settings.on_demand,
               "Each viewer of a recording (--source FILE.mcap) has a time line of its own: it may "
               "pause, seek and set the speed; by TCP");
  app.add_flag("--to-and-fro", settings.to_and_fro,
               "Play the images of a folder forwards, then backwards; with --loop no jump remains");
  app.add_flag("--wait-for-viewer", settings.wait_for_viewer,
               "Begin to play when the first viewer has joined");
  addNumber(app, "--frames", settings.frames, std::uint64_t{1}, std::uint64_t{1'000'000'000}, "N",
            "Stop after N frames");
}

/// Adds --preview. Its value is a file for one picture, or a folder for several.
void addPreview(CLI::App& app, std::string& preview) {
  const auto set = [&preview](const std::string& text) {
    std::error_code error;
    const std::filesystem::path place(text);
    const bool picture = hasEnding(text, ".png");
    const bool folder = std::filesystem::is_directory(place, error) || !place.has_extension();
    if (text.empty() || !(picture || folder)) {
      throw CLI::ValidationError("--preview", quote(text) + " is not FILE.png or a folder");
    }
    preview = text;
  };
  app.add_option_function<std::string>(
         "--preview", set,
         "Stream nothing: write the server's result (outline, relief, advice) to a picture, or "
         "with the whole clip's outlines into a folder")
      ->type_name("FILE.png|FOLDER");
}

void addRecord(CLI::App& app, std::string& record) {
  const auto set = [&record](const std::string& text) {
    if (!hasEnding(text, kRecordingEnding))
      throw CLI::ValidationError("--record", quote(text) + " is not FILE.mcap");
    record = text;
  };
  app.add_option_function<std::string>(
         "--record", set,
         "Record the stream with its pictures in a new file; --source FILE.mcap plays it")
      ->type_name("FILE.mcap");
}

void addMulticast(CLI::App& app, std::optional<MulticastChoice>& multicast) {
  constexpr const char* kForm = "GROUP:PORT[@INTERFACE], for example 239.1.2.3:7448";
  const auto set = [&multicast](const std::string& text) {
    const std::size_t at = text.find('@');
    const auto group = parseEndpoint(text.substr(0, at), Endpoint{"", 0});
    const bool named = at == std::string::npos || at + 1 < text.size();
    if (!group || group->host.empty() || group->port == 0 || !named)
      throw CLI::ValidationError("--multicast", quote(text) + " is not " + kForm);
    multicast = MulticastChoice{*group, at == std::string::npos ? "" : text.substr(at + 1)};
  };
  app.add_option_function<std::string>(
         "--multicast", set,
         "Send each datagram once to this group, for all viewers of a network that join it; "
         "INTERFACE is a name or an address of this machine")
      ->type_name("GROUP:PORT[@INTERFACE]");
}

void addTlsOptions(CLI::App& app, Settings& settings) {
  app.add_option("--tls-cert", settings.tls.certificate,
                 "Offer TLS with this certificate (PEM, with its chain); needs --tls-key")
      ->type_name("FILE");
  app.add_option("--tls-key", settings.tls.key, "The private key of --tls-cert (PEM)")
      ->type_name("FILE");
  const auto set = [&settings](const std::string& text) {
    if (text != "auto") throw CLI::ValidationError("--tls", quote(text) + " is not auto");
    settings.tls.automatic = true;
  };
  app.add_option_function<std::string>(
         "--tls", set,
         "auto: offer TLS with a key pair of the server's own, which it makes once; the log shows "
         "its fingerprint, and --announce carries it")
      ->type_name("auto");
  app.add_option("--tokens", settings.tokens_file,
                 "Accept only viewers with a token of this file: lines `SHA256 viewer|operator "
                 "YYYY-MM-DD|never`; other machines then need TLS")
      ->type_name("FILE");
  app.add_flag("--insecure", settings.insecure,
               "With --tokens: accept other machines without TLS, so that anybody on the way can "
               "read their tokens");
}

/// Returns `text` if it has only characters that occur in host names.
std::optional<std::string> parseHostName(const std::string& text) {
  constexpr std::size_t kLongest_bytes = 253;
  const bool valid = std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '.' || c == '_';
  });
  if (!valid || text.empty() || text.size() > kLongest_bytes) return std::nullopt;
  return text;
}

void addHttp(CLI::App& app, Settings& settings) {
  addLocalPort(
      app, "--http", settings.http,
      "Show figures for operators by HTTP: /metrics (Prometheus), /health, /status.json; ADDR: "
      "an IP address of this machine, default: 127.0.0.1; port 0: any free port; without this "
      "flag: no such port");
  addList(
      app, "--host-name", settings.host_names, parseHostName,
      "Another name under which browsers and requests may reach the page and the port of --http, "
      "for example of a reverse proxy; repeat for several. Addresses, localhost and the name of "
      "this machine need no flag",
      "NAME (a host name without a port, such as figures.example.org)");
}

void addNetworkOptions(CLI::App& app, Settings& settings) {
  addEndpoint(app, "--listen", settings.listen, 0, "[ADDR:]PORT, an IP address or [V6ADDRESS]:PORT",
              "The address for clients: an IP address of this machine and a port; default: "
              "[::]:7447 (all addresses of IPv6 and IPv4); port 0: any free port");
  addChoice(app, "--transport", settings.datagrams, kTransports,
            "udp: the server sends frames by UDP to viewers that can receive them, else by TCP; "
            "tcp: all frames by TCP. Default: udp");
  addChoice(app, "--page", settings.page, kSwitch,
            "on: the address for clients also shows browsers the page, in which the stream can be "
            "touched; off: it answers browsers with one sentence. Default: on");
  addHttp(app, settings);
  addMulticast(app, settings.multicast);
  addNumber(app, "--multicast-ttl", settings.multicast_hops, std::uint64_t{1}, std::uint64_t{255},
            "N 1..255", "How many networks multicast may cross; default: 1, this one");
  addNumber(app, "--max-clients", settings.max_clients, std::uint64_t{1}, std::uint64_t{10'000},
            "N",
            "The largest number of viewers; the server rejects more with a message; default: 64");
  app.add_option("--signing-key", settings.signing_key_file,
                 "The private key (Ed25519, PEM) that signs the frames, so that viewers can expect "
                 "its public key (--origin-key); a FILE that does not exist is created with a new "
                 "key; default: another key in each run")
      ->type_name("FILE");
  addTlsOptions(app, settings);
  const auto announce = [&settings](const std::string& text) {
    settings.announce = serviceName("--announce", text);
  };
  app.add_option_function<std::string>(
         "--announce", announce,
         "Announce this server on the LAN as NAME (mDNS), so that clients find it; default: no "
         "announcement")
      ->type_name("NAME");
}

void addRelayOptions(CLI::App& app, Settings& settings) {
  const auto set = [&settings](const std::string& text) {
    settings.publish = parseNatsAddress(text);
    if (!settings.publish)
      throw CLI::ValidationError("--publish", quote(hideUser(text)) + " is not " + kNatsForm);
  };
  app.add_option_function<std::string>(
         "--publish", set,
         "Publish the stream on this channel of NATS, too; edges serve it to their viewers")
      ->type_name(kNatsForm);
  app.add_option("--nats-creds", settings.nats.creds_file,
                 "The file with the credentials for NATS (JWT and NKey seed)")
      ->type_name("FILE");
  app.add_option("--nats-ca", settings.nats.ca_file,
                 "Use TLS to NATS; the servers' certificates must be of an authority in this file")
      ->type_name("FILE");
}

void addExplain(CLI::App& app, bool& explain) {
  app.add_flag("--explain", explain,
               "Log the stages that the server leaves out for each object, with reason, saving "
               "and cost. Log the candidates for the first mask, with their scores");
}

/// Returns the flags that were set.
FlagTexts listFlags(const CLI::App& app) {
  FlagTexts flags;
  for (const CLI::Option* const option : app.get_options()) {
    for (const std::string& text : option->results())
      flags.emplace_back(option->get_lnames().front(), text);
  }
  return flags;
}

std::optional<KeyBytes> parseOriginKey(const std::string& text) { return parseKey(text); }

void addOriginKey(CLI::App& app, std::vector<KeyBytes>& keys) {
  addList(
      app, "--origin-key", keys, parseOriginKey,
      "A public key that the origin of this edge may have, or the other origins of the channel; "
      "repeat for several. Default: any key, but with --signing-key only its own",
      "KEY (64 hex digits of the origin's public key)");
}

}  // namespace

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Turns RGB-D video into haptic frames and streams them to hapticast-client. Ctrl-C ends the "
      "server. `hapticast-server bake SOURCE -o FILE.mcap` computes a clip without a limit of time "
      "(bake --help).",
      "hapticast-server");
  addVersion(*app, std::string("sources: synthetic, images, videos, cameras; transports: udp, "
                               "multicast, tcp; discovery: ") +
                       (kHasDiscovery ? "Avahi" : "none") +
                       "; relays: " + (kHasRelays ? "NATS" : "none") +
                       "; camera libraries: " + (kHasOpenni ? "OpenNI2" : "none"));
  addSourceOptions(*app, settings);
  addNetworkOptions(*app, settings);
  addRelayOptions(*app, settings);
  addOriginKey(*app, settings.origin_keys);
  addName(*app, settings.name);
  addVisionOptions(*app, settings.vision);
  addMaterialOptions(*app, settings.vision.material, settings.vision.mass_kg);
  addScene(*app, settings);
  addPreview(*app, settings.preview);
  addRecord(*app, settings.outputs.record);
  addLive(*app, settings.outputs.live);
  addExplain(*app, settings.vision.explain);
  app->add_flag("--quiet", settings.quiet, "Only warnings and errors");
  addConfigFile(*app);
  app->final_callback([&settings, parsed = app.get()] {
    requireFlags(*parsed, settings);
    if (!isEdge(settings) && !settings.is_recording) mergeScene(*parsed, settings);
    settings.flags = listFlags(*parsed);
  });
  return app;
}

std::optional<int> readCommandLine(Settings& settings, int argc, const char* const* argv) {
  const auto app = commandLine(settings);
  return parseCommandLine(*app, argc, argv);
}

Result<Settings> rereadCommandLine(int argc, const char* const* argv) {
  Settings settings;
  const auto app = commandLine(settings);
  if (const auto problem = parseArguments(*app, argc, argv)) return Error{*problem};
  return settings;
}

}  // namespace hapticast::server
