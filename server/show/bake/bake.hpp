// SPDX-License-Identifier: MIT
// The producer of `hapticast-server bake`: computes a clip with OfflineVision and writes a
// recording (BakedFile). It has no port and no pace, and drops no frame. Thread: main.
#pragma once

#include <memory>

#include "common/time.hpp"
#include "server/settings/settings.hpp"
#include "server/show/producer.hpp"

namespace hapticast::server {

/// Returns the producer of a bake. It logs the end; Show::run() returns false if a signal has
/// interrupted it. `settings` and `clock` must outlive the producer. Throws RecordingError with one
/// line if the folder of `settings.bake.out` cannot be created; Show::run() then throws SourceError
/// or RecordingError for wrong input, and std::runtime_error for a failure at run time.
[[nodiscard]] std::unique_ptr<Producer> makeBakeProducer(const Settings& settings,
                                                         const Clock& clock);

}  // namespace hapticast::server
