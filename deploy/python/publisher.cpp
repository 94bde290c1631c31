// SPDX-License-Identifier: MIT
// hapticast.Publisher: a server from Python.
#include "hapticast/publisher.hpp"

#include <mutex>
#include <tuple>

#include "frames.hpp"

namespace hapticast::python {

namespace {

PublisherSettings toSettings(const py::object& port, const py::object& size, const py::object& fps,
                             const py::kwargs& more) {
  PublisherSettings to;
  std::string host = "[::]";
  std::tie(to.info.width_px, to.info.height_px) = toSize(size, "size");
  to.info.fps = toNumber(fps, "fps");
  for (const auto& [key, value] : more) {
    const std::string name = toText(key, "keyword");
    if (name == "name")
      to.info.name = toText(value, "name");
    else if (name == "host")
      host = toText(value, "host");
    else if (name == "udp")
      to.udp = toTruth(value, "udp");
    else if (name == "tls_cert_file")
      to.tls_cert_file = toText(value, "tls_cert_file");
    else if (name == "tls_key_file")
      to.tls_key_file = toText(value, "tls_key_file");
    else if (name == "tokens_file")
      to.tokens_file = toText(value, "tokens_file");
    else if (name == "max_viewers")
      to.max_viewers = static_cast<std::size_t>(toInteger(value, "max_viewers", 1));
    else
      throw py::type_error("'" + name + "' is no option of a Publisher");
  }
  to.listen = host + ":" + std::to_string(toInteger(port, "port", 0));
  return to;
}

/// A Publisher for several threads of Python.
class PublisherObject {
 public:
  explicit PublisherObject(const PublisherSettings& settings) : publisher_(settings) {}

  double publish(const Frame& frame, double time_s) {
    const std::lock_guard lock(mutex_);
    return publisher_.publish(frame, time_s);
  }
  void close() {
    const std::lock_guard lock(mutex_);
    publisher_.close();
  }
  [[nodiscard]] const Publisher& get() const { return publisher_; }

 private:
  std::mutex mutex_;
  Publisher publisher_;
};

/// publish(frame), or publish(height_mm, mask, **properties).
double publish(PublisherObject& self, const py::object& what, const py::object& mask,
               const py::object& time, const py::kwargs& more) {
  const double time_s = time.is_none() ? -1.0 : toNumber(time, "time_s");
  Frame frame;
  if (py::isinstance<StreamFrame>(what)) {
    if (!mask.is_none() || py::len(more) > 0)
      throw py::type_error("a frame has its properties already");
    frame = what.cast<const StreamFrame&>().frame;
  } else {
    frame.objects.push_back(makeObject(what, mask, more));
  }
  const py::gil_scoped_release unlocked;
  return self.publish(frame, time_s);
}

}  // namespace

void addPublisher(py::module_& module) {
  py::class_<PublisherObject>(module, "Publisher",
                              R"(Publishes a haptic video: a server from Python.

port: TCP port; 0: a free one. size: (width, height) of the picture, px. fps: frames/s.
name, host, udp, tls_cert_file, tls_key_file, tokens_file, max_viewers: as in hapticast-server.)")
      .def(py::init([](const py::object& port, const py::object& size, const py::object& fps,
                       const py::kwargs& more) {
             return std::make_unique<PublisherObject>(toSettings(port, size, fps, more));
           }),
           py::arg("port") = 7447, py::arg("size") = py::make_tuple(640, 480),
           py::arg("fps") = 25.0)
      .def("publish", &publish, py::arg("height_mm"), py::arg("mask") = py::none(),
           py::arg("time_s") = py::none(),
           R"(Sends a frame to all viewers. Returns its time, s.

height_mm: a Frame; or an array (rows, columns) of one object's heights, mm. mask: array of the same
shape, True inside the object; None: where the height is above 0. time_s: of the capture, on the
clock of now; None: the present time. More: left_px, top_px (place in the picture), id, layer,
position_mm, velocity_mm_s, acceleration_mm_s2 (3 numbers each), angle_rad,
angular_velocity_rad_s, impacts (pairs of time_s and delta_velocity_mm_s), material (a dictionary).)")
      .def("close", &PublisherObject::close, py::call_guard<py::gil_scoped_release>(),
           "Sends a goodbye to all viewers and closes the port.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__",
           [](PublisherObject& self, const py::args&) {
             const py::gil_scoped_release unlocked;
             self.close();
           })
      .def_property_readonly("port", [](const PublisherObject& self) { return self.get().port(); })
      .def_property_readonly("viewers",
                             [](const PublisherObject& self) { return self.get().viewers(); })
      .def_property_readonly("now", [](const PublisherObject& self) { return self.get().now(); });
}

}  // namespace hapticast::python
