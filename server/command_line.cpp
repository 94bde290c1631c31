// SPDX-License-Identifier: MIT
#include "server/command_line.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

#include "common/build_options.hpp"
#include "common/cli/options.hpp"
#include "common/cli/parse.hpp"
#include "common/codec/height_codec.hpp"
#include "common/wire_limits.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

namespace {

const std::map<std::string, SegmentMode> kSegmentModes{{"auto", SegmentMode::kAuto},
                                                       {"band", SegmentMode::kBand},
                                                       {"edges", SegmentMode::kEdges},
                                                       {"source", SegmentMode::kSource}};
const std::map<std::string, MotionMode> kMotionModes{{"auto", MotionMode::kAuto},
                                                     {"rgbd", MotionMode::kRgbd},
                                                     {"lk", MotionMode::kLk},
                                                     {"depth", MotionMode::kDepth},
                                                     {"none", MotionMode::kNone}};

const std::map<std::string, Method> kMethods{{"hapticast", Method::kHapticast},
                                             {"thesis", Method::kThesis}};

const std::map<std::string, bool> kTransports{{"udp", true}, {"tcp", false}};

const std::map<std::string, Layout> kLayouts{{"separate", Layout::kSeparate},
                                             {"side-by-side", Layout::kSideBySide},
                                             {"top-bottom", Layout::kTopBottom}};
const std::map<std::string, DepthCode> kDepthCodes{
    {"grey", DepthCode::kGrey}, {"inverse", DepthCode::kInverse}, {"hue", DepthCode::kHue}};
const std::map<std::string, DepthCode> kDepthNear{{"bright", DepthCode::kGrey},
                                                  {"dark", DepthCode::kInverse}};

constexpr double kMostDepth_mm = 1e6;
constexpr double kLongestClip_s = 1e6;  // chosen: eleven days

void addRange(CLI::App& app, const char* flag, std::optional<DepthRange>& range, const char* help) {
  const auto take = [&range](const Vec2& pair) {
    if (!(pair.x() >= 0.0 && pair.x() < pair.y() && pair.y() <= kMostDepth_mm)) return false;
    range = DepthRange{pair.x(), pair.y()};
    return true;
  };
  addPair(app, flag, take, "NEAR,FAR in mm with 0 <= NEAR < FAR <= 1000000", help)
      ->type_name("MM,MM");
}

void addRanges(CLI::App& app, VisionSettings& vision) {
  addRange(
      app, "--depth-range", vision.depth_range,
      "The depths of the levels 255 and 0 of 8-bit depth; for depth in mm the same as --map-range");
  addRange(
      app, "--map-range", vision.map_range,
      "Depths that become the nearest and farthest height; default: the object's, from the clip");
}

constexpr double kMostFriction = limits::kFriction;

void addFriction(CLI::App& app, Material& material) {
  const auto take = [&material](const Vec2& pair) {
    if (!(pair.y() >= 0.0 && pair.y() <= pair.x() && pair.x() <= kMostFriction)) return false;
    material.static_friction = pair.x();
    material.dynamic_friction = pair.y();
    return true;
  };
  addPair(app, "--friction", take, "S,D with 0 <= D <= S <= 1.5",
          "The surface's coefficients of static and dynamic friction; default: each viewer's own");
}

/// Parses `auto`, `everything` or `STAGE=on|off,...`; nullopt for other texts.
std::optional<PlanSettings> parsePlan(std::string_view text) {
  PlanSettings out;
  if (text == "auto") return out;
  if (text == "everything") {
    out.everything = true;
    return out;
  }
  while (true) {
    const std::string_view item = text.substr(0, text.find(','));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    const auto* const name =
        std::find(kStageNames.begin(), kStageNames.end(), item.substr(0, equals));
    const std::string_view value = item.substr(equals + 1);
    if (name == kStageNames.end() || (value != "on" && value != "off")) return std::nullopt;
    out.forced[static_cast<std::size_t>(name - kStageNames.begin())] = value == "on";
    if (item.size() == text.size()) return out;
    text.remove_prefix(item.size() + 1);
  }
}

/// Sets the plan, without changing the error budget; the order of both flags does not matter.
void addPlan(CLI::App& app, PlanSettings& plan) {
  const auto set = [&plan](const std::string& text) {
    const std::optional<PlanSettings> parsed = parsePlan(text);
    if (!parsed) {
      const std::vector<std::string> stages(kStageNames.begin(), kStageNames.end());
      throw CLI::ValidationError("--plan",
                                 quote(text) +
                                     " is not auto, everything or STAGE=on|off,... with the "
                                     "stages " +
                                     join(stages, ", "));
    }
    plan.everything = parsed->everything;
    plan.forced = parsed->forced;
  };
  app.add_option_function<std::string>(
         "--plan", set,
         "The stages of the scene plan: auto leaves out the stages that a scene does not need, "
         "everything keeps every stage, and STAGE=on|off sets segment, clean, smooth, motion, grid "
         "or heights")
      ->type_name("auto|everything|STAGE=on|off,...");
}

void addSourceOptions(CLI::App& app, Settings& settings) {
  app.add_option(
         "--source", settings.source,
         "The video to stream: synthetic:bounce|approach|tumble|still, a folder of RGB-D "
         "images (rgb/ and depth/, or TUM's rgb.txt and depth.txt), COLOR,DEPTH (two video "
         "files), FILE (one video file with colour and depth), camera:N,M (colour camera, depth "
         "camera), or "
         "nats://HOST[:PORT][,HOST2]/CHANNEL (an edge: it forwards the stream that an origin "
         "publishes)")
      ->required();
  addNumber(app, "--fps", settings.fps, 1.0, 240.0, "1..240",
            "Frames a second; default: the source's own");
  addChoice(
      app, "--layout", settings.layout.layout, kLayouts,
      "The place of the depth in a single video file: a track of its own (separate), or a half "
      "of the picture. Colour is on the left or at the top; with --depth-code hue it is on the "
      "right or below. Default: separate");
  CLI::Option* const code =
      addChoice(app, "--depth-code", settings.layout.code, kDepthCodes,
                "Depth with 8 bits: grey (near is bright), inverse (as --depth-near dark), or, in "
                "videos, hue (Record3D: 3 m for the whole circle of hues). Default: grey");
  addChoice(app, "--depth-near", settings.layout.code, kDepthNear,
            "Where grey depth with 8 bits is near, in folders and videos. Default: bright")
      ->excludes(code);
  app.add_flag("--loop", settings.loop, "Start again at the end of the clip");
  app.add_flag("--to-and-fro", settings.to_and_fro,
               "Play the images of a folder forwards, then backwards; with --loop no jump remains");
  app.add_flag("--wait-for-viewer", settings.wait_for_viewer,
               "Begin to play when the first viewer has joined");
  addNumber(app, "--frames", settings.frames, std::uint64_t{1}, std::uint64_t{1'000'000'000}, "N",
            "Stop after N frames");
}

/// Parses "U,V" or "U,V@SECONDS".
std::optional<AuthorPoint> parsePoint(const std::string& text) {
  const std::size_t at = text.find('@');
  const auto place_px = parsePair(text.substr(0, at));
  if (!place_px) return std::nullopt;
  if (at == std::string::npos) return AuthorPoint{*place_px, 0.0};
  const auto time_s = parseNumberInRange<double>(text.substr(at + 1), 0.0, kLongestClip_s);
  if (!time_s) return std::nullopt;
  return AuthorPoint{*place_px, *time_s};
}

void addPoints(CLI::App& app, VisionSettings& vision) {
  addList(app, "--object", vision.object_points, parsePoint,
          "A pixel on the object to touch, in the first frame or SECONDS after it; repeat for "
          "several. Default: the nearest compact object",
          "U,V[@SECONDS] in px, for example 505,330 or 505,330@1.5");
  addList(app, "--not", vision.not_points, parsePoint,
          "A pixel that does not belong to the object, in the first frame or SECONDS after it; "
          "repeat for several",
          "U,V[@SECONDS] in px, for example 300,400 or 300,400@1.5");
}

void addVisionOptions(CLI::App& app, VisionSettings& vision) {
  addPoints(app, vision);
  addChoice(app, "--segment", vision.segment, kSegmentModes,
            "The segmentation: the source's mask (source), a mask tracked from frame to frame in a "
            "band around its contour (band), or closed Canny edges (edges). auto: the source's "
            "mask if there is one, else band");
  addRanges(app, vision);
  addNumber(
      app, "--fov", vision.fov_deg, 10.0, 170.0, "DEG 10..170",
      "The horizontal field of view of the colour camera; default: the clip's intrinsics, else 56");
  app.add_flag("--stretch", vision.stretch,
               "Stretch the picture over the whole 160 x 120 mm (the thesis's two scales)");
  addChoice(app, "--motion", vision.motion, kMotionModes,
            "Velocity from rigid alignment of colour and depth (rgbd), Lucas-Kanade (x, y), depth "
            "differences (z), or none. auto: rgbd");
  app.add_flag("--low-latency", vision.low_latency,
               "One frame of lookahead instead of 80 to 120 ms; a live source then has noisier "
               "accelerations and no impacts");
  app.add_flag("--compensate-pan", vision.compensate_pan,
               "The camera pans: measure accelerations and impacts against the background, not "
               "against the picture's frame");
  addNumber(app, "--error-budget", vision.plan.error_budget_N, 0.0, 1.0, "N 0..1",
            "The force error that left-out stages and rounded heights on the wire may cause; "
            "default: 0.007, a tenth of the smallest difference that a hand perceives at 1 N");
  addPlan(app, vision.plan);
  addChoice(app, "--method", vision.method, kMethods,
            "hapticast, or every stage as in the thesis: edges, Gaussian, zero outside the mask, "
            "dense grid, stretched");
}

void addName(CLI::App& app, std::string& name) {
  const auto set = [&name](const std::string& text) {
    if (text.empty() || text.size() > limits::kStreamName) {
      throw CLI::ValidationError("--name", "has " + std::to_string(text.size()) +
                                               " bytes; allowed is a text of 1 to " +
                                               std::to_string(limits::kStreamName));
    }
    name = text;
  };
  app.add_option_function<std::string>(
         "--name", set,
         "The stream's name for the viewers; default: the name of the folder or file")
      ->type_name("TEXT");
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

void addNetworkOptions(CLI::App& app, Settings& settings) {
  addEndpoint(app, "--listen", settings.listen, 0, "[ADDR:]PORT, an IP address or [V6ADDRESS]:PORT",
              "The address for clients: an IP address of this machine and a port; default: "
              "0.0.0.0:7447 (all addresses); port 0: any free port");
  addChoice(app, "--transport", settings.datagrams, kTransports,
            "udp: the server sends frames by UDP to viewers that can receive them, else by TCP; "
            "tcp: all frames by TCP. Default: udp");
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
      throw CLI::ValidationError("--publish", quote(text) + " is not " + kNatsForm);
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

std::optional<KeyBytes> parseOriginKey(const std::string& text) { return parseKey(text); }

void addOriginKey(CLI::App& app, std::vector<KeyBytes>& keys) {
  addList(
      app, "--origin-key", keys, parseOriginKey,
      "A public key that the origin of this edge may have, or the other origins of the channel; "
      "repeat for several. Default: any key, but with --signing-key only its own",
      "KEY (64 hex digits of the origin's public key)");
}

/// Refuses each flag that only a server with a source of its own can obey.
void requireEdgeFlags(const CLI::App& app) {
  const std::vector<std::string> allowed{"--source",    "--listen",        "--transport",
                                         "--multicast", "--multicast-ttl", "--max-clients",
                                         "--announce",  "--nats-creds",    "--nats-ca",
                                         "--quiet",     "--config"};
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || std::find(allowed.begin(), allowed.end(), name) != allowed.end())
      continue;
    throw CLI::ValidationError(
        name, name == "--publish"
                  ? "an edge publishes nothing; clusters and leaf nodes of NATS pass streams on"
                  : "an edge forwards an origin's stream; give this flag to the origin");
  }
}

/// Adds the flags of the objects' material and mass.
void addMaterialOptions(CLI::App& app, VisionSettings& vision) {
  addNumber(app, "--stiffness", vision.material.stiffness_N_mm, 0.01, 10.0, "N/MM 0.01..10",
            "The surface's stiffness; default: each viewer's own");
  addFriction(app, vision.material);
  addNumber(app, "--damping", vision.material.damping_Ns_m, 0.0, 1000.0, "NS/M 0..1000",
            "Damping in addition to the damping that keeps the surface stable; each viewer's "
            "device limits it");
  addNumber(app, "--texture-depth", vision.material.texture_K_mm, 0.0, 1000.0, "MM 0..1000",
            "K of the thesis's Eq. 3 (viewers with --surface perturbed); default: 30");
  addNumber(app, "--mass", vision.mass_kg, 0.001, 100.0, "KG 0.001..100",
            "The object's mass for the dynamic force; default: each viewer's choice");
}

}  // namespace

std::unique_ptr<CLI::App> commandLine(Settings& settings) {
  auto app = std::make_unique<CLI::App>(
      "Turns RGB-D video into haptic frames and streams them to hapticast-client. Ctrl-C ends the "
      "server.",
      "hapticast-server");
  addVersion(*app, std::string("sources: synthetic, images, videos, cameras; transports: udp, "
                               "multicast, tcp; discovery: ") +
                       (kHasDiscovery ? "Avahi" : "none") +
                       "; relays: " + (kHasRelays ? "NATS" : "none"));
  addSourceOptions(*app, settings);
  addNetworkOptions(*app, settings);
  addRelayOptions(*app, settings);
  addOriginKey(*app, settings.origin_keys);
  addName(*app, settings.name);
  addVisionOptions(*app, settings.vision);
  addMaterialOptions(*app, settings.vision);
  addPreview(*app, settings.preview);
  app->add_flag(
      "--explain", settings.explain,
      "Log the stages that the server leaves out for each object, with reason, saving and cost");
  app->add_flag("--quiet", settings.quiet, "Only warnings and errors");
  addConfigFile(*app);
  app->final_callback([&settings, parsed = app.get()] {
    if (isEdge(settings)) return requireEdgeFlags(*parsed);
    if (!settings.origin_keys.empty() && !settings.publish)
      throw CLI::ValidationError("--origin-key", "needs --source nats://... or --publish");
  });
  return app;
}

std::optional<int> readCommandLine(Settings& settings, int argc, const char* const* argv) {
  const auto app = commandLine(settings);
  return parseCommandLine(*app, argc, argv);
}

bool isEdge(const Settings& settings) { return settings.source.starts_with(kNatsScheme); }

double heightError_mm(const VisionSettings& vision) {
  // Chosen: larger steps between slices are perceptible as edges.
  constexpr double kMost_mm = 0.25;
  const double stiffness_N_mm = vision.material.stiffness_N_mm.value_or(kUsualStiffness_N_mm);
  const double usual_N = kUsualStiffness_N_mm * kDefaultHeightError_mm;
  const double share = vision.plan.error_budget_N / PlanSettings{}.error_budget_N;
  return std::min(share * usual_N / stiffness_N_mm, kMost_mm);
}

}  // namespace hapticast::server
