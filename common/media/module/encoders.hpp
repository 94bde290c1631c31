// SPDX-License-Identifier: MIT
// The encoders of hapticast-media.so. media_module.hpp has their agreements.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/media/media_module.hpp"

namespace hapticast::media {

/// Implements MediaModule::openFilm().
[[nodiscard]] std::unique_ptr<FilmEncoder> openFilm(const std::string& file,
                                                    const FilmFormat& format);

/// Implements MediaModule::encodePng().
[[nodiscard]] std::vector<unsigned char> encodePng(const BgrPixels& picture);

}  // namespace hapticast::media
