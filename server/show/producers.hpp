// SPDX-License-Identifier: MIT
// The producers of hapticast-server. Each opens its source when it is made, and keeps `settings`
// and `clock`, which must outlive it. Thread: main.
#pragma once

#include <memory>
#include <string>

#include "common/playback/stream_reader.hpp"
#include "common/time.hpp"
#include "server/settings/settings.hpp"
#include "server/show/producer.hpp"

namespace hapticast::server {

/// Returns the producer of a clip or a live source. It ends with the clip (with --loop it repeats),
/// or with the number of frames in --frames. Throws SourceError.
[[nodiscard]] std::unique_ptr<Producer> makeClipProducer(const Settings& settings,
                                                         const Clock& clock);

/// Returns the producer of a recorded stream, without vision, which ends as that of a clip does.
/// Operators can pause it, seek, and change its speed and material. Throws RecordingError.
[[nodiscard]] std::unique_ptr<Producer> makeRecordingProducer(const Settings& settings,
                                                              const Clock& clock);

/// Returns the producer of a recording on demand: each viewer has a time line of its own
/// (ViewerTimeline), which runs in the network thread. With --loop each one repeats. Throws
/// RecordingError.
[[nodiscard]] std::unique_ptr<Producer> makeOnDemandProducer(const Settings& settings,
                                                             const Clock& clock);

/// Returns the producer of an edge: it receives the stream of a channel's origin from NATS, without
/// vision, encoder and signer of its own (RelaySubscriber). The show opens when the first origin is
/// known. Throws SourceError for a wrong address.
[[nodiscard]] std::unique_ptr<Producer> makeEdgeProducer(const Settings& settings,
                                                         const Clock& clock);

/// Returns the producer of a bake, which opens its clip in prepare(). It logs its end. Throws
/// RecordingError with one line if the folder of `settings.bake.out` cannot be created; Show::run()
/// then throws SourceError or RecordingError for wrong input, and std::runtime_error for a failure
/// at run time.
[[nodiscard]] std::unique_ptr<Producer> makeBakeProducer(const Settings& settings,
                                                         const Clock& clock);

/// Opens the recording of a stream `file`. Throws RecordingError with one line that names --source.
[[nodiscard]] StreamReader openRecording(const std::string& file);

}  // namespace hapticast::server
