// SPDX-License-Identifier: MIT
// The module hapticast._hapticast: frames, Renderer, Stream and Publisher.
#include "frames.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the macro makes names of its own
PYBIND11_MODULE(_hapticast, module) {
  hapticast::python::addFrames(module);
  hapticast::python::addStream(module);
  hapticast::python::addRenderer(module);
  hapticast::python::addPublisher(module);
}
