// SPDX-License-Identifier: MIT
// Forward declaration of CLI11's parser. It replaces the header of CLI11 where possible, because
// that header needs 6 s of compilation (g++ -O2).
// Thread: any.
#pragma once

namespace CLI {  // NOLINT(readability-identifier-naming): the name of CLI11
class App;
}
