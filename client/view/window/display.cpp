// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/display.hpp"

#include <SDL_syswm.h>

#include <atomic>

namespace hapticast::client {

namespace {

// Xlib hands its handlers nothing of ours.
std::atomic<bool> lost{false};
std::atomic<unsigned long> watched{0};

#ifdef SDL_VIDEO_DRIVER_X11
/// Of requests: all errors but one are harmless, drawing into a window that is no more is not.
int onError(Display* /*display*/, XErrorEvent* error) {
  const bool ours = error->resourceid == watched.load();
  if (ours && (error->error_code == BadWindow || error->error_code == BadDrawable)) lost = true;
  return 0;
}

/// Of the connection. Xlib's own would say so in a line that is not ours.
int onBrokenConnection(Display* /*display*/) {
  lost = true;
  return 0;
}

/// Where Xlib would end the process: it returns instead, and so does every further call.
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
