// SPDX-License-Identifier: MIT
// The view of --sound, for the ears: the force on SDL's sound device. SDL asks for the samples on a
// thread of its own. Thread: main.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "client/view/sound_mixer.hpp"
#include "client/view/view.hpp"
#include "common/sync/latest_value.hpp"

namespace hapticast::client {

class SoundView final : public View {
 public:
  /// `tell` is called when the device is lost later, on the main thread. Throws
  /// std::runtime_error, one line, where there is no sound device.
  explicit SoundView(std::function<void(const std::string& line)> tell);
  SoundView(const SoundView&) = delete;
  SoundView& operator=(const SoundView&) = delete;
  ~SoundView() override;

  void onPicture(VideoFrame /*picture*/, const Workspace& /*workspace*/) override {}
  void onReport(const TickReport& report) override;
  [[nodiscard]] bool update(UiState& ui_state) override;
  /// The hum fades before the device is closed.
  void finish() override;
  [[nodiscard]] bool wantsVideo() const override { return false; }

 private:
  static void fill(void* view, std::uint8_t* bytes, int size_bytes) noexcept;

  std::function<void(const std::string& line)> log_;  // null: it has been told
  TransientDetector meter_;
  LatestValue<SoundCue> cue_;
  SoundMixer mixer_;  // SDL's thread
  std::uint32_t device_ = 0;
};

}  // namespace hapticast::client
