// SPDX-License-Identifier: MIT
// The module hapticast._vision: Vision and Source. It is separate because it loads OpenCV.
#include "hapticast/vision.hpp"

#include <pybind11/stl.h>

#include <cstring>
#include <mutex>
#include <tuple>

#include "frames.hpp"

namespace hapticast::python {

namespace {

using Points = std::vector<std::pair<double, double>>;

/// Returns one point (u, v), or a list of them.
Points toPoints(const py::handle& from, const char* name) {
  if (from.is_none()) return {};
  if (!py::isinstance<py::sequence>(from))
    throw py::type_error(std::string(name) + ": needs (u, v)");
  const auto sequence = py::reinterpret_borrow<py::sequence>(from);
  if (py::len(sequence) > 0 && !py::isinstance<py::sequence>(sequence[0]))
    return {toPair(from, name)};
  Points points;
  for (const py::handle each : sequence) points.push_back(toPair(each, name));
  return points;
}

VisionSettings toSettings(const py::kwargs& from) {
  VisionSettings to;
  for (const auto& [key, value] : from) {
    const std::string name = toText(key, "keyword");
    if (name == "object")
      to.objects = toPoints(value, "object");
    else if (name == "not_object")
      to.not_objects = toPoints(value, "not_object");
    else if (name == "method")
      to.thesis = toMethod(value);
    else if (name == "motion")
      to.motion = toTruth(value, "motion");
    else if (name == "low_latency")
      to.low_latency = toTruth(value, "low_latency");
    else if (name == "pictures")
      to.pictures = toTruth(value, "pictures");
    else if (name == "map_range")
      to.map_range = toPair(value, "map_range");
    else if (name == "fov_deg")
      to.fov_deg = toNumber(value, "fov_deg");
    else if (name == "stiffness_N_mm")
      to.material.stiffness_N_mm = toNumber(value, "stiffness_N_mm");
    else if (name == "mass_kg")
      to.material.mass_kg = toNumber(value, "mass_kg");
    else
      throw py::type_error("'" + name + "' is no option of Vision");
  }
  return to;
}

template <class T>
std::vector<T> copyOf(const py::array_t<T, py::array::c_style | py::array::forcecast>& array) {
  return std::vector<T>(array.data(), array.data() + array.size());
}

Images toImages(const py::object& rgb, const py::object& depth, const py::object& mask) {
  Images to;
  const auto depths = toArray<float>(depth, "depth", 2);
  to.height_px = static_cast<int>(depths.shape(0));
  to.width_px = static_cast<int>(depths.shape(1));
  to.depth = copyOf<float>(depths);
  const auto colours = toArray<std::uint8_t>(rgb, "rgb", 3);
  if (colours.shape(0) != depths.shape(0) || colours.shape(1) != depths.shape(1) ||
      colours.shape(2) != 3)
    throw py::value_error("rgb: needs the shape (rows, columns, 3) with the size of depth");
  to.rgb = copyOf<std::uint8_t>(colours);
  if (mask.is_none()) return to;
  const auto numbers = toArray<std::uint8_t>(mask, "mask", 2);
  if (numbers.shape(0) != depths.shape(0) || numbers.shape(1) != depths.shape(1))
    throw py::value_error("mask: has another size than depth");
  to.mask = copyOf<std::uint8_t>(numbers);
  return to;
}

/// A source for several threads of Python.
class SourceObject {
 public:
  SourceObject(const std::string& spec, double fps) : source_(spec, fps) {}
  std::optional<Images> read() {
    const py::gil_scoped_release unlocked;
    const std::lock_guard lock(mutex_);
    return source_.read();
  }
  [[nodiscard]] Source& get() { return source_; }
  [[nodiscard]] std::mutex& mutex() { return mutex_; }

 private:
  std::mutex mutex_;
  Source source_;
};

py::object wrapImages(const Images& images) {
  const py::ssize_t rows = images.height_px, columns = images.width_px;
  py::dict to;
  to["rgb"] = images.rgb.empty()
                  ? py::object(py::none())
                  : py::array_t<std::uint8_t>({rows, columns, py::ssize_t{3}}, images.rgb.data());
  to["depth"] = py::array_t<float>({rows, columns}, images.depth.data());
  to["mask"] = images.mask.empty() ? py::object(py::none())
                                   : py::array_t<std::uint8_t>({rows, columns}, images.mask.data());
  to["time_s"] = images.time_s;
  to["epoch"] = images.epoch;
  return py::module_::import("types").attr("SimpleNamespace")(**to);
}

/// Vision for several threads of Python.
class VisionObject {
 public:
  VisionObject(const SourceInfo& info, const VisionSettings& settings)
      : fps_(info.fps), vision_(info, settings) {}
  VisionObject(SourceObject& source, const VisionSettings& settings)
      : fps_(source.get().info().fps), vision_(source.get(), settings) {}

  /// Adds images. Without a time they follow the last ones after a frame interval.
  std::optional<StreamFrame> push(Images images, std::optional<double> time_s) {
    const py::gil_scoped_release unlocked;
    const std::lock_guard lock(mutex_);
    images.time_s = time_s.value_or(last_s_ + 1.0 / fps_);
    auto frame = vision_.push(images);
    last_s_ = images.time_s;
    if (!frame) return std::nullopt;
    return wrap(std::move(*frame));
  }
  std::vector<StreamFrame> flush() {
    const py::gil_scoped_release unlocked;
    const std::lock_guard lock(mutex_);
    std::vector<StreamFrame> frames;
    for (Frame& each : vision_.flush()) frames.push_back(wrap(std::move(each)));
    return frames;
  }
  [[nodiscard]] StreamInfo info() {
    const py::gil_scoped_release unlocked;
    const std::lock_guard lock(mutex_);
    return vision_.info();
  }

