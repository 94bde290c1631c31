// SPDX-License-Identifier: MIT
#include <limits>

#include "frames.hpp"

namespace hapticast::python {

namespace {

[[noreturn]] void throwType(const char* name, const char* needed, const py::handle& from) {
  const auto type = py::str(py::type::handle_of(from).attr("__name__")).cast<std::string>();
  throw py::type_error(std::string(name) + ": needs " + needed + ", not " + type);
}

}  // namespace

double toNumber(const py::handle& from, const char* name) {
  const double value = PyFloat_AsDouble(from.ptr());
  if (value == -1.0 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throwType(name, "a number", from);
  }
  return value;
}

int toInteger(const py::handle& from, const char* name, int low) {
  if (PyIndex_Check(from.ptr()) == 0) throwType(name, "a whole number", from);
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(from.ptr()));
  const long value = index ? PyLong_AsLong(index.ptr()) : -1;
  const bool failed = PyErr_Occurred() != nullptr;
  PyErr_Clear();
  if (failed || value < low || value > std::numeric_limits<int>::max())
    throw py::value_error(std::string(name) + ": is no whole number from " + std::to_string(low) +
                          " to 2147483647");
  return static_cast<int>(value);
}

std::string toText(const py::handle& from, const char* name) {
  if (!py::isinstance<py::str>(from)) throwType(name, "a text", from);
  return from.cast<std::string>();
}

template <class T>
py::array_t<T, py::array::c_style | py::array::forcecast> toArray(const py::handle& from,
                                                                  const char* name,
                                                                  py::ssize_t dimensions) {
  const py::array any = py::array::ensure(from);
  if (!any) {
    PyErr_Clear();
    throwType(name, "an array", from);
  }
  const char kind = any.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b')
    throw py::type_error(std::string(name) + ": needs an array of numbers");
  if (any.ndim() != dimensions)
    throw py::value_error(std::string(name) + ": needs " + std::to_string(dimensions) +
                          " dimensions, not " + std::to_string(any.ndim()));
  return py::array_t<T, py::array::c_style | py::array::forcecast>(any);
}

template py::array_t<float, py::array::c_style | py::array::forcecast> toArray(const py::handle&,
                                                                               const char*,
                                                                               py::ssize_t);
template py::array_t<double, py::array::c_style | py::array::forcecast> toArray(const py::handle&,
                                                                                const char*,
                                                                                py::ssize_t);
template py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast> toArray(
    const py::handle&, const char*, py::ssize_t);
template py::array_t<bool, py::array::c_style | py::array::forcecast> toArray(const py::handle&,
                                                                              const char*,
                                                                              py::ssize_t);

Eigen::Vector3d toVector(const py::handle& from, const char* name) {
  const auto array = toArray<double>(from, name, 1);
  if (array.size() != 3)
    throw py::value_error(std::string(name) + ": needs 3 numbers, not " +
                          std::to_string(array.size()));
  return {array.at(0), array.at(1), array.at(2)};
}

std::pair<double, double> toPair(const py::handle& from, const char* name) {
  const auto array = toArray<double>(from, name, 1);
  if (array.size() != 2)
    throw py::value_error(std::string(name) + ": needs 2 numbers, not " +
                          std::to_string(array.size()));
  return {array.at(0), array.at(1)};
}

std::pair<int, int> toSize(const py::handle& from, const char* name) {
  if (!py::isinstance<py::sequence>(from) || py::len(from) != 2)
    throw py::type_error(std::string(name) + ": needs (width, height)");
  const auto pair = py::reinterpret_borrow<py::sequence>(from);
  return {toInteger(pair[0], name, 1), toInteger(pair[1], name, 1)};
}

bool toTruth(const py::handle& from, const char* name) {
  const int truth = PyObject_IsTrue(from.ptr());
  if (truth >= 0) return truth == 1;
  PyErr_Clear();
  throwType(name, "True or False", from);
}

bool toMethod(const py::handle& from) {
  const std::string method = toText(from, "method");
  if (method == "thesis") return true;
  if (method == "hapticast") return false;
  throw py::value_error("method: '" + method + "' is neither hapticast nor thesis");
}

void checkSignals() {
  const py::gil_scoped_acquire locked;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

py::array_t<double> toPython(const Eigen::Vector3d& vector) {
  return py::array_t<double>(3, vector.data());
}

}  // namespace hapticast::python
