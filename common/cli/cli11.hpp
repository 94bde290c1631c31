// SPDX-License-Identifier: MIT
// Forward declaration of CLI11's parser, which avoids the 6 CPU seconds of its header (g++ -O2).
// Thread: any.
#pragma once

namespace CLI {  // NOLINT(readability-identifier-naming): the name of CLI11
class App;
}
