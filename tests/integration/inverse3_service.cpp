// SPDX-License-Identifier: MIT
#include "tests/integration/inverse3_service.hpp"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/time.hpp"

namespace hapticast::testing {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Json = nlohmann::json;

namespace {
std::int64_t nowNs() { return SteadyClock().now().time_since_epoch().count(); }
}  // namespace

Inverse3Service::Inverse3Service(std::string version) : version_(std::move(version)) {
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  (void)bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address);
  (void)listen(listener_, 4);
  (void)getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length);
  port_ = ntohs(address.sin_port);
  begin_ns_ = last_ns_ = nowNs();
  thread_ = std::thread([this] { serve(); });
}

Inverse3Service::~Inverse3Service() {
  stop_ = true;
  (void)shutdown(listener_, SHUT_RDWR);
  if (const int socket = socket_; socket >= 0) (void)shutdown(socket, SHUT_RDWR);
  thread_.join();
  close(listener_);
}

std::vector<Inverse3Service::Force> Inverse3Service::forces() const {
  const std::lock_guard lock(mutex_);
  return forces_;
}

double Inverse3Service::lastForce_N() const {
  const std::lock_guard lock(mutex_);
  return forces_.empty() ? 0.0 : forces_.back().force_N.norm();
}

void Inverse3Service::misbehave(const std::string& fault) {
  const std::lock_guard lock(mutex_);
  fault_ = fault;
  if (fault == "close" && socket_ >= 0) (void)shutdown(socket_, SHUT_RDWR);
}

void Inverse3Service::serve() {
  while (!stop_) {
    const int socket = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket < 0) return;
    socket_ = socket;
    talk(socket);
    socket_ = -1;
  }
}

void Inverse3Service::talk(int socket) {
  try {
    asio::io_context io;
    beast::websocket::stream<asio::ip::tcp::socket> websocket(io);
    websocket.next_layer().assign(asio::ip::tcp::v4(), socket);
    websocket.next_layer().set_option(asio::ip::tcp::no_delay(true));
    // The inventory arrives together with the answer to the handshake.
    const auto cork = [socket](int on) {
      (void)setsockopt(socket, IPPROTO_TCP, TCP_CORK, &on, sizeof on);
    };
    cork(1);
    websocket.accept();
    websocket.text(true);
    websocket.write(asio::buffer(stateText()));  // the inventory
    cork(0);
    for (;;) {
      beast::flat_buffer buffer;
      websocket.read(buffer);
      const std::string reply = answer(beast::buffers_to_string(buffer.data()));
      if (!reply.empty()) websocket.write(asio::buffer(reply));
    }
  } catch (const boost::system::system_error&) {
    const std::lock_guard lock(mutex_);  // the client has gone: the service forgets its force
    forces_.push_back({nowNs(), Vec3::Zero()});
  }
}

std::string Inverse3Service::answer(const std::string& text) {
  ++messages_;
  const Json message = Json::parse(text, nullptr, false);
  const std::lock_guard lock(mutex_);
  Vec3 force_N = Vec3::Zero();
  for (const Json& device : message.value("inverse3", Json::array())) {
    const Json command = device.value("commands", Json::object()).value("set_cursor_force", Json());
    if (command.is_null()) continue;
    const char* const key = version_ < "3.5" ? "values" : "vector";
    if (!command.contains(key) || device.value("device_id", "") != "D1") {
      ++foreign_;
      continue;
    }
    const Json& force = command[key];
    // X right, Y forward, Z up: the hand's frame has y up and z towards the user.
    force_N = {force["x"].get<double>(), force["z"].get<double>(), -force["y"].get<double>()};
  }
  forces_.push_back({nowNs(), force_N});
  move();
  if (fault_ == "silent") return "";
  if (fault_ == "text") return "no JSON {";
  if (fault_ == "long") return std::string(2U << 20U, ' ');
  return stateText();
}

/// A hand of 0.2 N/mm presses and lifts, or lets go of a grip of 50 g.
void Inverse3Service::move() {
  const std::int64_t now_ns = nowNs();
  const double wanted_mm = (now_ns - begin_ns_) / 1'000'000 % 1500 < 1000 ? -8.0 : 20.0;
  double left_s = std::min(1e-9 * static_cast<double>(now_ns - last_ns_), 0.05);
  last_ns_ = now_ns;
  const Vec3 force_N = forces_.empty() ? Vec3::Zero() : forces_.back().force_N;
  for (; left_s > 0.0; left_s -= 1e-4) {
    if (free_) {
      speed_mm_s_ += 1e-4 * 1e3 * (force_N - 0.0005 * speed_mm_s_) / 0.05;
    } else {
      const double hand_N = 0.2 * (wanted_mm - position_mm_.z()) - 0.008 * speed_mm_s_.z();
      const double faster_mm_s = 1e-4 * 1e3 * (hand_N + force_N.z()) / 0.25;
      speed_mm_s_.z() = std::clamp(speed_mm_s_.z() + faster_mm_s, -150.0, 150.0);
    }
    position_mm_ += 1e-4 * speed_mm_s_;
  }
}

std::string Inverse3Service::stateText() {
  Json position{{"x", 1e-3 * position_mm_.x()},
                {"y", -1e-3 * position_mm_.z()},
                {"z", 1e-3 * position_mm_.y()}};
  if (fault_ == "nan") position["x"] = "NaN";
  Json device{{"device_id", "D1"},
              {"config", {{"type", "inverse3"}, {"preset", "defaults"}}},
              {"state", {{"cursor_position", position}}},
              {"status", {{"calibrated", fault_ != "uncalibrated"}}}};
  if (fault_ == "no_position") device["state"] = Json::object();
  Json message{{"inverse3", Json::array()},
               {"wireless_verse_grip",
                Json::array({{{"state", {{"buttons", {{"a", false}, {"b", false}}}}}}})}};
  if (fault_ != "gone") message["inverse3"].push_back(device);
  if (!(version_ < "3.5")) message["session_id"] = 7;
  message["version"] = version_;
  return message.dump();
}

}  // namespace hapticast::testing
