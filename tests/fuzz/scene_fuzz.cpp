// SPDX-License-Identifier: MIT
// parseScene(): any text is read or refused with a JsonError. What is read survives a round
// trip through formatScene().
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/json/json_error.hpp"
#include "server/author/scene_file.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::scene {

HAPTICAST_FUZZ_TARGET("scene") {
  using namespace hapticast::server;
  Scene scene;
  try {
    scene = parseScene({reinterpret_cast<const char*>(data), size});
  } catch (const JsonError& error) {
    if (std::string_view(error.what()).empty()) std::abort();
    return 0;
  }
  if (parseScene(formatScene(scene)) != scene) std::abort();
  return 0;
}

}  // namespace hapticast::fuzz::scene
