// SPDX-License-Identifier: MIT
// hapticast.Stream: frames of a server.
#include "hapticast/stream.hpp"

#include <algorithm>

#include "frames.hpp"

namespace hapticast::python {

namespace {

// Interval in which a wait checks for Ctrl-C.
constexpr double kCheckEvery_s = 0.1;

StreamSettings toSettings(const py::kwargs& from) {
  StreamSettings to;
  for (const auto& [key, value] : from) {
    const std::string name = toText(key, "keyword");
    if (name == "token")
      to.token = toText(value, "token");
    else if (name == "tls")
      to.tls = toTruth(value, "tls");
    else if (name == "tls_ca_file")
      to.tls_ca_file = toText(value, "tls_ca_file");
    else if (name == "insecure")
      to.insecure = toTruth(value, "insecure");
    else if (name == "udp")
      to.udp = toTruth(value, "udp");
    else if (name == "pictures")
      to.pictures = toTruth(value, "pictures");
    else if (name == "reconnect")
      to.reconnect = toTruth(value, "reconnect");
    else if (name == "max_waiting")
      to.max_waiting = static_cast<std::size_t>(toInteger(value, "max_waiting", 1));
    else if (name == "timeout")
      to.connect_timeout_s = toNumber(value, "timeout");
    else if (name == "method")
      to.thesis = toMethod(value);
    else
      throw py::type_error("'" + name + "' is no option of a Stream");
  }
  to.name = "python";
  return to;
}

std::unique_ptr<Stream> connect(const py::object& address, const py::kwargs& options) {
  const std::string name = toText(address, "address");
  const StreamSettings settings = toSettings(options);
  const py::gil_scoped_release unlocked;
  return std::make_unique<Stream>(name, settings);
}

/// Returns the next frame; nullopt after `timeout_s` (negative: none) or at the end.
std::optional<Frame> waitForFrame(Stream& stream, double timeout_s) {
  const double until_s = Stream::now() + timeout_s;
  for (;;) {
    std::optional<Frame> frame;
    {
      const py::gil_scoped_release unlocked;
      const double left_s = timeout_s < 0.0 ? kCheckEvery_s : until_s - Stream::now();
      frame = stream.next(std::clamp(left_s, 0.0, kCheckEvery_s));
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (frame || stream.ended()) return frame;
    if (timeout_s >= 0.0 && Stream::now() >= until_s) return frame;
  }
}

py::object wrap(Stream& stream, std::optional<Frame> frame) {
  if (!frame) return py::none();
  return py::cast(
      StreamFrame{std::move(*frame), std::make_shared<const StreamInfo>(stream.info())});
}

}  // namespace

void addStream(py::module_& module) {
  py::class_<Stream>(module, "Stream", R"(Receives the frames of a server.

address: "HOST", "HOST:PORT", "hapticasts://HOST" or "mdns:NAME".
token, tls, tls_ca_file, insecure: access and encryption, as in hapticast-client.
udp: True: frames by UDP. pictures: True: frames have a picture. reconnect: True: go on after a loss.
max_waiting: frames that wait for the reader (default 64); the oldest are dropped, and counted.
timeout: s for each step of the connection. method: "thesis" for a renderer with this method.)")
      .def(py::init(&connect), py::arg("address") = "localhost:7447")
      .def(
          "next",
          [](Stream& self, const py::object& timeout) {
            const double timeout_s = timeout.is_none() ? -1.0 : toNumber(timeout, "timeout");
            return wrap(self, waitForFrame(self, timeout_s));
          },
          py::arg("timeout") = py::none(),
          "Returns the next frame. Returns None after timeout s, and at the end of the stream.")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__",
           [](Stream& self) {
             auto frame = waitForFrame(self, -1.0);
             if (!frame) throw py::stop_iteration();
             return wrap(self, std::move(frame));
           })
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__",
           [](Stream& self, const py::args&) {
             const py::gil_scoped_release unlocked;
             self.close();
           })
      .def(
          "close", [](Stream& self) { self.close(); }, py::call_guard<py::gil_scoped_release>(),
          "Ends the connection.")
      .def_property_readonly("info", [](Stream& self) { return toPython(self.info()); })
      .def_property_readonly("connected", [](Stream& self) { return self.connected(); })
      .def_property_readonly("ended", [](Stream& self) { return self.ended(); })
      .def_property_readonly("dropped", [](Stream& self) { return self.dropped(); });
}

}  // namespace hapticast::python
