// SPDX-License-Identifier: MIT
#include "common/cli/program_flags.hpp"

#include <algorithm>
#include <array>

namespace hapticast {

namespace {

// The tool would put each of so many words on a line of its own.
// clang-format off
constexpr auto kServerFlags = std::to_array<std::string_view>(
    {"announce",    "color",         "compensate-pan", "damping", "depth",           "depth-code",
     "depth-cache", "depth-cache-limit", "depth-from", "mask-from",
     "depth-range", "depth-unit",    "error-budget",   "explain", "fov",             "fps",
     "frames",      "friction",      "host-name",      "http",    "layout",          "listen",
     "loop",        "low-latency",   "map-range",      "mass",    "max-clients",     "motion",
     "multicast",   "multicast-ttl", "name",           "nats-ca", "nats-creds",      "not",
     "object",      "plan",          "preview",        "publish", "scene",           "segment",
     "signing-key", "source",        "stretch",        "texture-depth", "tls",       "tls-cert",
     "tls-key",     "to-and-fro",    "tokens",         "on-demand", "page",    "topics", "vision-threads",
     "wait-for-viewer"});
constexpr auto kClientFlags = std::to_array<std::string_view>(
    {"check-device",    "control",     "device",        "device-option", "falcon-calibrate",
     "falcon-firmware", "falcon-gain", "falcon-serial", "fault-dir",     "film",
     "forces",          "fullscreen",  "hand",          "interface",     "list",
     "list-devices",    "log",         "markers",       "max-delay",
     "profile",         "rearm",       "redundancy",    "replay",        "screenshot",      "seconds",     "simulate",      "sound",         "stiffness-limit",
     "study",           "subject",     "summary",       "surface",       "tls-ca",
     "token-file",      "view"});
// clang-format on

}  // namespace

std::span<const std::string_view> ownFlags(std::string_view program) {
  if (program == kServerProgram) return kServerFlags;
  return kClientFlags;
}

std::string_view ownerOfFlag(std::string_view flag, std::string_view program) {
  std::string_view name = flag.substr(0, flag.find('='));
  if (name.starts_with("--")) name.remove_prefix(2);
  const std::string_view other = program == kServerProgram ? kClientProgram : kServerProgram;
  const auto flags = ownFlags(other);
  return std::find(flags.begin(), flags.end(), name) == flags.end() ? "" : other;
}

}  // namespace hapticast
