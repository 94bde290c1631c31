// SPDX-License-Identifier: MIT
// The list of all false streams (false_{messages,slices,datagrams,scenes}.cpp).
#include <iterator>
#include <utility>

#include "tests/scenes/false_streams/false_stream_parts.hpp"

namespace hapticast::testing {

namespace {

template <class... More>
void append(FalseStreams& to, More&&... more) {
  (std::move(more.begin(), more.end(), std::back_inserter(to)), ...);
}

FalseStreams all() {
  FalseStreams all;
  append(all, floats(), structure(), slices(), datagrams(), order(), geometry(), motion(),
         material());
  return all;
}

}  // namespace

const std::vector<FalseStream>& falseStreams() {
  static const FalseStreams kAll = all();
  return kAll;
}

}  // namespace hapticast::testing
