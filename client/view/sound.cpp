// SPDX-License-Identifier: MIT
#if HAPTICAST_SDL2
#include "client/view/sound.hpp"

#include <SDL.h>

#include <stdexcept>
#include <utility>

namespace hapticast::client {

namespace {

constexpr std::uint16_t kBuffer = 512;  // chosen: 11 ms, the cycle of the main thread
constexpr std::uint32_t kFade_ms = 60;  // four times the hum's smoothing

[[noreturn]] void noSound(const std::string& why) {
  SDL_QuitSubSystem(SDL_INIT_AUDIO);
  throw std::runtime_error("no sound device (" + why + ")");
}

}  // namespace

SoundView::SoundView(bool plays_force, std::function<void(const std::string& line)> log_line)
    : log_(std::move(log_line)), plays_force_(plays_force) {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C belongs to the client
  if (SDL_InitSubSystem(SDL_INIT_AUDIO) != 0)
    throw std::runtime_error(std::string("no sound device (") + SDL_GetError() + ")");
  // A check in advance: ALSA would print many lines without a device.
  if (SDL_GetNumAudioDevices(0) == 0) noSound("none was found");
  SDL_AudioSpec wanted{};
  wanted.freq = SoundMixer::kRate_Hz;
  wanted.format = AUDIO_F32SYS;
  wanted.channels = 1;
  wanted.samples = kBuffer;
  wanted.callback = fill;
  wanted.userdata = this;
  device_ = SDL_OpenAudioDevice(nullptr, 0, &wanted, nullptr, 0);
  if (device_ == 0) noSound(SDL_GetError());
  SDL_PauseAudioDevice(device_, 0);
}

SoundView::~SoundView() {
  SDL_CloseAudioDevice(device_);
  SDL_QuitSubSystem(SDL_INIT_AUDIO);
}

void SoundView::onReport(const TickReport& report) {
  if (!plays_force_) return;
  latest_.force = meter_.next(report);
  latest_.tick = report.tick;
  cue_.store(latest_);
}

bool SoundView::update(UiState& ui_state) {
  if (latest_.beeps != ui_state.beeps) {
    latest_.beeps = ui_state.beeps;
    cue_.store(latest_);
  }
  const bool lost = SDL_GetAudioDeviceStatus(device_) == SDL_AUDIO_STOPPED;
  if (lost && log_) std::exchange(log_, nullptr)("sound device disconnected: no sound from now on");
  return true;
}

void SoundView::finish() {
  latest_.force = {};
  cue_.store(latest_);
  SDL_Delay(kFade_ms);
}

void SoundView::fill(void* view, std::uint8_t* bytes, int size_bytes) noexcept {
  auto& self = *static_cast<SoundView*>(view);
  const std::size_t count = static_cast<std::size_t>(size_bytes) / sizeof(float);
  self.mixer_.fill({reinterpret_cast<float*>(bytes), count}, self.cue_.load());
}

}  // namespace hapticast::client

#endif  // HAPTICAST_SDL2
