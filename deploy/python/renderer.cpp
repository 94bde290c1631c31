// SPDX-License-Identifier: MIT
// hapticast.Renderer: the force of many ticks at once.
#include <pybind11/stl.h>

#include <ctime>

#include "frames.hpp"
#include "hapticast/renderer.hpp"
#include "hapticast/stream.hpp"
#include "recording.hpp"

namespace hapticast::python {

namespace {

/// A message of the wire, and the time of its arrival.
struct Message {
  double arrival_s;
  std::string bytes;
};

/// The ticks of a run, in arrays. Vectors have the shape (ticks, 3).
class Ticks {
 public:
  explicit Ticks(py::ssize_t count)
      : time_s_(count),
        play_time_s_(count),
        penetration_mm_(count),
        height_mm_(count),
        safety_actions_(count),
        contact_(count),
        halted_(count),
        force_N_({count, py::ssize_t{3}}),
        static_force_N_({count, py::ssize_t{3}}),
        dynamic_force_N_({count, py::ssize_t{3}}),
        hip_mm_({count, py::ssize_t{3}}) {}

  /// Writes the tick number `i`. Thread: any, without Python's lock.
  void store(py::ssize_t i, const Tick& tick) {
    time_s_.mutable_data()[i] = tick.time_s;
    play_time_s_.mutable_data()[i] = tick.play_time_s;
    penetration_mm_.mutable_data()[i] = tick.penetration_mm;
    height_mm_.mutable_data()[i] = tick.height_mm;
    safety_actions_.mutable_data()[i] = tick.safety_actions;
    contact_.mutable_data()[i] = tick.contact;
    halted_.mutable_data()[i] = tick.halted;
    Eigen::Map<Eigen::Vector3d>(force_N_.mutable_data() + 3 * i) = tick.force_N;
    Eigen::Map<Eigen::Vector3d>(static_force_N_.mutable_data() + 3 * i) = tick.static_force_N;
    Eigen::Map<Eigen::Vector3d>(dynamic_force_N_.mutable_data() + 3 * i) = tick.dynamic_force_N;
    Eigen::Map<Eigen::Vector3d>(hip_mm_.mutable_data() + 3 * i) = tick.hip_mm;
  }
  [[nodiscard]] py::object toPython() const {
    py::dict to;
    to["time_s"] = time_s_;
    to["play_time_s"] = play_time_s_;
    to["force_N"] = force_N_;
    to["static_force_N"] = static_force_N_;
    to["dynamic_force_N"] = dynamic_force_N_;
    to["penetration_mm"] = penetration_mm_;
    to["height_mm"] = height_mm_;
    to["hip_mm"] = hip_mm_;
    to["contact"] = contact_;
    to["halted"] = halted_;
    to["safety_actions"] = safety_actions_;
    return py::module_::import("types").attr("SimpleNamespace")(**to);
  }

 private:
  py::array_t<double> time_s_, play_time_s_, penetration_mm_, height_mm_;
  py::array_t<std::uint32_t> safety_actions_;
  py::array_t<bool> contact_, halted_;
  py::array_t<double> force_N_, static_force_N_, dynamic_force_N_, hip_mm_;
};

/// Positions of the hand, a tick each.
struct Positions {
  py::array_t<double, py::array::c_style | py::array::forcecast> values_mm;
  bool nominal = true;

