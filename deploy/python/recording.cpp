// SPDX-License-Identifier: MIT
// hapticast.Recording: frames and ticks of a file of --record.
#include "hapticast/recording.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "recording.hpp"

namespace hapticast::python {

namespace {

// Ticks between two checks for Ctrl-C, less than 50 ms of reading.
constexpr std::size_t kTicksBetweenChecks = 10'000;

/// A row of the array of ticks.
struct TickRow {
  std::uint64_t tick;
  double time_s, play_time_s, playout_delay_s;
  double reading_mm[3], hip_mm[3];
  double force_N[3], static_force_N[3], dynamic_force_N[3];
  double penetration_mm;
  std::uint32_t buttons, safety_actions;
  std::uint8_t device, lookup, fault;
  bool contact, stopping;
};

TickRow toRow(const RecordedTick& from) {
  TickRow to{};
  to.tick = from.tick;
  to.time_s = from.time_s;
  to.play_time_s = from.play_time_s;
  to.playout_delay_s = from.playout_delay_s;
  std::copy_n(from.reading_mm.data(), 3, std::begin(to.reading_mm));
  std::copy_n(from.hip_mm.data(), 3, std::begin(to.hip_mm));
  std::copy_n(from.force_N.data(), 3, std::begin(to.force_N));
  std::copy_n(from.static_force_N.data(), 3, std::begin(to.static_force_N));
  std::copy_n(from.dynamic_force_N.data(), 3, std::begin(to.dynamic_force_N));
  to.penetration_mm = from.penetration_mm;
  to.buttons = from.buttons;
  to.safety_actions = from.safety_actions;
  to.device = from.device;
  to.lookup = from.lookup;
  to.fault = from.fault;
  to.contact = from.contact;
  to.stopping = from.stopping;
  return to;
}

/// A recording for scripts. Each iteration reads the file by itself.
class RecordingObject {
 public:
  explicit RecordingObject(const py::object& file)
      : file_(toText(py::module_::import("os").attr("fspath")(file), "file")) {
    const py::gil_scoped_release unlocked;
    const Recording recording(file_);
    is_of_client_ = recording.kind() == Recording::Kind::kClient;
    start_ns_ = recording.start_ns();
    end_ns_ = recording.end_ns();
    description_ = recording.info();
  }

  [[nodiscard]] const char* kind() const { return is_of_client_ ? "client" : "server"; }
  [[nodiscard]] std::int64_t start_ns() const { return start_ns_; }
  [[nodiscard]] std::int64_t end_ns() const { return end_ns_; }
  [[nodiscard]] py::object description() const {
    return description_ ? py::object(toPython(*description_)) : py::object(py::none());
  }
  /// Counts at the first call.
  [[nodiscard]] const RecordingCounts& counts() {
    requireOpen();
    if (!counts_) {
      RecordingCounts counts;
      {
        const py::gil_scoped_release unlocked;
        counts = Recording(file_).count();
      }
      counts_ = std::move(counts);
    }
    return *counts_;
  }
  [[nodiscard]] std::unique_ptr<RecordedFrames> frames(const py::object& start_ns) const {
    requireOpen();
    const auto from_ns = toTime(start_ns);
    const py::gil_scoped_release unlocked;
    Recording recording(file_);
    if (from_ns) recording.seek(*from_ns);
    return std::make_unique<RecordedFrames>(std::move(recording));
  }
  [[nodiscard]] py::array ticks(const py::object& start_ns) const;
  void close() { closed_ = true; }

 private:
  void requireOpen() const {
    if (closed_) throw std::runtime_error(file_ + ": the recording is closed");
  }
  static std::optional<std::int64_t> toTime(const py::object& from) {
    if (from.is_none()) return std::nullopt;
    if (!py::isinstance<py::int_>(from)) throw py::type_error("start_ns: needs a whole number");
    const long long time_ns = PyLong_AsLongLong(from.ptr());
    if (PyErr_Occurred() == nullptr) return time_ns;
    PyErr_Clear();
    throw py::value_error("start_ns: is outside the numbers of 64 bits");
  }

