// SPDX-License-Identifier: MIT
#include "client/recording/replay.hpp"

#include <algorithm>
#include <bit>
#include <cfenv>
#include <utility>

#include "client/device/loop/realtime_thread.hpp"

namespace hapticast::client {

namespace {

// Bytes that are read ahead for the inputs of a tick; chosen: far more than a run needs.
constexpr std::size_t kMostAheadBytes = 64U << 20U;

/// Reads up to the first ticks. Returns why the recording cannot be rendered; nullopt: it can.
std::optional<Error> findObstacle(TypedReader<RecordedContent>& file) {
  bool has_settings = false;
  while (const auto message = file.next(kRunMessages & ~kShownMessages)) {
    const auto content = file.decode(*message);
    if (!content) break;
    has_settings = has_settings || std::holds_alternative<RendererSettings>(*content);
    const auto* const ticks = std::get_if<std::vector<TickReport>>(&*content);
    if (ticks == nullptr || ticks->empty()) continue;
    if (has_settings) return std::nullopt;
    break;
  }
  return has_settings ? file.makeLackError("ticks") : Error{"has no settings before its ticks"};
}

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

Result<std::unique_ptr<Replay>> Replay::open(const std::string& file,
                                             const ReadProgress& progress) {
  auto opened = TypedReader<RecordedContent>::open(file, listRecordedTypes(), progress);
  if (!opened.ok()) return opened.error();
  if (!opened.value().has(kTickMessages))
    return Error{"has no channel /tick: it is no recording of hapticast-client"};
  if (auto obstacle = findObstacle(opened.value())) return std::move(*obstacle);
  opened.value().seek(0);
  return std::unique_ptr<Replay>(new Replay(std::move(opened).value()));
}

bool Replay::readMessage() {
  const auto message = file_.next(kRunMessages);
  if (!message) return false;
  ahead_bytes_ += message->data.size();
  const auto channel = static_cast<RunChannel>(message->channel);
  if ((setOf(channel) & kShownMessages) == 0) {
    auto content = file_.decode(*message);
    if (!content) return false;
    std::visit([this](auto& each) { add(std::move(each)); }, *content);
  }
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
    file_.setProblem("lacks ticks");
    return false;
  }
  last_tick_ = tick.tick;
  while (!hasInputsOf(tick)) {
    if (ahead_bytes_ <= kMostAheadBytes && readMessage()) continue;
    file_.setProblem("lacks what a tick has read");
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
    file_.setProblem("lacks a frame");
    return false;
  }
  for (std::size_t i = 0; i <= *place; ++i) {
    StreamEvent event = std::move(events_.front());
    events_.pop_front();
    if (const auto* const workspace = std::get_if<Workspace>(&event)) {
      queue_.reset(*workspace);
      continue;
    }
    (void)queue_.push(std::move(std::get<AssembledFrame>(event)));
    if (i < *place || !next.handed_over) queue_.dropAll();
  }
  if (const auto accepted = queue_.pop()) preparer_->prepare(*accepted);
  handed_over_ += next.handed_over ? 1 : 0;
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
  preparer_.emplace(pool_, clock_, settings_.method, [](const PreparedFrame&) {});
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
