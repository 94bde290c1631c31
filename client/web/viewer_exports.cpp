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

struct Page {
  std::unique_ptr<WebViewer> viewer;
  StreamDescription description;
  std::string key;
  Control act;         // of another operator
  double value = 0.0;  // share of a scan, time of a picture, number of viewers
  std::array<double, 40> numbers{};
  std::array<const char*, 40> names{};  // of the numbers
  std::size_t count = 0;                // of both
  std::vector<std::uint8_t> jpeg;
  std::vector<float> history;
  std::vector<float> heights;
};

Page& page() {
  static Page the_page;
  return the_page;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double toMs(MediaTime time) { return 1e3 * toSeconds(time); }

/// Fills the array of the page with numbers and their names. The elements of a vector have one
/// name.
class Numbers {
 public:
  Numbers() { page().count = 0; }
  Numbers& add(const char* name, double value) {
    page().names[page().count] = name;
    page().numbers[page().count++] = value;
    return *this;
  }
  Numbers& add(const char* name, const Vec3& vector) {
    return add(name, vector.x()).add(name, vector.y()).add(name, vector.z());
  }
  [[nodiscard]] const double* result() const { return page().numbers.data(); }
};

// Return the name of the message's kind for the page, and keep its content.
const char* onMessage(Welcome& welcome) {
  page().description = std::move(welcome.description);
  page().key = welcome.verifying_key ? toHex(*welcome.verifying_key) : "";
  return "welcome";
}
const char* onMessage(StreamDescription& description) {
  page().description = std::move(description);
  return "description";
}
const char* onMessage(CodedFrame& /*frame*/) { return "frame"; }
const char* onMessage(VideoFrame& picture) {
  page().value = toMs(picture.media_time);
  page().jpeg = std::move(picture.jpeg);
  return "picture";
}
const char* onMessage(Preparing& preparing) {
  page().value = preparing.share;
  return "preparing";
}
const char* onMessage(Control& control) {
  if (control.at) {
    page().act = std::move(control);
    return "act";
  }
  page().value = control.viewers ? static_cast<double>(*control.viewers) : kNone;
  return "control";
}
template <class Other>
const char* onMessage(Other& /*other*/) {
  return "other";
}

/// Returns the keys in a text of words with 64 hex digits each.
std::vector<KeyBytes> parseKeys(std::string_view text) {
  std::vector<KeyBytes> keys;
  for (std::size_t begin = 0; begin + 2 * kKeyBytes <= text.size(); begin += 2 * kKeyBytes + 1)
    if (const auto key = parseKey(text.substr(begin, 2 * kKeyBytes))) keys.push_back(*key);
  return keys;
}

}  // namespace

/// Begins with another server. The input: the keys of origins (hex digits, one blank between them;
/// none: each server counts), a line break, the name of the user (or nothing), a line break, and
/// the access token (or nothing).
WEB_EXPORT(start) void start() {
  const std::string text = web::inputText();
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string keys = text.substr(0, end);
  const std::size_t name = std::min(end + 1, text.size());
  const std::size_t name_end = std::min(text.find('\n', name), text.size());
  page().viewer = std::make_unique<WebViewer>(
      keys.empty() ? OriginPin() : OriginPin("this link", parseKeys(keys)),
      text.substr(std::min(name_end + 1, text.size())), text.substr(name, name_end - name));
}

/// Begins a session. Returns 1, or 0 if it may not be: closeSession() follows.
WEB_EXPORT(openSession) int openSession(double now_ms, int encrypted, int of_this_machine) {
  return page().viewer->open({encrypted != 0, of_this_machine != 0}, web::toLocal(now_ms)) ? 1 : 0;
}
/// Processes a message in the input, and writes the name of its kind, or "error": closeSession()
/// follows.
WEB_EXPORT(receive) std::size_t receive(double now_ms) {
  auto message = page().viewer->receive(web::input(), web::toLocal(now_ms));
  if (!message) return web::setOutput("error");
  return web::setOutput(std::visit([](auto& each) { return onMessage(each); }, *message));
}
/// Returns 1 if a time limit of the session has passed: closeSession() follows.
WEB_EXPORT(expire) int expire(double now_ms) {
  return page().viewer->expire(web::toLocal(now_ms)) ? 1 : 0;
}
/// Sets why the connection has ended: the sentence in the input. `malformed`: the peer sent what is
/// no message.
WEB_EXPORT(setEnd) void setEnd(int malformed) {
  page().viewer->setEnd(
      {.why = web::inputText(),
       .code = malformed != 0 ? std::optional(ErrorCode::kMalformed) : std::nullopt});
}
/// Ends the session and writes why, in one sentence. Returns the pause until the next one, ms, or
/// NaN if no further one can succeed.
WEB_EXPORT(closeSession) double closeSession(double now_ms) {
  const auto pause = page().viewer->close(web::toLocal(now_ms));
  web::setOutput(page().viewer->end().why);
  return pause ? 1e3 * toSeconds(*pause) : kNone;
}
/// Writes the JPEG of the last picture.
WEB_EXPORT(picture) std::size_t picture() { return web::setOutput(std::move(page().jpeg)); }
/// Returns the number that belongs to the last message: the share of a scan (0..1), the media time
/// of a picture (ms), or the number of viewers (NaN: unknown).
WEB_EXPORT(value) double value() { return page().value; }

