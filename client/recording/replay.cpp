// SPDX-License-Identifier: MIT
#include "client/recording/replay.hpp"

#include <algorithm>
#include <bit>
#include <cfenv>
#include <utility>

#include "client/loop/realtime_thread.hpp"

namespace hapticast::client {

namespace {

// Bytes that are read ahead for the inputs of a tick; chosen: far more than a run needs.
constexpr std::size_t kMostAheadBytes = 64U << 20U;

}  // namespace

bool hasSameBits(const Vec3& a, const Vec3& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

void ReplayCounts::add(const Vec3& force_N, const Vec3& recorded_N) {
  ++ticks;
  different += hasSameBits(force_N, recorded_N) ? 0 : 1;
  largest_difference_N = std::max(largest_difference_N, (force_N - recorded_N).norm());
}

Result<std::unique_ptr<Replay>> Replay::open(const std::string& file) {
  auto opened = McapReader::open(file);
  if (!opened.ok()) return opened.error();
  // A probe reads up to the first tick. The replay begins at the begin, for its outputs.
  auto reopened = opened.value().reopen();
  if (!reopened.ok()) return reopened.error();
  const std::unique_ptr<Replay> probe(new Replay(std::move(reopened).value()));
  if (!probe->findChannels())
    return Error{"has no channel /tick: it is no recording of hapticast-client"};
  if (auto obstacle = probe->findObstacle()) return std::move(*obstacle);
  std::unique_ptr<Replay> replay(new Replay(std::move(opened).value()));
  (void)replay->findChannels();
  return replay;
}

std::optional<Error> Replay::findObstacle() {
  // The settings precede the first tick.
  while (ticks_.empty() && readMessage()) {
  }
  if (!has_settings_) return Error{"has no settings before its ticks"};
  if (ticks_.empty())
    return Error{problem_.empty() ? "has no ticks" : "has no ticks: it " + problem_};
  return std::nullopt;
}

bool Replay::findChannels() {
  for (const auto& [id, channel] : file_.channels()) {
    for (std::size_t i = 0; i < kRunChannels; ++i) {
      if (channel.schema.name == kRunChannelNames[i].message)
        channels_[id] = static_cast<RunChannel>(i);
    }
  }
  return std::any_of(channels_.begin(), channels_.end(),
                     [](const auto& each) { return each.second == kTickChannel; });
}

template <class Content>
bool Replay::accept(Result<Content> decoded) {
  if (!decoded.ok()) {
    problem_ = "has an invalid message (" + decoded.error().message + ")";
    return false;
  }
  add(std::move(decoded).value());
  return true;
}

bool Replay::readMessage() {
  if (!problem_.empty()) return false;
  const auto message = file_.next();
  if (!message) {
    problem_ = file_.problem();
    return false;
  }
  ahead_bytes_ += message->data.size();
  const auto found = channels_.find(message->channel);
  if (found == channels_.end()) return true;
  const RunChannel channel = found->second;
  if (!readContent(channel, message->data)) return false;
  if (!outputs_.onMessage || channel == kTickChannel) return true;
  if (channel == kSettingsChannel) {
    outputs_.onMessage(channel, message->time_ns, encodeSettings(settings_));
  } else if (channel == kControlsChannel) {
    outputs_.onMessage(channel, message->time_ns, encodeControls(newest_controls_));
  } else {
    outputs_.onMessage(channel, message->time_ns, message->data);
  }
  return true;
}

bool Replay::readContent(RunChannel channel, std::span<const std::uint8_t> data) {
  switch (channel) {
    case kSettingsChannel:
      return accept(decodeSettings(data));
    case kTickChannel:
      return accept(decodeTicks(data));
    case kFrameChannel:
      return accept(decodeReceivedFrame(data));
    case kPreparedChannel:
      return accept(decodePreparation(data));
    case kTimingChannel:
      return accept(decodeTiming(data));
    case kControlsChannel:
      return accept(decodeControls(data));
    default:
      return true;
  }
}

void Replay::add(RendererSettings settings) {
  if (has_settings_) return;  // the renderer refers to the first ones
  has_settings_ = true;
  settings_ = std::move(settings);
  change(settings_);
}

void Replay::add(UserControls controls) {
  if (changes_.method) controls.method.reset();
  if (changes_.surface || changes_.method == Method::kThesis) controls.surface.reset();
  newest_controls_ = controls_[controls.number] = controls;
}

void Replay::add(std::vector<TickReport> ticks) {
  for (TickReport& each : ticks) ticks_.push_back(std::move(each));
}

void Replay::add(AssembledFrame frame) {
  if (frame.place.resync) events_.emplace_back(workspace_);  // as Receiver::release() does
  events_.emplace_back(std::move(frame));
}

void Replay::add(const RecordedTiming& timing) {
  workspace_ = timing.timing.workspace;
  timings_[timing.timing.number] = timing.timing;
  if (timing.resets_reliefs) events_.emplace_back(timing.timing.workspace);
}

bool Replay::hasInputsOf(const TickReport& tick) const {
  const TickInputs& inputs = tick.inputs;
  return known_frames_ >= inputs.frames &&
         (inputs.timing == 0 || timings_.contains(inputs.timing)) &&
         (inputs.controls == 0 || controls_.contains(inputs.controls));
}

bool Replay::readInputsOf(const TickReport& tick) {
  if (tick.tick != last_tick_ + 1) {
    problem_ = "lacks ticks";
    return false;
  }
  last_tick_ = tick.tick;
  while (!hasInputsOf(tick)) {
    if (ahead_bytes_ <= kMostAheadBytes && readMessage()) continue;
    if (problem_.empty()) problem_ = "lacks what a tick has read";
    return false;
  }
  ahead_bytes_ = 0;
  return true;
}

std::optional<std::size_t> Replay::findFrame(std::uint64_t id) const {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const auto* const frame = std::get_if<AssembledFrame>(&events_[i]);
    if (frame != nullptr && frame->frame.id == id) return i;
  }
  return std::nullopt;
}

bool Replay::prepareNext() {
  const RecordedPreparation next = preparations_.front();
  preparations_.pop_front();
  const auto place = findFrame(next.id);
  if (!place) {
    problem_ = "lacks a frame";
    return false;
  }
  for (std::size_t i = 0; i <= *place; ++i) {
    StreamEvent event = std::move(events_.front());
    events_.pop_front();
    if (const auto* const workspace = std::get_if<Workspace>(&event)) {
      preparation_->reset(*workspace);
    } else if (i == *place && next.handed_over) {
      (void)preparation_->push(std::move(std::get<AssembledFrame>(event)));
      (void)preparation_->step();
      ++handed_over_;
    } else {
      preparation_->drop(std::move(std::get<AssembledFrame>(event)));
    }
  }
  return true;
}

void Replay::change(RendererSettings& settings) const {
  settings.method = changes_.method.value_or(settings.method);
  settings.surface = changes_.surface.value_or(settings.surface);
  // As the client does (--method).
  if (changes_.method == Method::kThesis) settings.surface = SurfaceKind::kPerturbed;
  settings.stiffness_N_mm = changes_.stiffness_N_mm.value_or(settings.stiffness_N_mm);
  settings.stiffness_limit_N_mm =
      changes_.stiffness_limit_N_mm.value_or(settings.stiffness_limit_N_mm);
}

ReplayCounts Replay::run(const ReplayChanges& changes, const ReplayOutputs& outputs) {
  changes_ = changes;
  outputs_ = outputs;
  while (!has_settings_ && readMessage()) {
  }
  // The loop flushes denormals, the decode thread does not.
  std::fenv_t decode_mode{}, tick_mode{};
  std::fegetenv(&decode_mode);
  flushDenormals();
  std::fegetenv(&tick_mode);
  LatestValue<StreamTiming> timing;
  LatestValue<UserControls> controls;
  preparation_ = std::make_unique<InlinePreparation>(pool_, clock_, settings_.method,
                                                     [](const PreparedFrame&) {});
  const auto renderer =
      std::make_unique<HapticRenderer>(settings_, pool_, timing, controls, nullptr);
  ReplayCounts counts;
  while (!ticks_.empty() || readMessage()) {
    if (outputs_.stop != nullptr && *outputs_.stop) break;
    if (ticks_.empty()) continue;
    const TickReport recorded = ticks_.front();
    ticks_.pop_front();
    if (!readInputsOf(recorded)) break;
    std::fesetenv(&decode_mode);
    while (handed_over_ < recorded.inputs.frames) {
      if (!prepareNext()) return counts;
    }
    std::fesetenv(&tick_mode);
    if (recorded.inputs.timing != 0) timing.store(timings_.at(recorded.inputs.timing));
    if (recorded.inputs.controls != 0) controls.store(controls_.at(recorded.inputs.controls));
    timings_.erase(timings_.begin(), timings_.lower_bound(recorded.inputs.timing));
    controls_.erase(controls_.begin(), controls_.lower_bound(recorded.inputs.controls));
    if (recorded.inputs.stopping) renderer->stop();
    const TickReport& report = renderer->tick(recorded.time, recorded.inputs.reading);
    counts.add(report.force_N, recorded.force_N);
    if (outputs_.onTick) outputs_.onTick(report);
  }
  return counts;
}

}  // namespace hapticast::client
