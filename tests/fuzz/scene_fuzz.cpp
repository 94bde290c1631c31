// SPDX-License-Identifier: MIT
// parseScene(): any text is read or refused with a SceneFileError. What is read survives a round
// trip through formatScene().
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/author/scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hapticast::server;
  Scene scene;
  try {
    scene = parseScene({reinterpret_cast<const char*>(data), size});
  } catch (const SceneFileError& error) {
    if (std::string_view(error.what()).empty()) std::abort();
    return 0;
  }
  if (parseScene(formatScene(scene)) != scene) std::abort();
  return 0;
}