 private:
  StreamFrame wrap(Frame frame) {
    return {std::move(frame), std::make_shared<const StreamInfo>(vision_.info())};
  }
  double fps_;
  std::mutex mutex_;  // locked without Python's lock only
  double last_s_ = 0.0;
  Vision vision_;
};

/// The frames of a whole source, for `for`.
class SourceFrames {
 public:
  SourceFrames(py::object source, const VisionSettings& settings)
      : source_(std::move(source)), vision_(source_.cast<SourceObject&>(), settings) {}

  StreamFrame next() {
    auto& source = source_.cast<SourceObject&>();
    while (!ended_) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      auto images = source.read();
      if (!images) {
        ended_ = true;
        rest_ = vision_.flush();
        break;
      }
      const double time_s = images->time_s;
      if (auto frame = vision_.push(std::move(*images), time_s)) {
        return std::move(*frame);
      }
    }
    if (next_ == rest_.size()) throw py::stop_iteration();
    return rest_[next_++];
  }

 private:
  py::object source_;
  VisionObject vision_;
  bool ended_ = false;
  std::vector<StreamFrame> rest_;
  std::size_t next_ = 0;
};

void addVision(py::module_& module) {
  py::class_<VisionObject>(module, "Vision", R"(Makes frames of images with depth.

fps: frames/s. size: (width, height), px. camera: (fx, fy, cx, cy), px; None: unknown.
object, not_object: a point (u, v) or a list of them, px. method: "hapticast" or "thesis".
pictures: True: frames have a picture. motion, low_latency, map_range, fov_deg, stiffness_N_mm, mass_kg: as in hapticast-server.)")
      .def(py::init([](const py::object& fps, const py::object& size, const py::object& camera,
                       const py::kwargs& more) {
             SourceInfo info;
             info.fps = toNumber(fps, "fps");
             std::tie(info.width_px, info.height_px) = toSize(size, "size");
             if (!camera.is_none()) {
               const auto values = toArray<double>(camera, "camera", 1);
               if (values.size() != 4) throw py::value_error("camera: needs (fx, fy, cx, cy)");
               info.camera = {values.at(0), values.at(1), values.at(2), values.at(3)};
             }
             return std::make_unique<VisionObject>(info, toSettings(more));
           }),
           py::arg("fps"), py::arg("size"), py::arg("camera") = py::none())
      .def(
          "push",
          [](VisionObject& self, const py::object& rgb, const py::object& depth,
             const py::object& mask, const py::object& time) {
            std::optional<double> time_s;
            if (!time.is_none()) time_s = toNumber(time, "time_s");
            return self.push(toImages(rgb, depth, mask), time_s);
          },
          py::arg("rgb"), py::arg("depth"), py::arg("mask") = py::none(),
          py::arg("time_s") = py::none(),
          R"(Adds images. Returns the frame that is complete now, or None.

rgb: array (rows, columns, 3) of bytes. depth: array (rows, columns), mm; 0: not measured. mask:
array (rows, columns), n inside object n; None: vision finds the objects. time_s: rises; None: one
frame interval after the images before.)")
      .def("flush", &VisionObject::flush, "Returns the frames that push() has not returned yet.")
      .def_property_readonly("info", [](VisionObject& self) { return toPython(self.info()); });
}

py::dict wrapInfo(const SourceInfo& info) {
  py::dict to;
  to["name"] = info.name;
  to["size"] = py::make_tuple(info.width_px, info.height_px);
  to["fps"] = info.fps;
  to["metric"] = info.metric;
  to["live"] = info.live;
  to["frames"] = info.frames;
  return to;
}

std::unique_ptr<SourceObject> openSource(const py::object& source, const py::object& fps) {
  const std::string spec = toText(source, "source");
  const double rate = toNumber(fps, "fps");
  const py::gil_scoped_release unlocked;
  return std::make_unique<SourceObject>(spec, rate);
}

void addSource(py::module_& module) {
  py::class_<SourceFrames>(module, "SourceFrames")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &SourceFrames::next);
  py::class_<SourceObject>(module, "Source", "A clip or a camera: iterates over its images.")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__",
           [](SourceObject& self) {
             if (PyErr_CheckSignals() != 0) throw py::error_already_set();
             const auto images = self.read();
             if (!images) throw py::stop_iteration();
             return wrapImages(*images);
           })
      .def(
          "rewind",
          [](SourceObject& self) {
            const py::gil_scoped_release unlocked;
            const std::lock_guard lock(self.mutex());
            self.get().rewind();
          },
          "Begins the clip again.")
      .def(
          "frames",
          [](const py::object& self, const py::kwargs& more) {
            return std::make_unique<SourceFrames>(self, toSettings(more));
          },
          "Iterates over the frames that Vision makes of the images. Options: those of Vision.")
      .def_property_readonly("info",
                             [](SourceObject& self) { return wrapInfo(self.get().info()); });
  module.def(
      "open", &openSource, py::arg("source"), py::arg("fps") = 0.0,
      "Opens a source of hapticast-server: synthetic:NAME, a folder, a file, a camera, a URL.");
}

}  // namespace

}  // namespace hapticast::python

// NOLINTNEXTLINE(readability-identifier-naming): the macro makes names of its own
PYBIND11_MODULE(_vision, module) {
  hapticast::python::py::module_::import("hapticast._hapticast");  // the classes of frames
  hapticast::python::addVision(module);
  hapticast::python::addSource(module);
}
