// SPDX-License-Identifier: MIT
// Recordings: the bytes are a file in the format MCAP.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/recording/mcap_reader.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::mcap {

HAPTICAST_FUZZ_TARGET("mcap") {
  const int file = ::memfd_create("mcap", MFD_CLOEXEC);
  if (file < 0 || ::write(file, data, size) != static_cast<::ssize_t>(size)) std::abort();
  auto opened = hapticast::McapReader::open("/proc/self/fd/" + std::to_string(file));
  if (opened.ok()) {
    hapticast::McapReader reader = std::move(opened).value();
    if (reader.channels().empty() && reader.next()) std::abort();
    while (reader.next()) {
    }
    reader.seek(reader.end_ns() / 2);
    while (const auto message = reader.next())
      if (!reader.channels().contains(message->channel)) std::abort();
  }
  ::close(file);
  return 0;
}

}  // namespace hapticast::fuzz::mcap
