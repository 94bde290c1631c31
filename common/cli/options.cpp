// SPDX-License-Identifier: MIT
#include "common/cli/options.hpp"

#include <cstdint>
#include <iomanip>
#include <sstream>
#include <string_view>
#include <type_traits>

namespace hapticast {

std::optional<Vec2> parsePair(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const std::string_view view = text;
  const auto first = parseNumber(view.substr(0, comma));
  const auto second = parseNumber(view.substr(comma + 1));
  if (!first || !second) return std::nullopt;
  return Vec2(*first, *second);
}

Endpoint parseEndpointOr(const std::string& text, const Endpoint& otherwise,
                         const std::string& name, std::uint16_t least_port,
                         const std::string& form) {
  const auto endpoint = parseEndpoint(text, otherwise);
  if (endpoint && endpoint->port >= least_port) return *endpoint;
  throw CLI::ValidationError(
      name, quote(text) + " is not " + form + " (port " + std::to_string(least_port) + "..65535)");
}

CLI::Option* addEndpoint(CLI::App& app, const std::string& name, Endpoint& value,
                         std::uint16_t least_port, const std::string& form,
                         const std::string& help) {
  const auto set = [&value, otherwise = value, name, least_port, form](const std::string& text) {
    value = parseEndpointOr(text, otherwise, name, least_port, form);
  };
  return app.add_option_function<std::string>(name, set, help)
      ->type_name(form.substr(0, form.find_first_of(" ,")));
}

template <class Number>
CLI::ValidationError notANumber(const std::string& name, const std::string& text, Number least,
                                Number most) {
  std::ostringstream form;
  form << std::setprecision(12) << (std::is_integral_v<Number> ? "a whole number" : "a number")
       << " from " << least << " to " << most;
  return CLI::ValidationError(name, quote(text) + " is not " + form.str());
}
template CLI::ValidationError notANumber(const std::string&, const std::string&, double, double);
template CLI::ValidationError notANumber(const std::string&, const std::string&, std::uint64_t,
                                         std::uint64_t);

CLI::Option* addPair(CLI::App& app, const std::string& name,
                     const std::function<bool(const Vec2&)>& set_pair, const std::string& form,
                     const std::string& help) {
  const auto set = [set_pair, name, form](const std::string& text) {
    const auto pair = parsePair(text);
    if (!pair || !set_pair(*pair))
      throw CLI::ValidationError(name, quote(text) + " is not " + form);
  };
  return app.add_option_function<std::string>(name, set, help)
      ->type_name(form.substr(0, form.find(' ')));
}

}  // namespace hapticast
