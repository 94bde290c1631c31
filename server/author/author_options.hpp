// SPDX-License-Identifier: MIT
// The author's flags: the objects that viewers can touch, how vision finds them, and their
// material. A scene file (scene_file.hpp) can set each of them. Thread: main, at start-up.
#pragma once

#include <optional>
#include <string>

#include "common/cli/cli11.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Latest time in a clip that a flag may contain, s. Chosen: eleven days.
inline constexpr double kLongestClip_s = 1e6;

/// Returns the point in a text "U,V" or "U,V@SECONDS". Returns nullopt for other texts.
[[nodiscard]] std::optional<AuthorPoint> parsePoint(const std::string& text);

/// Adds the flags of vision to `app`. They write to `vision`, which must outlive `app`.
void addVisionOptions(CLI::App& app, VisionSettings& vision);

/// Adds the flags of an object's material and mass to `app`. They write to `material` and
/// `mass_kg`, which must outlive `app`.
void addMaterialOptions(CLI::App& app, Material& material, std::optional<double>& mass_kg);

/// Adds the flag of the stream's name to `app`. It writes to `name`, which must outlive `app`.
void addName(CLI::App& app, std::string& name);

}  // namespace hapticast::server