  [[nodiscard]] py::ssize_t count() const { return values_mm.shape(0); }
  /// Returns the position of tick `i` in the device frame.
  [[nodiscard]] Eigen::Vector3d at(py::ssize_t i, const Renderer& renderer) const {
    const Eigen::Vector3d each = Eigen::Map<const Eigen::Vector3d>(values_mm.data() + 3 * i);
    return nominal ? renderer.toDevice(each) : each;
  }
};

Positions toPositions(const py::object& positions_mm, const py::object& frame) {
  Positions to{toArray<double>(positions_mm, "positions_mm", 2)};
  if (to.values_mm.shape(1) != 3)
    throw py::value_error("positions_mm: needs the shape (ticks, 3), not (" +
                          std::to_string(to.count()) + ", " +
                          std::to_string(to.values_mm.shape(1)) + ")");
  const std::string name = toText(frame, "frame");
  if (name != "nominal" && name != "device")
    throw py::value_error("frame: '" + name + "' is neither nominal nor device");
  to.nominal = name == "nominal";
  return to;
}

// Ticks between two checks for Ctrl-C, about 50 ms of computing.
constexpr py::ssize_t kTicksBetweenChecks = 20'000;

/// Renders the frames that `readFrame` returns, an std::optional<StreamFrame> each. `begin_s`: time
/// of the first tick; nullopt: that of the first frame.
template <class ReadFrame>
void runFrames(Renderer& renderer, const ReadFrame& readFrame, const Positions& positions,
               std::optional<double> begin_s, double dt_s, Ticks& ticks) {
  std::optional<StreamFrame> frame = readFrame();
  double ahead_s = 0.0;
  if (frame) {
    renderer.begin(*frame->info);
    ahead_s = 2.0 / frame->info->fps + 0.02;
  }
  const double first_s = begin_s.value_or(frame ? frame->frame.time_s : 0.0);
  for (py::ssize_t i = 0; i < positions.count(); ++i) {
    if (i % kTicksBetweenChecks == 0) checkSignals();
    const double now_s = first_s + dt_s * static_cast<double>(i);
    while (frame && frame->frame.time_s <= now_s + ahead_s && renderer.push(frame->frame))
      frame = readFrame();
    ticks.store(i, renderer.tick(now_s, positions.at(i, renderer)));
  }
}

void runMessages(Renderer& renderer, const std::vector<Message>& messages,
                 const Positions& positions, double begin_s, double dt_s, Ticks& ticks) {
  MessagePlayer player(renderer);
  std::size_t next = 0;
  for (py::ssize_t i = 0; i < positions.count(); ++i) {
    if (i % kTicksBetweenChecks == 0) checkSignals();
    const double now_s = begin_s + dt_s * static_cast<double>(i);
    for (; next < messages.size() && messages[next].arrival_s <= now_s; ++next) {
      const auto* const bytes = reinterpret_cast<const std::uint8_t*>(messages[next].bytes.data());
      player.push({bytes, messages[next].bytes.size()}, messages[next].arrival_s);
    }
    player.release(now_s);
    ticks.store(i, renderer.tick(now_s, positions.at(i, renderer)));
  }
}

/// Ticks in real time.
void runStream(Renderer& renderer, Stream& stream, const Positions& positions, double dt_s,
               Ticks& ticks) {
  stream.play(renderer);
  const double begin_s = Stream::now();
  for (py::ssize_t i = 0; i < positions.count(); ++i) {
    if (i % 50 == 0) checkSignals();
    const double due_s = begin_s + dt_s * static_cast<double>(i);
    const auto seconds = static_cast<std::time_t>(due_s);
    const timespec due{seconds, static_cast<long>(1e9 * (due_s - static_cast<double>(seconds)))};
    ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
    ticks.store(i, renderer.tick(Stream::now(), positions.at(i, renderer)));
  }
}

/// The frames or messages of an iterable of Python.
struct Content {
  std::vector<StreamFrame> frames;
  std::vector<Message> messages;

  explicit Content(const py::object& from) {
    if (!py::isinstance<py::iterable>(from))
      throw py::type_error(
          "frames: needs a Stream, a Recording, frames, or pairs of arrival_s and bytes");
    for (const py::handle each : from) {
      if (py::isinstance<StreamFrame>(each)) {
        frames.push_back(each.cast<StreamFrame>());
      } else if (py::isinstance<py::tuple>(each) && py::len(each) == 2 &&
                 py::isinstance<py::bytes>(py::reinterpret_borrow<py::tuple>(each)[1])) {
        const auto pair = py::reinterpret_borrow<py::tuple>(each);
        messages.push_back({toNumber(pair[0], "arrival_s"), pair[1].cast<std::string>()});
      } else {
        throw py::type_error(
            "frames: needs a Stream, a Recording, frames, or pairs of arrival_s and bytes");
      }
    }
    if (!frames.empty() && !messages.empty())
      throw py::type_error("frames: has frames and messages; give one kind");
  }
};

void runContent(Renderer& renderer, const Content& content, const Positions& positions,
                std::optional<double> begin_s, double dt_s, Ticks& ticks) {
  if (!content.messages.empty()) {
    const double first_s = begin_s.value_or(content.messages.front().arrival_s);
    runMessages(renderer, content.messages, positions, first_s, dt_s, ticks);
    return;
  }
  std::size_t next = 0;
  const auto readFrame = [&]() -> std::optional<StreamFrame> {
    if (next == content.frames.size()) return std::nullopt;
    return content.frames[next++];
  };
  runFrames(renderer, readFrame, positions, begin_s, dt_s, ticks);
}

/// Renders with the same settings in each run.
class RendererObject {
 public:
  RendererObject(const py::object& profile, const py::object& method, const py::object& stiffness,
                 const py::object& surface) {
    settings_.profile = toText(profile, "profile");
    settings_.thesis = toMethod(method);
    if (!stiffness.is_none()) settings_.stiffness_N_mm = toNumber(stiffness, "stiffness");
    settings_.surface = toSurface(toText(surface, "surface"));
    (void)Renderer(settings_);  // checks the settings
  }

