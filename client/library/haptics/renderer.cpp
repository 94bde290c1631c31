// SPDX-License-Identifier: MIT
#include "client/include/hapticast/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "client/device/profile/device_profile.hpp"
#include "client/library/haptics/renderer_impl.hpp"
#include "common/library/require.hpp"

namespace hapticast {

namespace {

double requireStiffness(double value_N_mm, const char* what) {
  return requireRange(value_N_mm, 0.0, 1e3, what, " N/mm");
}

client::RendererSettings importSettings(const RendererSettings& from) {
  client::RendererSettings to;
  to.profile = client::loadDeviceProfile(from.profile);
  to.surface = static_cast<client::SurfaceKind>(from.surface);
  to.method = from.thesis ? Method::kThesis : Method::kHapticast;
  to.stiffness_N_mm = requireStiffness(from.stiffness_N_mm, "stiffness_N_mm");
  to.stiffness_limit_N_mm = requireStiffness(from.stiffness_limit_N_mm, "stiffness_limit_N_mm");
  return to;
}

static_assert(static_cast<int>(RendererSettings::Surface::kProxy) ==
              static_cast<int>(client::SurfaceKind::kProxy));

}  // namespace

const std::vector<std::string>& listSafetyActions() {
  static const std::vector<std::string> names(client::kSafetyActionNames.begin(),
                                              client::kSafetyActionNames.end());
  return names;
}

Renderer::Impl::Impl(const RendererSettings& settings)
    : settings_(importSettings(settings)),
      delay_s_(requireRange(settings.delay_s, 0.0, 2.0, "delay_s", " s")) {
  renderer_.emplace(settings_, feed_->pool, feed_->timing, user_, nullptr);
}

void Renderer::Impl::attach(std::shared_ptr<FrameFeed> feed) {
  if (attached_ || push_feed_ || tick_.number > 0)
    throw std::invalid_argument("the renderer has had ticks or frames: make another Renderer");
  attached_ = true;
  renderer_.reset();
  feed_ = std::move(feed);
  renderer_.emplace(settings_, feed_->pool, feed_->timing, user_, nullptr);
}

PushFeed& Renderer::Impl::pushFeed() {
  if (attached_)
    throw std::invalid_argument("the renderer plays a stream: make another Renderer for push()");
  if (!push_feed_) push_feed_.emplace(feed_, method() == Method::kThesis, delay_s_);
  return *push_feed_;
}

const Tick& Renderer::Impl::tick(double time_s, const Eigen::Vector3d& position_mm,
                                 std::uint32_t buttons) {
  constexpr double kMost_s = 9e8;  // 28 years: within 64-bit nanoseconds
  const bool valid_time = std::abs(time_s) <= kMost_s;
  const LocalTime now =
      valid_time ? LocalTime(Duration(std::llround(1e9 * time_s))) : LocalTime::min();
  const bool rises = valid_time && now > last_;
  if (rises) last_ = now;
  if (last_ == LocalTime::min()) return tick_;  // there has been no valid time at all
  client::DeviceState state;
  state.time = last_;
  state.buttons = buttons;
  state.status =
      rises && position_mm.allFinite() ? client::DeviceStatus::kOk : client::DeviceStatus::kNoData;
  if (state.status == client::DeviceStatus::kOk) state.position_mm = position_mm;
  exportReport(renderer_->tick(last_, state), time_s);
  return tick_;
}

void Renderer::Impl::exportReport(const client::TickReport& report, double time_s) {
  tick_.number = report.tick;
  tick_.time_s = time_s;
  tick_.play_time_s = toSeconds(report.play_time);
  tick_.force_N = report.force_N;
  tick_.static_force_N = report.static_force_N;
  tick_.dynamic_force_N = report.dynamic_force_N;
  tick_.hip_mm = report.hip_mm;
  tick_.contact_mm = report.contact_mm;
  tick_.penetration_mm = report.penetration_mm;
  tick_.contact = report.contact;
  tick_.safety_actions = report.safety_actions;
  tick_.halted = report.halt != client::Halt::kNone;
  tick_.object_id = report.object_present ? report.object_id : 0;
  tick_.object_mm = report.object_position_mm;
  tick_.height_mm = report.height_at_hip_mm;
}

void Renderer::Impl::setControls(const Controls& controls) {
  client::UserControls user;
  user.paused = controls.paused;
  user.rearm = controls.rearm;
  user.static_on = controls.static_on;
  user.dynamic_on = controls.dynamic_on;
  user.stiffness_factor = std::clamp(controls.stiffness_factor, 0.1, 3.0);
  user.force_factor = std::clamp(controls.force_factor, 0.0, 1.0);
  if (controls.friction) user.friction = std::clamp(*controls.friction, 0.0, 1.0);
  user_.store(user);
}

DeviceMapping Renderer::Impl::mapping() {
  return DeviceMapping::fit(feed_->timing.load().workspace, settings_.profile.workspace_mm);
}

Renderer::Renderer(const RendererSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&& from) noexcept = default;
Renderer& Renderer::operator=(Renderer&& from) noexcept = default;

void Renderer::begin(const StreamInfo& info) { impl_->pushFeed().begin(info); }

bool Renderer::push(const Frame& frame) { return impl_->pushFeed().push(frame); }

const Tick& Renderer::tick(double time_s, const Eigen::Vector3d& position_mm,
                           std::uint32_t buttons) {
  return impl_->tick(time_s, position_mm, buttons);
}

void Renderer::setControls(const Controls& controls) { impl_->setControls(controls); }

Eigen::Vector3d Renderer::toDevice(const Eigen::Vector3d& nominal_mm) const {
  return impl_->mapping().toDevice(nominal_mm);
}

Eigen::Vector3d Renderer::toNominal(const Eigen::Vector3d& device_mm) const {
  return impl_->mapping().toNominal(device_mm);
}

}  // namespace hapticast
