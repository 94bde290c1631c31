// SPDX-License-Identifier: MIT
// Boost.Asio 1.74; only this file includes it. Thread: any.
#pragma once

// Boost 1.74 uses std::exchange without an include of <utility> if coroutines are on (gcc 12).
#include <utility>

#if defined(__clang__)
// Boost 1.74 does not detect co_await of clang with libstdc++ (for clang-tidy and libFuzzer
// builds).
#define BOOST_ASIO_HAS_CO_AWAIT 1
#define BOOST_ASIO_HAS_STD_COROUTINE 1
#endif

#if defined(__SANITIZE_THREAD__)
// ThreadSanitizer does not support std::atomic_thread_fence (an error under gcc's -Werror).
#define BOOST_ASIO_DISABLE_FENCED_BLOCK 1
#endif

#include <boost/asio.hpp>

namespace hapticast {
namespace asio = boost::asio;

/// Returns the IPv4 address in an IPv4-mapped IPv6 address (::ffff:a.b.c.d). Returns other
/// addresses unchanged.
inline asio::ip::address unmapAddress(const asio::ip::address& address) {
  if (!address.is_v6() || !address.to_v6().is_v4_mapped()) return address;
  return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
}
}  // namespace hapticast
