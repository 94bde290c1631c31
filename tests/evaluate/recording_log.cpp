// SPDX-License-Identifier: MIT
// A recording can have millions of ticks. So each curve keeps the least and the largest value of
// each of kBins parts of the time, which is what the picture can show.
#include "tests/evaluate/recording_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "client/recording/recording_reader.hpp"
#include "tests/evaluate/curves.hpp"

namespace hapticast::evaluate {

namespace {

// Chosen: more than a panel has columns of pixels.
constexpr double kBins = 800.0;

// Black, and colours that colour-blind people can tell apart (Okabe and Ito).
constexpr std::array<const char*, 8> kCurveColors = {"#000000", "#0072b2", "#d55e00", "#009e73",
                                                     "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f"};

/// A curve over the time of a recording.
class Trace {
 public:
  Trace(std::string name, std::size_t color, double length_s)
      : curve_{std::move(name), kCurveColors[color % kCurveColors.size()], {}},
        bin_s_(std::max(length_s / kBins, 1e-9)) {}

  void add(double time_s, double value) {
    if (!std::isfinite(value)) return;
    const double bin = std::floor(time_s / bin_s_);
    if (low_ && bin != bin_) flush();
    bin_ = bin;
    if (!low_ || value < low_->y) low_ = CurvePoint{time_s, value};
    if (!high_ || value > high_->y) high_ = CurvePoint{time_s, value};
  }
  /// Returns the curve. It ends the trace.
  Curve finish() {
    if (low_) flush();
    return std::move(curve_);
  }

 private:
  void flush() {
    const bool rises = low_->x <= high_->x;
    curve_.points.push_back(rises ? *low_ : *high_);
    if (low_->x != high_->x || low_->y != high_->y) curve_.points.push_back(rises ? *high_ : *low_);
    low_.reset();
    high_.reset();
  }

  Curve curve_;
  double bin_s_;
  double bin_ = 0.0;
  std::optional<CurvePoint> low_, high_;  // of the present bin
};

/// Counts that grow, by their name.
class Counts {
 public:
  explicit Counts(double length_s) : length_s_(length_s) {}
  /// Adds `more` to the count `name`. With 0 the count appears in the key.
  void add(const std::string& name, double time_s, double more) {
    auto found = counts_.find(name);
    if (found == counts_.end()) {
      found = counts_.emplace(name, Count{Trace(name, counts_.size() + 1, length_s_)}).first;
      found->second.trace.add(0.0, 0.0);
    }
    Count& count = found->second;
    count.trace.add(time_s, count.sum);  // a step, not a slope
    count.sum += more;
    count.trace.add(time_s, count.sum);
  }
  std::vector<Curve> finish() {
    std::vector<Curve> curves;
    for (auto& [name, count] : counts_) {
      count.trace.add(length_s_, count.sum);
      curves.push_back(count.trace.finish());
    }
    return curves;
  }

 private:
  struct Count {
    Trace trace;
    double sum = 0.0;
  };
  double length_s_;
  std::map<std::string, Count> counts_;
};

CurvePanel makePanel(const std::string& title, const std::string& y_label, double length_s,
                     std::vector<Curve> curves) {
  CurvePanel panel;
  panel.title = title;
  panel.x_label = "time since the begin, s";
  panel.y_label = y_label;
  panel.right = length_s;
  for (Curve& curve : curves) {
    curve.width = 1.2;
    if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
  }
  if (panel.curves.empty()) panel.curves.push_back({"none", "#000000", {{0.0, 0.0}}});
  std::vector<CurvePanel> scaled{std::move(panel)};
  shareScale(scaled);  // from 0 on
  if (scaled[0].low == scaled[0].high) scaled[0].high = 1.0;
  return std::move(scaled[0]);
}

/// The curves of a client's recording. Times are in s since the begin.
class RunCurves {
 public:
  RunCurves(double begin_s, double length_s)
      : begin_s_(begin_s),
        length_s_(length_s),
        force_("at the device", 0, length_s),
        static_("static, before the limits", 1, length_s),
        dynamic_("dynamic", 2, length_s),
        penetration_("", 0, length_s),
        playout_("playout delay", 0, length_s),
        arrival_("arrival of a frame", 1, length_s),
        losses_(length_s),
        lookups_(length_s),
        actions_(length_s) {
    for (const char* name : {"frames lost", "frames dropped", "slices lost"})
      losses_.add(name, 0.0, 0.0);
    for (std::size_t i = static_cast<std::size_t>(client::Lookup::kExtrapolated);
         i < client::kLookupKinds; ++i)
      lookups_.add(client::kLookupNames[i], 0.0, 0.0);
  }

