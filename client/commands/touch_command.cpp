// SPDX-License-Identifier: MIT
#include "client/commands/touch_command.hpp"

#include <spdlog/spdlog.h>

#include <cstdio>
#include <utility>

#include "client/desk/desk.hpp"
#include "client/desk/session.hpp"
#include "common/cli/run_program.hpp"

namespace hapticast::client {

namespace {

/// Runs the event loop. Returns whether --seconds ended it.
bool runEvents(const Settings& settings, Desk& desk, Session& session) {
  LocalTime begin = desk.clock().now();  // of --seconds
  bool any_frame = false;
  while (!desk.ended()) {
    const ConnectionStats& stats = session.stats();
    desk.turn(stats);
    session.setInContact(desk.lastReport().contact);
    if (const auto control = desk.ui().takeControl()) session.control(*control);
    const LocalTime now = desk.clock().now();
    // The time does not run during the scan of a clip, and begins again with the first frame.
    const bool first = !any_frame && desk.lastReport().lookup != Lookup::kEmpty;
    if (first || (!any_frame && stats.isScanning())) begin = now;
    any_frame = any_frame || first;
    if (const auto text = session.listServers(now)) spdlog::warn("{}", *text);
    if (settings.seconds > 0.0 && now - begin >= fromSeconds(settings.seconds)) return true;
  }
  return false;
}

/// Returns whether the run succeeded.
bool touch(const Settings& settings, Desk& desk, Session& session) {
  if (!desk.checkDevice()) return true;
  spdlog::info("connecting to {} with a {}. Ctrl-C ends the client.", session.serverName(),
               desk.local().device->description());
  if (settings.forces != Forces::kBoth)
    spdlog::info("the client renders only the {} force (--forces)",
                 settings.forces == Forces::kStatic ? "static" : "dynamic");
  desk.startLoop();
  session.connect();
  bool is_time_over = false;
  bool ok = succeed([&] { is_time_over = runEvents(settings, desk, session); });
  (void)desk.stopLoop();  // first: the force comes down while the stream goes on
  session.stop();
  ok = ok && !session.failed();
  if (const auto reason = session.neverConnected(); ok && is_time_over && reason) {
    spdlog::error("no server answered at {} within {:g} s ({})", session.serverName(),
                  settings.seconds, *reason);
    ok = false;
  }
  RunResult run;
  session.addTo(run);
  ok = desk.finish(run) && ok;
  if (!settings.quiet && ok) std::fputs(toText(run).c_str(), stdout);
  return ok;
}

}  // namespace

int runTouch(const Settings& settings, const Clock& clock, Views views) {
  Desk desk(settings, clock, std::move(views));
  desk.openRecorder(settings.outputs);
  Session session(settings, desk);
  bool ok = false;
  return succeed([&] { ok = touch(settings, desk, session); }) && ok ? kDone : kFailed;
}

}  // namespace hapticast::client
