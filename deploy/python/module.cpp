// SPDX-License-Identifier: MIT
// The module hapticast._hapticast: frames, Renderer, Stream, Publisher and Recording.
#include <spdlog/spdlog.h>

#include "frames.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the macro makes names of its own
PYBIND11_MODULE(_hapticast, module) {
  spdlog::set_level(spdlog::level::warn);  // news of viewers are no output of a script
  hapticast::python::addFrames(module);
  hapticast::python::addStream(module);
  hapticast::python::addRecording(module);
  hapticast::python::addRenderer(module);
  hapticast::python::addPublisher(module);
}