/// Returns the numbers of the last act of another operator. A number that it did not set is NaN.
WEB_EXPORT(act) const double* act() {
  const Control& from = page().act;
  Numbers numbers;
  numbers.add("at_ms", from.at ? toMs(*from.at) : kNone);
  numbers.add("paused", from.paused ? (*from.paused ? 1.0 : 0.0) : kNone);
  numbers.add("seek_s", from.seek_s.value_or(kNone)).add("speed", from.speed.value_or(kNone));
  numbers.add("material", from.material == Material{} ? kNone : 1.0);
  return numbers.result();
}
/// Writes the name of the operator who acted.
WEB_EXPORT(actor) std::size_t actor() { return web::setOutput(page().act.operator_name); }

WEB_EXPORT(prepare) int prepare(double now_ms) {
  return page().viewer->prepareNext(web::toLocal(now_ms)) ? 1 : 0;
}
/// Writes the next message that is due. Returns its size, or 0.
WEB_EXPORT(poll) std::size_t poll(double now_ms) {
  const auto message = page().viewer->poll(web::toLocal(now_ms));
  return message ? web::setOutput(*message) : 0;
}
/// Requests another pause, place, speed or material of the server. An absent value is NaN.
WEB_EXPORT(control)
void control(double paused, double seek_s, double speed, double stiffness_N_mm, double damping_Ns_m,
             double static_friction, double dynamic_friction, double texture_K_mm, double mass_kg) {
  const auto given = [](double value) {
    return std::isnan(value) ? std::nullopt : std::optional<double>(value);
  };
  Control request;
  if (!std::isnan(paused)) request.paused = paused != 0.0;
  request.seek_s = given(seek_s);
  request.speed = given(speed);
  request.material = {given(stiffness_N_mm),   given(damping_Ns_m), given(static_friction),
                      given(dynamic_friction), given(texture_K_mm), given(mass_kg)};
  page().viewer->request(request);
}

/// Requests pictures (1) or none (0) of the server.
WEB_EXPORT(requestPictures) void requestPictures(int wanted) {
  page().viewer->requestPictures(wanted != 0);
}

/// Writes the name of the stream, and the key of the server (hex digits, or empty).
WEB_EXPORT(streamName) std::size_t streamName() { return web::setOutput(page().description.name); }
WEB_EXPORT(serverKey) std::size_t serverKey() { return web::setOutput(page().key); }
/// Returns the number of elements in the last array, and writes their names, with blanks between.
WEB_EXPORT(count) std::size_t count() { return page().count; }
WEB_EXPORT(names) std::size_t names() {
  std::string text;
  for (std::size_t i = 0; i < page().count; ++i)
    text.append(i > 0 ? " " : "").append(page().names[i]);
  return web::setOutput(text);
}
/// Returns the numbers of the stream's description.
WEB_EXPORT(stream) const double* stream() {
  const StreamDescription& from = page().description;
  Numbers numbers;
  numbers.add("width_px", from.workspace.width_px).add("height_px", from.workspace.height_px);
  numbers.add("fps", from.fps).add("width_mm", from.workspace.width_mm);
  numbers.add("height_mm", from.workspace.height_mm).add("depth_mm", from.workspace.depth_mm);
  numbers.add("stretch", from.workspace.stretch ? 1.0 : 0.0);
  return numbers.result();
}
/// Returns the numbers of the viewer's time line; none: the stream has no time line.
WEB_EXPORT(timeline) const double* timeline() {
  Numbers numbers;
  if (const auto& from = page().description.timeline) {
    numbers.add("length_s", from->length_s).add("position_s", from->position_s);
    numbers.add("at_ms", toMs(from->at)).add("speed", from->speed);
  }
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
  numbers.add("play_ms", toMs(from.play_time));
  numbers.add("playout_delay_ms", 1e3 * toSeconds(from.playout_delay));
  numbers.add("hip_mm", from.hip_mm).add("contact_mm", from.contact_mm);
  numbers.add("force_N", from.force_N).add("static_force_N", from.static_force_N);
  numbers.add("dynamic_force_N", from.dynamic_force_N).add("penetration_mm", from.penetration_mm);
  numbers.add("contact", from.contact ? 1.0 : 0.0).add("over_object", from.over_object ? 1.0 : 0.0);
  numbers.add("height_at_hip_mm", from.height_at_hip_mm);
  numbers.add("object_present", from.object_present ? 1.0 : 0.0);
  numbers.add("halted", from.halt == Halt::kNone ? 0.0 : 1.0);
  const ReceiverCounts& counts = viewer.counts();
  numbers.add("frames_received", static_cast<double>(counts.received));
  numbers.add("frames_lost", static_cast<double>(counts.lost));
  numbers.add("frames_late", static_cast<double>(counts.late));
  numbers.add("media_now_ms", toMs(viewer.mediaNow(web::toLocal(now_ms))));
  return numbers.result();
}
/// Writes the source of the surface in the last tick.
WEB_EXPORT(lookup) std::size_t lookup() {
  return web::setOutput(kLookupNames[static_cast<std::size_t>(page().viewer->report().lookup)]);
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
/// its rectangle, columns, rows and the step (px); none: it has no relief.
WEB_EXPORT(sampleRelief) const double* sampleRelief(std::size_t index, int most_side) {
  std::vector<float>& heights = page().heights;
  heights.clear();
  Numbers numbers;
  const auto field = page().viewer->reliefs().reliefs[index].lock();
  if (!field || field->empty()) return numbers.result();
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
  numbers.add("u", rect.u).add("v", rect.v).add("width", rect.width).add("height", rect.height);
  numbers.add("columns", columns).add("rows", rows).add("step", step);
  return numbers.result();
}
WEB_EXPORT(heights) const float* heights() { return page().heights.data(); }

}  // namespace hapticast::client
