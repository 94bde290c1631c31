// SPDX-License-Identifier: MIT
// What the worker of the page calls to view a stream (page/core.js). Bytes come in through
// input(), and go out through output() with the returned size. Times are ms of the page's clock.
// A result of many numbers is an array of doubles, which is valid until the next call; core.js
// names its elements. Thread: one.
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "client/web/exports.hpp"
#include "client/web/viewer.hpp"

namespace hapticast::client {

namespace {

/// Kinds of messages for the page.
enum class Kind : int {
  kError = 0,
  kWelcome = 1,
  kDescription = 2,
  kFrame = 3,
  kPicture = 4,
  kPreparing = 5,
  kControl = 6,
  kOther = 7,
};

struct Page {
  std::unique_ptr<WebViewer> viewer;
  StreamDescription description;
  std::string key;
  ErrorCode error = ErrorCode::kMalformed;
  double value = 0.0;  // share of a scan, time of a picture, number of viewers
  std::array<double, 40> numbers{};
  std::vector<float> history;
  std::vector<float> heights;
};

Page& page() {
  static Page the_page;
  return the_page;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double toMs(MediaTime time) { return 1e3 * toSeconds(time); }

/// Appends numbers to the array of the page.
class Numbers {
 public:
  Numbers& add(double value) {
    page().numbers[count_++] = value;
    return *this;
  }
  Numbers& add(const Vec3& vector) { return add(vector.x()).add(vector.y()).add(vector.z()); }
  [[nodiscard]] const double* result() const { return page().numbers.data(); }

 private:
  std::size_t count_ = 0;
};

Kind classify(Welcome& welcome) {
  page().description = std::move(welcome.description);
  page().key = welcome.verifying_key ? toHex(*welcome.verifying_key) : "";
  return Kind::kWelcome;
}
Kind classify(StreamDescription& description) {
  page().description = std::move(description);
  return Kind::kDescription;
}
Kind classify(CodedFrame& /*frame*/) { return Kind::kFrame; }
Kind classify(VideoFrame& picture) {
  page().value = toMs(picture.media_time);
  web::setOutput(std::move(picture.jpeg));
  return Kind::kPicture;
}
Kind classify(Preparing& preparing) {
  page().value = preparing.share;
  return Kind::kPreparing;
}
Kind classify(Control& control) {
  page().value = control.viewers ? static_cast<double>(*control.viewers) : kNone;
  return Kind::kControl;
}
template <class Other>
Kind classify(Other& /*other*/) {
  return Kind::kOther;
}

/// Returns the keys in a text of words with 64 hex digits each.
std::vector<KeyBytes> parseKeys(std::string_view text) {
  std::vector<KeyBytes> keys;
  for (std::size_t begin = 0; begin + 2 * kKeyBytes <= text.size(); begin += 2 * kKeyBytes + 1)
    if (const auto key = parseKey(text.substr(begin, 2 * kKeyBytes))) keys.push_back(*key);
  return keys;
}

}  // namespace

/// Begins another session. The input: keys of origins (hex digits, one blank between them); empty:
/// each server counts.
WEB_EXPORT(start) void start() {
  const std::string text = web::inputText();
  page().viewer = std::make_unique<WebViewer>(
      text.empty() ? OriginPin() : OriginPin("this link", parseKeys(text)));
}

/// Writes the first message for a server. The input: the access token.
WEB_EXPORT(hello) std::size_t hello() {
  return web::setOutput(WebViewer::makeHello(web::inputText()));
}

/// Processes a message in the input. Returns its kind. After an error, the output is its sentence.
WEB_EXPORT(receive) int receive(double now_ms) {
  auto message = page().viewer->receive(web::input(), web::toLocal(now_ms));
  if (message.ok())
    return static_cast<int>(std::visit([](auto& each) { return classify(each); }, message.value()));
  page().error = message.error().code;
  web::setOutput(message.error().message);
  return static_cast<int>(Kind::kError);
}
/// Returns the code of the error that receive() returned last (proto/README.md, section 7).
WEB_EXPORT(errorCode) int errorCode() { return static_cast<int>(page().error); }
/// Returns 1 if the error of receive() was a server with another key than expected.
WEB_EXPORT(untrusted) int untrusted() { return page().viewer->untrusted() ? 1 : 0; }
/// Returns the number that belongs to the last message: the share of a scan (0..1), the media time
/// of a picture (ms), or the number of viewers (NaN: unknown).
WEB_EXPORT(value) double value() { return page().value; }

WEB_EXPORT(prepare) int prepare(double now_ms) {
  return page().viewer->prepareNext(web::toLocal(now_ms)) ? 1 : 0;
}
/// Writes the next message that is due. Returns its size, or 0.
WEB_EXPORT(poll) std::size_t poll(double now_ms) {
  const auto message = page().viewer->poll(web::toLocal(now_ms));
  return message ? web::setOutput(*message) : 0;
}
WEB_EXPORT(disconnect) void disconnect(double now_ms) {
  page().viewer->disconnect(web::toLocal(now_ms));
}

/// Writes a request for the server. An absent value is NaN.
WEB_EXPORT(control)
std::size_t control(double paused, double seek_s, double speed, double stiffness_N_mm,
                    double damping_Ns_m, double static_friction, double dynamic_friction,
                    double texture_K_mm, double mass_kg) {
  const auto given = [](double value) {
    return std::isnan(value) ? std::nullopt : std::optional<double>(value);
  };
  Control request;
  if (!std::isnan(paused)) request.paused = paused != 0.0;
  request.seek_s = given(seek_s);
  request.speed = given(speed);
  request.material = {given(stiffness_N_mm),   given(damping_Ns_m), given(static_friction),
                      given(dynamic_friction), given(texture_K_mm), given(mass_kg)};
  return web::setOutput(encode(request));
}

/// Writes the name of the stream, and the key of the server (hex digits, or empty).
WEB_EXPORT(streamName) std::size_t streamName() { return web::setOutput(page().description.name); }
WEB_EXPORT(serverKey) std::size_t serverKey() { return web::setOutput(page().key); }
/// Returns the numbers of the stream's description.
WEB_EXPORT(stream) const double* stream() {
  const StreamDescription& from = page().description;
  Numbers numbers;
  numbers.add(from.workspace.width_px).add(from.workspace.height_px).add(from.fps);
  numbers.add(from.workspace.width_mm).add(from.workspace.height_mm).add(from.workspace.depth_mm);
  numbers.add(from.workspace.stretch ? 1.0 : 0.0);
  const Timeline timeline = from.timeline.value_or(Timeline{});
  numbers.add(from.timeline ? timeline.length_s : kNone).add(timeline.position_s);
  numbers.add(toMs(timeline.at)).add(timeline.speed);
  return numbers.result();
}

WEB_EXPORT(point) void point(double x_mm, double y_mm, double z_mm) {
  page().viewer->point({x_mm, y_mm, z_mm});
}
/// Sets the controls of the user. `friction`: NaN keeps the author's. `rearm` counts.
WEB_EXPORT(setControls)
void setControls(int paused, int rearm, int static_on, int dynamic_on, double stiffness_factor,
                 double force_factor, double friction) {
  UserControls controls;
  controls.paused = paused != 0;
  controls.rearm = static_cast<std::uint32_t>(rearm);
  controls.static_on = static_on != 0;
  controls.dynamic_on = dynamic_on != 0;
  controls.stiffness_factor = stiffness_factor;
  controls.force_factor = force_factor;
  if (!std::isnan(friction)) controls.friction = friction;
  page().viewer->setControls(controls);
}
/// Renders a tick with the simulated hand.
WEB_EXPORT(tick) void tick(double now_ms) { page().viewer->tick(web::toLocal(now_ms)); }
/// Renders a tick with a given position of the device, device mm.
WEB_EXPORT(tickAt) void tickAt(double now_ms, double x_mm, double y_mm, double z_mm) {
  page().viewer->tickAt(web::toLocal(now_ms), {x_mm, y_mm, z_mm});
}
/// Returns the numbers of the last tick.
WEB_EXPORT(report) const double* report(double now_ms) {
  const WebViewer& viewer = *page().viewer;
  const TickReport& from = viewer.report();
  Numbers numbers;
  numbers.add(toMs(from.play_time)).add(1e3 * toSeconds(from.playout_delay));
  numbers.add(from.hip_mm).add(from.contact_mm).add(from.force_N);
  numbers.add(from.static_force_N).add(from.dynamic_force_N).add(from.penetration_mm);
  numbers.add(from.contact ? 1.0 : 0.0).add(static_cast<double>(from.lookup));
  numbers.add(from.over_object ? 1.0 : 0.0).add(from.height_at_hip_mm);
  numbers.add(from.object_present ? 1.0 : 0.0).add(from.halt == Halt::kNone ? 0.0 : 1.0);
  const ReceiverCounts& counts = viewer.counts();
  numbers.add(static_cast<double>(counts.received)).add(static_cast<double>(counts.lost));
  numbers.add(static_cast<double>(counts.late)).add(toMs(viewer.mediaNow(web::toLocal(now_ms))));
  return numbers.result();
}
/// Write the lines for the user.
WEB_EXPORT(advice) std::size_t advice() { return web::setOutput(page().viewer->adviceLine()); }
WEB_EXPORT(hint) std::size_t hint() { return web::setOutput(page().viewer->beginnersLine()); }
WEB_EXPORT(states) std::size_t states() { return web::setOutput(page().viewer->stateLine()); }
/// Returns the history since the last call: historySize() floats.
WEB_EXPORT(history) const float* history() {
  page().history = page().viewer->popHistory();
  return page().history.data();
}
WEB_EXPORT(historySize) std::size_t historySize() { return page().history.size(); }

/// Returns the number of objects in the newest prepared frame, and its media time, ms.
WEB_EXPORT(reliefCount) std::size_t reliefCount() {
  return page().viewer->reliefs().reliefs.size();
}
WEB_EXPORT(reliefTime_ms) double reliefTime_ms() {
  return toMs(page().viewer->reliefs().media_time);
}
/// Samples the relief of the object `index`, at most `most_side` heights along each side. Returns
/// u, v, width, height (px), columns, rows and the step (px); no columns: it has no relief.
WEB_EXPORT(sampleRelief) const double* sampleRelief(std::size_t index, int most_side) {
  std::vector<float>& heights = page().heights;
  heights.clear();
  Numbers numbers;
  const auto field = page().viewer->reliefs().reliefs[index].lock();
  if (!field || field->empty()) {
    for (int i = 0; i < 7; ++i) numbers.add(0.0);
    return numbers.result();
  }
  const PixelRect rect = field->rect();
  const int step = 1 + (std::max(rect.width, rect.height) - 1) / std::max(most_side, 2);
  const int columns = 1 + (rect.width - 1) / step, rows = 1 + (rect.height - 1) / step;
  heights.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec2 at(rect.u + column * step + 0.5, rect.v + row * step + 0.5);
      heights.push_back(field->inside(at) ? static_cast<float>(field->bilinear(at).height_mm)
                                          : std::numeric_limits<float>::quiet_NaN());
    }
  numbers.add(rect.u).add(rect.v).add(rect.width).add(rect.height);
  numbers.add(columns).add(rows).add(step);
  return numbers.result();
}
WEB_EXPORT(heights) const float* heights() { return page().heights.data(); }

}  // namespace hapticast::client
