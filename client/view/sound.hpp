// SPDX-License-Identifier: MIT
// The view of --sound. It plays the force as sound on SDL's audio device, and the beeps of a study.
// SDL requests the samples in a thread of SDL. Thread: main; the mixer runs in SDL's thread.
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
  /// Opens the sound device. `plays_force`: false for beeps only. If the device is lost later,
  /// `log_line` receives a line in the main thread. Throws std::runtime_error (one line) if there
  /// is no sound device.
  SoundView(bool plays_force, std::function<void(const std::string& line)> log_line);
  SoundView(const SoundView&) = delete;
  SoundView& operator=(const SoundView&) = delete;
  ~SoundView() override;

  void onPicture(VideoFrame /*picture*/, const Workspace& /*workspace*/) override {}
  void onReport(const TickReport& report) override;
  [[nodiscard]] bool update(UiState& ui_state) override;
  /// Fades the sound out. The destructor closes the device.
  void finish() override;
  [[nodiscard]] bool wantsVideo() const override { return false; }

 private:
  static void fill(void* view, std::uint8_t* bytes, int size_bytes) noexcept;

  std::function<void(const std::string& line)> log_;  // null: the loss was reported
  bool plays_force_;
  TransientDetector meter_;
  SoundCue latest_;
  LatestValue<SoundCue> cue_;  // latest_, for SDL's thread
  SoundMixer mixer_;           // SDL's thread
  std::uint32_t device_ = 0;
};

}  // namespace hapticast::client