  py::object run(const py::object& frames, const py::object& positions_mm, const py::object& dt,
                 const py::object& begin, const py::object& frame) const {
    const Positions positions = toPositions(positions_mm, frame);
    const double dt_s = toNumber(dt, "dt");
    if (!(dt_s >= 1e-4 && dt_s <= 1e-2))
      throw py::value_error("dt: " + std::to_string(dt_s) + " s is outside 0.0001..0.01 s");
    std::optional<double> begin_s;
    if (!begin.is_none()) begin_s = toNumber(begin, "begin_s");
    Ticks ticks(positions.count());
    Renderer renderer(settings_);
    const py::object source = openFrames(frames);
    if (py::isinstance<Stream>(source)) {
      auto& stream = source.cast<Stream&>();
      const py::gil_scoped_release unlocked;
      runStream(renderer, stream, positions, dt_s, ticks);
    } else if (py::isinstance<RecordedFrames>(source)) {
      auto& recorded = source.cast<RecordedFrames&>();
      const py::gil_scoped_release unlocked;
      runFrames(
          renderer, [&] { return recorded.next(); }, positions, begin_s, dt_s, ticks);
    } else {
      const Content content(source);
      const py::gil_scoped_release unlocked;
      runContent(renderer, content, positions, begin_s, dt_s, ticks);
    }
    return ticks.toPython();
  }

 private:
  static RendererSettings::Surface toSurface(const std::string& name) {
    if (name == "proxy") return RendererSettings::Surface::kProxy;
    if (name == "normal") return RendererSettings::Surface::kNormal;
    if (name == "perturbed") return RendererSettings::Surface::kPerturbed;
    throw py::value_error("surface: '" + name + "' is none of proxy, normal, perturbed");
  }
  RendererSettings settings_;
};

}  // namespace

void addRenderer(py::module_& module) {
  py::class_<RendererObject>(module, "Renderer", R"(Computes the force of hapticast-client.

profile: "omni", "falcon" or the file of a device profile. method: "hapticast" or "thesis".
stiffness: N/mm of all surfaces; None: the author's. surface: "proxy", "normal" or "perturbed".)")
      .def(py::init<const py::object&, const py::object&, const py::object&, const py::object&>(),
           py::arg("profile") = "omni", py::arg("method") = "hapticast",
           py::arg("stiffness") = py::none(), py::arg("surface") = "proxy")
      .def("run", &RendererObject::run, py::arg("frames"), py::arg("positions_mm"),
           py::arg("dt") = 1e-3, py::arg("begin_s") = py::none(), py::arg("frame") = "nominal",
           R"(Renders one tick for each position. Each run starts anew.

frames: frames of a Stream, of Vision or of your own; or a Recording, at its media times; or pairs
(arrival_s, bytes) of messages of the wire; or a Stream, which is then touched in real time.
positions_mm: array (ticks, 3) of the hand, in mm of the nominal frame, or with frame="device" in mm
of the device frame. Begin outside of all objects: a hand inside gets no force.
dt: s from tick to tick. begin_s: time of the first tick; None: that of the first frame or message.

Returns arrays: time_s, play_time_s, penetration_mm, height_mm (ticks,), contact, halted (ticks,)
bool, safety_actions (ticks,) uint32 bits of hapticast.safety_actions, force_N, static_force_N,
dynamic_force_N, hip_mm (ticks, 3). Forces are N in the device frame, behind the safety chain.)");
  module.attr("safety_actions") = py::tuple(py::cast(listSafetyActions()));
}

}  // namespace hapticast::python