  std::string file_;
  bool is_of_client_ = false;
  bool closed_ = false;
  std::int64_t start_ns_ = 0, end_ns_ = 0;
  std::optional<StreamInfo> description_;
  std::optional<RecordingCounts> counts_;
};

py::array RecordingObject::ticks(const py::object& start_ns) const {
  requireOpen();
  const auto from_ns = toTime(start_ns);
  auto rows = std::make_unique<std::vector<TickRow>>();
  {
    const py::gil_scoped_release unlocked;
    Recording recording(file_);
    if (from_ns) recording.seek(*from_ns);
    while (const auto tick = recording.nextTick()) {
      if (rows->size() % kTicksBetweenChecks == 0) checkSignals();
      rows->push_back(toRow(*tick));
    }
  }
  const auto count = static_cast<py::ssize_t>(rows->size());
  const TickRow* const data = rows->data();
  const py::capsule owner(rows.release(),
                          [](void* held) { delete static_cast<std::vector<TickRow>*>(held); });
  return py::array_t<TickRow>(count, data, owner);
}

py::tuple toNames(const std::vector<std::string>& names) { return py::cast(names); }

void addParts(py::module_& module) {
  module.attr("lookups") = toNames(listLookups());
  module.attr("faults") = toNames(listFaults());
  py::class_<RecordedFrames>(module, "RecordedFrames", "Iterates over the frames of a recording.")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](RecordedFrames& self) {
        std::optional<StreamFrame> frame;
        {
          const py::gil_scoped_release unlocked;
          frame = self.next();
        }
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!frame) throw py::stop_iteration();
        return std::move(*frame);
      });
}

}  // namespace

std::optional<StreamFrame> RecordedFrames::next() {
  const std::lock_guard lock(mutex_);
  auto frame = recording_.nextFrame();
  if (!frame) return std::nullopt;
  return StreamFrame{std::move(*frame), std::make_shared<const StreamInfo>(*recording_.info())};
}

py::object openFrames(const py::object& from) {
  if (!py::isinstance<RecordingObject>(from)) return from;
  return py::cast(from.cast<const RecordingObject&>().frames(py::none()));
}

void addRecording(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(TickRow, tick, time_s, play_time_s, playout_delay_s, reading_mm, hip_mm,
                       force_N, static_force_N, dynamic_force_N, penetration_mm, buttons,
                       safety_actions, device, lookup, fault, contact, stopping);
  addParts(module);
  py::class_<RecordingObject>(module, "Recording", R"(Reads a file of --record.

kind: "server" or "client". start_ns, end_ns: media time (server) or the client's local clock.
description: as Stream.info; None if a client never connected. frame_count, tick_count,
picture_count, problem: the first one of them reads the whole file. problem: why the file ends
early, such as "is cut off"; an empty text: it does not.)")
      .def(py::init<const py::object&>(), py::arg("file"))
      .def_property_readonly("kind", &RecordingObject::kind)
      .def_property_readonly("start_ns", &RecordingObject::start_ns)
      .def_property_readonly("end_ns", &RecordingObject::end_ns)
      .def_property_readonly("description", &RecordingObject::description)
      .def_property_readonly("frame_count",
                             [](RecordingObject& self) { return self.counts().frames; })
      .def_property_readonly("tick_count",
                             [](RecordingObject& self) { return self.counts().ticks; })
      .def_property_readonly("picture_count",
                             [](RecordingObject& self) { return self.counts().pictures; })
      .def_property_readonly("problem", [](RecordingObject& self) { return self.counts().problem; })
      .def(
          "frames", &RecordingObject::frames, py::arg("start_ns") = py::none(),
          "Iterates over the frames, up to the first damage. start_ns: the first one's least time.")
      .def("ticks", &RecordingObject::ticks, py::arg("start_ns") = py::none(),
           R"(Returns the ticks of a client, up to the first damage, as a structured array.

tick, time_s (local clock), play_time_s (media time), playout_delay_s, reading_mm (device frame),
hip_mm, force_N, static_force_N, dynamic_force_N, penetration_mm, buttons, safety_actions (bits of
hapticast.safety_actions), device (0: a new position, 1: none, 2: lost), lookup (place in
hapticast.lookups), fault (place in hapticast.faults), contact, stopping. A server has no ticks.)")
      .def("close", &RecordingObject::close, "Ends the use of the file. Iterators go on.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](RecordingObject& self, const py::args&) { self.close(); })
      .def("__repr__", [](const RecordingObject& self) {
        return std::string("<hapticast.Recording of a ") + self.kind() + ">";
      });
}

}  // namespace hapticast::python
