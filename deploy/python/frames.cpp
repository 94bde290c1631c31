// SPDX-License-Identifier: MIT
#include "frames.hpp"

#include <pybind11/stl.h>

#include <cstring>
#include <tuple>

namespace hapticast::python {

namespace {

/// Returns a read-only array over the values of a height map, which it keeps alive.
template <class T, class Shown = T>
py::array viewOf(const std::shared_ptr<const HeightMap>& heights, const std::vector<T>& values) {
  using Owner = std::shared_ptr<const HeightMap>;
  const py::capsule owner(new Owner(heights), [](void* held) { delete static_cast<Owner*>(held); });
  py::array view(py::dtype::of<Shown>(), {heights->height_px, heights->width_px}, values.data(),
                 owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}

py::object heightsOf(const Object& object) {
  if (!object.heights) return py::none();
  return viewOf<float>(object.heights, object.heights->height_mm);
}

py::object maskOf(const Object& object) {
  if (!object.heights) return py::none();
  return viewOf<std::uint8_t, bool>(object.heights, object.heights->mask);
}

py::object rectOf(const Object& object) {
  if (!object.heights) return py::none();
  const HeightMap& map = *object.heights;
  return py::make_tuple(map.left_px, map.top_px, map.width_px, map.height_px);
}

py::list impactsOf(const Object& object) {
  py::list impacts;
  for (const Object::Impact& each : object.impacts)
    impacts.append(py::make_tuple(each.time_s, toPython(each.delta_velocity_mm_s)));
  return impacts;
}

using Property = std::optional<double> Object::Material::*;
constexpr std::pair<const char*, Property> kMaterial[] = {
    {"stiffness_N_mm", &Object::Material::stiffness_N_mm},
    {"damping_Ns_m", &Object::Material::damping_Ns_m},
    {"static_friction", &Object::Material::static_friction},
    {"dynamic_friction", &Object::Material::dynamic_friction},
    {"texture_K_mm", &Object::Material::texture_K_mm},
    {"mass_kg", &Object::Material::mass_kg}};

py::dict materialOf(const Object& object) {
  py::dict material;
  for (const auto& [name, member] : kMaterial) {
    if (object.material.*member) material[name] = *(object.material.*member);
  }
  return material;
}

void setMaterial(Object& object, const py::handle& from) {
  if (!py::isinstance<py::dict>(from)) throw py::type_error("material: needs a dictionary");
  for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(from)) {
    const std::string name = toText(key, "material");
    bool known = false;
    for (const auto& [each, member] : kMaterial) {
      if (name != each) continue;
      object.material.*member = toNumber(value, each);
      known = true;
    }
    if (!known) throw py::value_error("material: has no property '" + name + "'");
  }
}

void setImpacts(Object& object, const py::handle& from) {
  if (!py::isinstance<py::sequence>(from))
    throw py::type_error("impacts: needs pairs of time_s and delta_velocity_mm_s");
  for (const py::handle each : from) {
    if (!py::isinstance<py::sequence>(each) || py::len(each) != 2)
      throw py::value_error("impacts: needs pairs of time_s and delta_velocity_mm_s");
    const auto pair = py::reinterpret_borrow<py::sequence>(each);
    object.impacts.push_back({toNumber(pair[0], "impacts"), toVector(pair[1], "impacts")});
  }
}

/// Sets a property of the object. Returns false if there is none of this name.
bool setProperty(Object& object, HeightMap& heights, const std::string& name,
                 const py::handle& value) {
  if (name == "left_px")
    heights.left_px = toInteger(value, "left_px", 0);
  else if (name == "top_px")
    heights.top_px = toInteger(value, "top_px", 0);
  else if (name == "id")
    object.id = static_cast<std::uint32_t>(toInteger(value, "id", 0));
  else if (name == "layer")
    object.layer = static_cast<std::uint32_t>(toInteger(value, "layer", 0));
  else if (name == "position_mm")
    object.position_mm = toVector(value, "position_mm");
  else if (name == "velocity_mm_s")
    object.velocity_mm_s = toVector(value, "velocity_mm_s");
  else if (name == "acceleration_mm_s2")
    object.acceleration_mm_s2 = toVector(value, "acceleration_mm_s2");
  else if (name == "angle_rad")
    object.angle_rad = toNumber(value, "angle_rad");
  else if (name == "angular_velocity_rad_s")
    object.angular_velocity_rad_s = toNumber(value, "angular_velocity_rad_s");
  else if (name == "impacts")
    setImpacts(object, value);
  else if (name == "material")
    setMaterial(object, value);
  else
    return false;
  return true;
}

}  // namespace

Object makeObject(const py::object& height_mm, const py::object& mask, const py::kwargs& more) {
  const auto heights = toArray<float>(height_mm, "height_mm", 2);
  auto map = std::make_shared<HeightMap>(0, 0, static_cast<int>(heights.shape(1)),
                                         static_cast<int>(heights.shape(0)));
  if (heights.size() > 0)
    std::memcpy(map->height_mm.data(), heights.data(), map->height_mm.size() * sizeof(float));
  if (mask.is_none()) {
    for (std::size_t i = 0; i < map->mask.size(); ++i) map->mask[i] = map->height_mm[i] > 0.0F;
  } else {
    const auto inside = toArray<bool>(mask, "mask", 2);
    if (inside.shape(0) != heights.shape(0) || inside.shape(1) != heights.shape(1))
      throw py::value_error("mask: has another shape than height_mm");
    if (inside.size() > 0) std::memcpy(map->mask.data(), inside.data(), map->mask.size());
  }
  Object object;
  for (const auto& [key, value] : more) {
    const std::string name = toText(key, "keyword");
    if (!setProperty(object, *map, name, value))
      throw py::type_error("'" + name + "' is no property of an object");
  }
  object.heights = std::move(map);
  return object;
}

py::dict toPython(const StreamInfo& info) {
  py::dict to;
  to["name"] = info.name;
  to["fps"] = info.fps;
  to["size"] = py::make_tuple(info.width_px, info.height_px);
  to["size_mm"] = py::make_tuple(info.width_mm, info.height_mm, info.depth_mm);
  to["method"] = info.thesis ? "thesis" : "hapticast";
  to["latency_s"] = info.latency_s;
  to["mass_kg"] = info.mass_kg;
  return to;
}

namespace {

void addObject(py::module_& module) {
  const auto vector = [](const Eigen::Vector3d Object::*member) {
    return [member](const Object& object) { return toPython(object.*member); };
  };
  py::class_<Object>(module, "Object", "An object that can be touched, at one instant.")
      .def(py::init(&makeObject), py::arg("height_mm"), py::arg("mask") = py::none())
      .def_readonly("id", &Object::id)
      .def_readonly("layer", &Object::layer)
      .def_property_readonly("height_mm", &heightsOf)
      .def_property_readonly("mask", &maskOf)
      .def_property_readonly("rect", &rectOf)
      .def_property_readonly("position_mm", vector(&Object::position_mm))
      .def_property_readonly("velocity_mm_s", vector(&Object::velocity_mm_s))
      .def_property_readonly("acceleration_mm_s2", vector(&Object::acceleration_mm_s2))
      .def_readonly("angle_rad", &Object::angle_rad)
      .def_readonly("angular_velocity_rad_s", &Object::angular_velocity_rad_s)
      .def_readonly("quality", &Object::quality)
      .def_readonly("visible_fraction", &Object::visible_fraction)
      .def_property_readonly("impacts", &impactsOf)
      .def_property_readonly("material", &materialOf)
      .def("__repr__", [](const Object& object) {
        return "<hapticast.Object " + std::to_string(object.id) + ">";
      });
}

}  // namespace

void addFrames(py::module_& module) {
  addObject(module);
  py::class_<StreamFrame>(module, "Frame", "All objects at one instant.")
      .def(py::init([](const py::object& time_s, const std::vector<Object>& objects,
                       const py::object& size, const py::object& fps) {
             StreamFrame to;
             to.frame.time_s = toNumber(time_s, "time_s");
             to.frame.objects = objects;
             StreamInfo info;
             info.fps = toNumber(fps, "fps");
             std::tie(info.width_px, info.height_px) = toSize(size, "size");
             to.info = std::make_shared<const StreamInfo>(info);
             return to;
           }),
           py::arg("time_s"), py::arg("objects"), py::arg("size") = py::make_tuple(640, 480),
           py::arg("fps") = 25.0)
      .def_property_readonly("id", [](const StreamFrame& from) { return from.frame.id; })
      .def_property_readonly("epoch", [](const StreamFrame& from) { return from.frame.epoch; })
      .def_property_readonly("time_s", [](const StreamFrame& from) { return from.frame.time_s; })
      .def_property_readonly("objects", [](const StreamFrame& from) { return from.frame.objects; })
      .def_property_readonly("info", [](const StreamFrame& from) { return toPython(*from.info); })
      .def_property_readonly("jpeg",
                             [](const StreamFrame& from) {
                               const auto& jpeg = from.frame.jpeg;
                               return py::bytes(reinterpret_cast<const char*>(jpeg.data()),
                                                jpeg.size());
                             })
      .def("__repr__", [](const StreamFrame& from) {
        return "<hapticast.Frame " + std::to_string(from.frame.id) + " at " +
               std::to_string(from.frame.time_s) + " s, " +
               std::to_string(from.frame.objects.size()) + " objects>";
      });
}

}  // namespace hapticast::python
