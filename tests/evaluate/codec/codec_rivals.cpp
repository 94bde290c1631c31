// SPDX-License-Identifier: MIT
#include "tests/evaluate/codec/codec_rivals.hpp"

#ifdef HAPTICAST_CHARLS
#include <charls/charls_jpegls_decoder.h>
#include <charls/charls_jpegls_encoder.h>
#endif
#ifdef HAPTICAST_ZSTD
#include <zstd.h>
#endif

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "tests/evaluate/thread_time.hpp"

namespace hapticast::evaluate {

namespace {

using Pixels = std::vector<std::uint16_t>;

// Heights in steps from 1 mm below the picture's plane on; the error is half a step.
Pixels rounded(const Relief& relief, double step_mm) {
  Pixels out(relief.mask.size(), 0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (relief.mask[i] == 0) continue;
    out[i] = static_cast<std::uint16_t>(
        std::clamp(std::lround((double(relief.height_mm[i]) + 1.0) / step_mm), 0L, 65535L));
  }
  return out;
}

double worst_mm(const Relief& relief, const Pixels& pixels, double step_mm) {
  double worst = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (relief.mask[i] == 0) continue;
    worst = std::max(worst, std::abs(pixels[i] * step_mm - 1.0 - double(relief.height_mm[i])));
  }
  return worst;
}

Coded plain(const Relief& relief, double error_mm) {
  Coded out;
  const double start_us = threadTime_us();
  const Pixels pixels = rounded(relief, 2.0 * error_mm);
  out.encode_us = threadTime_us() - start_us;
  out.bytes = 2 * pixels.size();
  out.error_mm = worst_mm(relief, pixels, 2.0 * error_mm);
  return out;
}

Coded png(const Relief& relief, double error_mm) {
  Pixels pixels = rounded(relief, 2.0 * error_mm);
  const cv::Mat image(relief.rect.height, relief.rect.width, CV_16UC1, pixels.data());
  Coded out;
  std::vector<uchar> bytes;
  const double start_us = threadTime_us();
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6});
  const double middle_us = threadTime_us();
  const cv::Mat back = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  out.decode_us = threadTime_us() - middle_us;
  out.encode_us = middle_us - start_us;
  out.bytes = bytes.size();
  out.error_mm = worst_mm(relief, Pixels(back.begin<std::uint16_t>(), back.end<std::uint16_t>()),
                          2.0 * error_mm);
  return out;
}

#ifdef HAPTICAST_ZSTD
Coded zstd(const Relief& relief, double error_mm) {
  const Pixels pixels = rounded(relief, 2.0 * error_mm);
  const std::size_t size = 2 * pixels.size();
  std::vector<char> bytes(ZSTD_compressBound(size));
  Coded out;
  const double start_us = threadTime_us();
  out.bytes = ZSTD_compress(bytes.data(), bytes.size(), pixels.data(), size, 3);
  const double middle_us = threadTime_us();
  Pixels back(pixels.size());
  ZSTD_decompress(back.data(), size, bytes.data(), out.bytes);
  out.decode_us = threadTime_us() - middle_us;
  out.encode_us = middle_us - start_us;
  out.error_mm = worst_mm(relief, back, 2.0 * error_mm);
  return out;
}
#endif

#ifdef HAPTICAST_CHARLS
Coded jpegLs(const Relief& relief, double error_mm, int near) {
  const double step_mm = 2.0 * error_mm / (2 * near + 1);
  const Pixels pixels = rounded(relief, step_mm);
  charls::jpegls_encoder encoder;
  encoder.frame_info({static_cast<std::uint32_t>(relief.rect.width),
                      static_cast<std::uint32_t>(relief.rect.height), 16, 1});
  encoder.near_lossless(near);
  std::vector<std::uint8_t> bytes(encoder.estimated_destination_size() + 4 * pixels.size());
  encoder.destination(bytes);
  Coded out;
  const double start_us = threadTime_us();
  out.bytes = encoder.encode(pixels);
  const double middle_us = threadTime_us();
  bytes.resize(out.bytes);
  charls::jpegls_decoder decoder(bytes, true);
  const auto back = decoder.decode<Pixels>();
  out.decode_us = threadTime_us() - middle_us;
  out.encode_us = middle_us - start_us;
  out.error_mm = worst_mm(relief, back, step_mm);
  return out;
}
#endif

}  // namespace

std::vector<Rival> codecRivals() {
  std::vector<Rival> out{{"plain 16 bit", plain}, {"PNG", png}};
#ifdef HAPTICAST_ZSTD
  out.push_back({"zstd", zstd});
#endif
#ifdef HAPTICAST_CHARLS
  out.push_back({"JPEG-LS", [](const Relief& relief, double error_mm) {
                   Coded best = jpegLs(relief, error_mm, 0);
                   for (const int near : {1, 2}) {
                     const Coded other = jpegLs(relief, error_mm, near);
                     if (other.bytes < best.bytes) best = other;
                   }
                   return best;
                 }});
#endif
  return out;
}

}  // namespace hapticast::evaluate
