// SPDX-License-Identifier: MIT
// The functions of hapticast-media.so, which encodes films and pictures with libav (FFmpeg).
// load_media_module.hpp opens this file when a program needs it, so that no program loads libav at
// its start. Program and module are built from the same sources.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hapticast {

/// Version of the classes below. A change of them needs a new version.
inline constexpr std::uint32_t kMediaModuleVersion = 1;

/// Pixels of a picture, owned by the caller: rows of blue, green, red with 8 bits each.
struct BgrPixels {
  const std::uint8_t* data = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::ptrdiff_t stride_bytes = 0;  ///< from one row to the next
};

/// Size and rate of a film. `fps` is above 0 and at most 65535. Width and height are even.
struct FilmFormat {
  int width_px = 0;
  int height_px = 0;
  double fps = 0.0;
};

/// Encoder of one film file. After an error only the destructor may be called.
/// Thread: one at a time.
class FilmEncoder {
 public:
  FilmEncoder() = default;
  FilmEncoder(const FilmEncoder&) = delete;
  FilmEncoder& operator=(const FilmEncoder&) = delete;
  /// Removes the file if close() did not complete it.
  virtual ~FilmEncoder() = default;

  /// Appends `picture`, which is shown for 1/fps s. Requires the size of the film. Removes the file
  /// and throws std::runtime_error (one line with the file) if the picture cannot be written.
  virtual void write(const BgrPixels& picture) = 0;
  /// Completes the file. Requires at least one picture. Removes the file and throws like write() if
  /// that fails.
  virtual void close() = 0;
};

/// What the module can do. Thread: any.
class MediaModule {
 public:
  MediaModule() = default;
  MediaModule(const MediaModule&) = delete;
  MediaModule& operator=(const MediaModule&) = delete;
  virtual ~MediaModule() = default;

  /// Opens the MP4 file `file` for a film. The codec is H.264, or MPEG-4 where libav has no H.264
  /// encoder. The encoder's threads have the priority of the calling thread. Throws
  /// std::runtime_error (one line with the file) if there is no encoder or the file cannot be
  /// written.
  [[nodiscard]] virtual std::unique_ptr<FilmEncoder> openFilm(const std::string& file,
                                                              const FilmFormat& format) const = 0;
  /// Encodes `picture` and returns the bytes of a PNG file. Requires a width and a height above 0.
  /// Throws std::runtime_error (one line) if the encoder fails.
  [[nodiscard]] virtual std::vector<unsigned char> encodePng(const BgrPixels& picture) const = 0;
};

/// Type of the one function that the module exports, hapticast_media(). It returns the module, or
/// null if `version` is not its own kMediaModuleVersion. Thread: any.
using MediaModuleFunction = const MediaModule*(std::uint32_t version);

}  // namespace hapticast
