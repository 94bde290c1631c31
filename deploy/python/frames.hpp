// SPDX-License-Identifier: MIT
// Frames as objects of Python, and the checks of arguments. A wrong argument is one sentence.
// Thread: the one that holds Python's lock.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "hapticast/frame.hpp"

namespace hapticast::python {

namespace py = pybind11;

/// A frame with the properties of its stream.
struct StreamFrame {
  Frame frame;
  std::shared_ptr<const StreamInfo> info;
};

/// Return the value of an argument. Throw TypeError or ValueError (one line that begins with
/// `name`).
double toNumber(const py::handle& from, const char* name);
int toInteger(const py::handle& from, const char* name, int low);
std::string toText(const py::handle& from, const char* name);
Eigen::Vector3d toVector(const py::handle& from, const char* name);
/// Returns a pair of numbers, such as a point in the picture.
std::pair<double, double> toPair(const py::handle& from, const char* name);
std::pair<int, int> toSize(const py::handle& from, const char* name);
bool toTruth(const py::handle& from, const char* name);
/// Returns true for the method `thesis`, and false for `hapticast`.
bool toMethod(const py::handle& from);
/// Returns `from` as an array of `T` in C order; copies it if it has another type or order. Throws
/// unless it has numbers or truth values and `dimensions` dimensions.
template <class T>
py::array_t<T, py::array::c_style | py::array::forcecast> toArray(const py::handle& from,
                                                                  const char* name,
                                                                  py::ssize_t dimensions);

/// Raises KeyboardInterrupt after Ctrl-C. Takes Python's lock for that. Thread: one without it.
void checkSignals();

/// Returns an object with these heights. `mask` None: where the height is not NaN and above 0.
Object makeObject(const py::object& height_mm, const py::object& mask, const py::kwargs& more);
/// Returns an array of 3 numbers.
py::array_t<double> toPython(const Eigen::Vector3d& vector);
/// Returns the properties of a stream as a dictionary.
py::dict toPython(const StreamInfo& info);

/// Adds Frame and Object to the module.
void addFrames(py::module_& module);
void addRenderer(py::module_& module);
void addStream(py::module_& module);
void addPublisher(py::module_& module);
void addRecording(py::module_& module);

}  // namespace hapticast::python