  void add(const client::RecordedMessage& message) {
    const double time_s = 1e-9 * static_cast<double>(message.time_ns) - begin_s_;
    if (const auto* const ticks = std::get_if<std::vector<client::TickReport>>(&message.content)) {
      for (const client::TickReport& tick : *ticks) addTick(tick);
    } else if (const auto* const timing = std::get_if<client::RecordedTiming>(&message.content)) {
      timing_ = timing->timing;
    } else if (const auto* const frame = std::get_if<client::AssembledFrame>(&message.content)) {
      addFrame(*frame, time_s);
    } else if (const auto* const prepared =
                   std::get_if<client::RecordedPreparation>(&message.content)) {
      if (!prepared->handed_over) losses_.add("frames dropped", time_s, 1.0);
    }
  }
  std::vector<CurvePanel> finish() {
    return {
        makePanel("Force", "N", length_s_, {static_.finish(), dynamic_.finish(), force_.finish()}),
        makePanel("Delay", "ms", length_s_, {arrival_.finish(), playout_.finish()}),
        makePanel("Penetration", "mm", length_s_, {penetration_.finish()}),
        makePanel("Losses so far", "number", length_s_, losses_.finish()),
        makePanel("Ticks so far in which the safety chain changed the force", "ticks", length_s_,
                  actions_.finish()),
        makePanel("Ticks so far without two frames to interpolate", "ticks", length_s_,
                  lookups_.finish())};
  }

 private:
  void addTick(const client::TickReport& tick) {
    const double time_s = toSeconds(tick.time) - begin_s_;
    force_.add(time_s, tick.force_N.norm());
    static_.add(time_s, tick.static_force_N.norm());
    dynamic_.add(time_s, tick.dynamic_force_N.norm());
    penetration_.add(time_s, tick.penetration_mm);
    playout_.add(time_s, 1e3 * toSeconds(tick.playout_delay));
    if (tick.lookup >= client::Lookup::kExtrapolated)
      lookups_.add(client::kLookupNames[static_cast<std::size_t>(tick.lookup)], time_s, 1.0);
    for (std::size_t i = 0; i < client::kSafetyActionNames.size(); ++i) {
      if ((tick.safety_actions >> i & 1U) != 0)
        actions_.add(client::kSafetyActionNames[i], time_s, 1.0);
    }
  }
  void addFrame(const client::AssembledFrame& assembled, double time_s) {
    const CodedFrame& frame = assembled.frame;
    const bool follows = last_id_ && assembled.place.epoch == last_epoch_ && frame.id > *last_id_;
    if (follows && !assembled.place.resync && frame.id > *last_id_ + 1)
      losses_.add("frames lost", time_s, static_cast<double>(frame.id - *last_id_ - 1));
    last_id_ = frame.id;
    last_epoch_ = assembled.place.epoch;
    for (const CodedObject& object : frame.objects) {
      if (object.relief && !object.relief->whole())
        losses_.add("slices lost", time_s,
                    static_cast<double>(object.relief->slice_count - object.relief->slices.size()));
    }
    if (!timing_ || !timing_->connected) return;
    const double media_s = begin_s_ + time_s + toSeconds(timing_->clock_offset);
    arrival_.add(time_s, 1e3 * (media_s - toSeconds(timing_->pipeline_latency) -
                                toSeconds(frame.media_time)));
  }

