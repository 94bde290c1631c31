// SPDX-License-Identifier: MIT
// readJsonScalars(): any text is read or refused; what is read is no larger than what was there.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/source/json_scalars.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto scalars =
      hapticast::server::readJsonScalars({reinterpret_cast<const char*>(data), size});
  if (!scalars) return 0;
  std::size_t values = 0;
  for (const auto& [path, value] : *scalars) {
    if (path.size() > 256) std::abort();
    values += value.size();
  }
  if (values > size) std::abort();
  return 0;
}
