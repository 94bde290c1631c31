// SPDX-License-Identifier: MIT
#include "server/app.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <thread>
#include <utility>

#include "common/cli/hang_up.hpp"
#include "server/author_points.hpp"
#include "server/clip_look.hpp"
#include "server/source/playback.hpp"
#include "server/stream/file_limit.hpp"

namespace hapticast::server {

namespace {

// How long viewers get to play out the end of a clip before the server says goodbye.
constexpr Duration kPlayout = std::chrono::milliseconds(500);
// The protocol's page promises viewers a word about once a second.
constexpr Duration kPrepareEvery = std::chrono::seconds(1);
// Whoever waits looks so often whether stop() was called; chosen.
constexpr Duration kSlice = std::chrono::milliseconds(20);

std::optional<MulticastGroup> groupOf(asio::io_context& io, const Settings& settings) {
  if (!settings.multicast) return std::nullopt;
  return MulticastGroup(io, *settings.multicast, static_cast<int>(settings.multicast_hops));
}

SourceInfo infoOf(const RgbdSource& source, const std::string& name) {
  SourceInfo info = source.info();
  if (!name.empty()) info.name = name;
  return info;
}

}  // namespace

App::App(Settings settings, const Clock& clock)
    : settings_(std::move(settings)),
      media_clock_(clock),
      source_(openSource(settings_.source, settings_.fps)),
      vision_(infoOf(*source_, settings_.name), withinClip(settings_.vision, source_->info()),
              &clock),
      broadcaster_(io_, clock, media_clock_, vision_.description(),
                   StreamSettings{.max_clients = raiseFileLimit(settings_.max_clients)}),
      listener_(io_, settings_.listen, broadcaster_) {
  if (!settings_.announce.empty()) requireReachable(listener_.endpoint().address());
  if (!settings_.datagrams) {
    if (settings_.multicast) throw AddressError("--multicast: --transport tcp sends no datagrams");
    return;
  }
  datagrams_.emplace(io_, clock, listener_, settings_);
  broadcaster_.carryDatagrams(datagrams_->sender);
}

App::Datagrams::Datagrams(asio::io_context& io, const Clock& clock, const Listener& listener,
                          const Settings& settings)
    : group(groupOf(io, settings)),
      sender(io, clock, listener.endpoint(), signer, group ? &*group : nullptr) {}

void App::run() {
  asio::signal_set signals(io_, SIGINT, SIGTERM);
  if (!hangUpIgnored()) signals.add(SIGHUP);
  signals.async_wait([this, &signals](const boost::system::error_code& error, int) {
    if (error) return;
    stop();
    signals.clear();  // a second one ends what does not hear the first
  });
  std::jthread network([this] { io_.run(); });
  const auto end = [&] {
    announcer_.reset();
    listener_.stop();
    broadcaster_.stop();
    asio::post(io_, [&signals] { signals.cancel(); });
  };
  try {
    look();
    const SliceSettings slices{.error_mm = heightError_mm(settings_.vision)};
    if (settings_.explain) spdlog::info("heights travel within {:.3g} mm", slices.error_mm);
    EncoderThread encoder({&broadcaster_},  // a further sink is named here
                          datagrams_ ? &datagrams_->signer : nullptr, slices);
    if (!stop_) play(encoder);
    encoder.finish();
  } catch (...) {
    end();
    throw;
  }
  end();
}

void App::look() {
  const SourceInfo& info = source_->info();
  if (settings_.vision.fov_deg && info.camera) {
    spdlog::info("--fov {:g}: overrules what the source says of its camera ({:.1f} degrees)",
                 *settings_.vision.fov_deg, info.camera->degreesAcross(info.width_px));
  }
  MediaTime told{};
  const auto tell = [&](double share) {
    open();
    const MediaTime now = media_clock_.now();
    if (told != MediaTime{} && now - told < kPrepareEvery) return;
    told = now;
    broadcaster_.prepare(share);
  };
  if (lookThrough(vision_, *source_, media_clock_, stop_, tell))
    broadcaster_.describe(vision_.description());
  range_teller_.tell(vision_.mapped());
}

void App::open() {
  if (open_) return;
  open_ = true;
  spdlog::info("listening on {}; Ctrl-C ends it", toString(listener_.address()));
  listener_.start();
  if (!settings_.announce.empty())
    announcer_.emplace(settings_.announce, listener_.endpoint(), vision_.description().name);
}

void App::waitForViewer() const {
  if (broadcaster_.viewers() > 0) return;
  spdlog::info("waiting for the first viewer");
  while (!stop_ && broadcaster_.viewers() == 0) waitUntil(media_clock_.now() + kSlice);
}

void App::play(EncoderThread& encoder) {
  const SourceInfo& info = source_->info();
  open();
  if (settings_.wait_for_viewer) waitForViewer();
  spdlog::info("streaming {} ({} x {}, {:g} frames/s)", settings_.source, info.width_px,
               info.height_px, info.fps);
  streaming_ = true;
  Pacer pacer(info.fps, media_clock_.now());
  std::uint64_t frames = 0;
  while (!stop_ && (settings_.frames == 0 || frames < settings_.frames)) {
    const auto frame = nextFrame(pacer);
    if (!frame) break;
    const MediaTime media_time =
        info.live ? media_clock_.now() : pacer.frameRead(frame->epoch, frame->index);
    ++frames;
    if (auto result = vision_.push(*frame, media_time)) publish(std::move(*result), encoder);
    range_teller_.tell(vision_.mapped());
    if (settings_.explain)
      plan_teller_.tell(vision_.plan(), encoder.reliefBytes(), media_clock_.now());
    sayWhatWasSkipped(pacer);
  }
  for (VisionResult& result : vision_.flush()) publish(std::move(result), encoder);
  waitUntil(last_published_ + vision_.description().pipeline_latency + kPlayout);
}

std::optional<RgbdFrame> App::nextFrame(Pacer& pacer) {
  if (source_->info().live) return source_->read();
  const Pacer::Plan plan = pacer.plan(media_clock_.now());
  waitUntil(plan.due);
  return readOn(*source_, plan.skip, settings_.loop && !stop_);
}

void App::publish(VisionResult result, EncoderThread& encoder) {
  last_published_ = result.frame.media_time;
  encoder.push(vision_.description(), std::move(result));
}

void App::sayWhatWasSkipped(const Pacer& pacer) {
  const MediaTime now = media_clock_.now();
  // At once where it begins, then once a minute with the sum.
  const Duration pause = told_skipped_ == 0 ? std::chrono::seconds(1) : std::chrono::minutes(1);
  if (pacer.skipped() == told_skipped_ || now - told_at_ < pause) return;
  spdlog::warn("too slow for {:g} frames/s: {} frames skipped so far", source_->info().fps,
               pacer.skipped());
  told_skipped_ = pacer.skipped();
  told_at_ = now;
}

void App::waitUntil(MediaTime due) const {
  while (!stop_) {
    const Duration left = due - media_clock_.now();
    if (left <= Duration::zero()) return;
    std::this_thread::sleep_for(std::min(left, kSlice));
  }
}

}  // namespace hapticast::server
