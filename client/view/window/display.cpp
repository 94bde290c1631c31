// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/display.hpp"

#include <SDL_syswm.h>

#include <atomic>

namespace hapticast::client {

namespace {

// Global, because Xlib's handlers have no user data.
std::atomic<bool> lost{false};
std::atomic<unsigned long> watched{0};

#ifdef SDL_VIDEO_DRIVER_X11
/// Handler for failed requests. All errors are harmless, except drawing into a removed window.
int onError(Display* /*display*/, XErrorEvent* error) {
  const bool ours = error->resourceid == watched.load();
  if (ours && (error->error_code == BadWindow || error->error_code == BadDrawable)) lost = true;
  return 0;
}

/// Handler for a broken connection. Xlib's own handler would print a line.
int onBrokenConnection(Display* /*display*/) {
  lost = true;
  return 0;
}

/// Replaces the end of the process: Xlib returns instead, and so does every later call.
void onExit(Display* /*display*/, void* /*nothing*/) { lost = true; }
#endif

}  // namespace

void surviveDisplay(SDL_Window& window) {
  lost = false;
#ifdef SDL_VIDEO_DRIVER_X11
  SDL_SysWMinfo info;
  SDL_VERSION(&info.version);
  if (SDL_GetWindowWMInfo(&window, &info) != SDL_TRUE || info.subsystem != SDL_SYSWM_X11) return;
  watched = info.info.x11.window;
  SDL_EventState(SDL_SYSWMEVENT, SDL_ENABLE);
  XSetErrorHandler(onError);
  XSetIOErrorHandler(onBrokenConnection);
  XSetIOErrorExitHandler(info.info.x11.display, onExit, nullptr);
#else
  (void)window;
#endif
}

void handleDisplayEvents(const SDL_Event& event) {
#ifdef SDL_VIDEO_DRIVER_X11
  if (event.type != SDL_SYSWMEVENT || event.syswm.msg->subsystem != SDL_SYSWM_X11) return;
  const XEvent& news = event.syswm.msg->msg.x11.event;
  if (news.type == DestroyNotify && news.xdestroywindow.window == watched.load()) lost = true;
#else
  (void)event;
#endif
}

bool displayIsLost() { return lost; }

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
