// SPDX-License-Identifier: MIT
// Recognises files that are no video, by their first bytes: older recordings of robots and apps,
// archives, arrays, single pictures. Thread: any.
#pragma once

#include <string>

namespace hapticast::server {

/// Throws SourceError for a file of a known kind that is no video. The message names the kind and
/// the remedy. Returns for all other files.
void refuseKnownFile(const std::string& file);

}  // namespace hapticast::server
