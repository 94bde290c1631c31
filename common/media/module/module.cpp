// SPDX-License-Identifier: MIT
// The function that hapticast-media.so exports.
extern "C" {
#include <libavutil/log.h>
}

#include "common/media/media_module.hpp"
#include "common/media/module/encoders.hpp"

namespace hapticast::media {

namespace {

class Module final : public MediaModule {
 public:
  [[nodiscard]] std::unique_ptr<FilmEncoder> openFilm(const std::string& file,
                                                      const FilmFormat& format) const override {
    return media::openFilm(file, format);
  }
  [[nodiscard]] std::vector<unsigned char> encodePng(const BgrPixels& picture) const override {
    return media::encodePng(picture);
  }
};

}  // namespace

}  // namespace hapticast::media

extern "C" __attribute__((visibility("default"))) const hapticast::MediaModule* hapticast_media(
    std::uint32_t version) {
  if (version != hapticast::kMediaModuleVersion) return nullptr;
  av_log_set_level(AV_LOG_QUIET);  // the program reports errors with its own lines
  static const hapticast::media::Module kModule;
  return &kModule;
}
