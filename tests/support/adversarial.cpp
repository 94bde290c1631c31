// SPDX-License-Identifier: MIT
// All the lies (lies_messages.cpp, lies_slices.cpp, lies_datagrams.cpp, lies_scene.cpp).
#include <iterator>
#include <utility>

#include "tests/support/adversarial_parts.hpp"

namespace hapticast::testing {

namespace {

template <class... More>
void append(Lies& to, More&&... more) {
  (std::move(more.begin(), more.end(), std::back_inserter(to)), ...);
}

Lies all() {
  Lies all;
  append(all, floats(), structure(), slices(), datagrams(), order(), geometry(), motion(),
         material());
  return all;
}

}  // namespace

const std::vector<Lie>& lies() {
  static const Lies kAll = all();
  return kAll;
}

}  // namespace hapticast::testing