  double begin_s_;
  double length_s_;
  Trace force_, static_, dynamic_, penetration_, playout_, arrival_;
  Counts losses_, lookups_, actions_;
  std::optional<client::StreamTiming> timing_;  // the newest one
  std::optional<std::uint64_t> last_id_;
  std::uint32_t last_epoch_ = 0;
};

/// The curves of a server's recording. Times are in s since the begin.
class StreamCurves {
 public:
  StreamCurves(double begin_s, double length_s)
      : begin_s_(begin_s),
        length_s_(length_s),
        frame_("frame", 0, length_s),
        picture_("picture", 1, length_s),
        objects_("objects", 0, length_s),
        changed_("with new heights", 2, length_s),
        interval_("", 0, length_s),
        speed_("", 0, length_s) {}

  void add(const client::RecordedMessage& message) {
    const double size_kB = 1e-3 * static_cast<double>(message.bytes);
    if (const auto* const picture = std::get_if<VideoFrame>(&message.content)) {
      picture_.add(toSeconds(picture->media_time) - begin_s_, size_kB);
    } else if (const auto* const frame = std::get_if<client::AssembledFrame>(&message.content)) {
      addFrame(frame->frame, size_kB);
    }
  }
  std::vector<CurvePanel> finish() {
    return {makePanel("Size", "kB", length_s_, {picture_.finish(), frame_.finish()}),
            makePanel("Objects", "number", length_s_, {objects_.finish(), changed_.finish()}),
            makePanel("Time since the frame before", "ms", length_s_, {interval_.finish()}),
            makePanel("Largest speed of an object", "mm/s", length_s_, {speed_.finish()})};
  }

 private:
  void addFrame(const CodedFrame& frame, double size_kB) {
    const double time_s = toSeconds(frame.media_time) - begin_s_;
    frame_.add(time_s, size_kB);
    double changed = 0.0, speed_mm_s = 0.0;
    for (const CodedObject& object : frame.objects) {
      changed += object.relief ? 1.0 : 0.0;
      speed_mm_s = std::max(speed_mm_s, object.motion.velocity_mm_s.norm());
    }
    objects_.add(time_s, static_cast<double>(frame.objects.size()));
    changed_.add(time_s, changed);
    speed_.add(time_s, speed_mm_s);
    if (last_) interval_.add(time_s, 1e3 * toSeconds(frame.media_time - *last_));
    last_ = frame.media_time;
  }

  double begin_s_;
  double length_s_;
  Trace frame_, picture_, objects_, changed_, interval_, speed_;
  std::optional<MediaTime> last_;  // of the frame before
};

template <class Curves>
std::vector<CurvePanel> readPanels(client::RecordingReader& reader, Curves curves) {
  while (const auto message = reader.next(client::kStreamMessages)) curves.add(*message);
  return curves.finish();
}

}  // namespace

RecordingCurves readCurves(const std::string& file) {
  auto opened = client::RecordingReader::open(file);
  if (!opened.ok()) throw std::runtime_error(file + ": " + opened.error().message);
  client::RecordingReader& reader = opened.value();
  const double begin_s = 1e-9 * static_cast<double>(reader.begin_ns());
  const double length_s = 1e-9 * static_cast<double>(reader.end_ns()) - begin_s;
  if (!(length_s > 0.0)) throw std::runtime_error(file + ": has no two times to draw");
  RecordingCurves curves;
  curves.panels = reader.isOfClient() ? readPanels(reader, RunCurves(begin_s, length_s))
                                      : readPanels(reader, StreamCurves(begin_s, length_s));
  curves.line =
      fmt::format("{:.1f} s of a {}", length_s, reader.isOfClient() ? "client" : "server");
  if (!reader.problem().empty()) curves.line += "; the recording " + reader.problem();
  return curves;
}

void plotRecording(const std::string& file, const std::filesystem::path& out) {
  const RecordingCurves curves = readCurves(file);
  std::filesystem::create_directories(out);
  plotCurves(out / "log.png", curves.panels, 2);
  std::printf("%s: %s\n", (out / "log.png").c_str(), curves.line.c_str());
}

}  // namespace hapticast::evaluate
