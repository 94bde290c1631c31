// SPDX-License-Identifier: MIT
// The one door to Boost.Asio 1.74.
#pragma once

// Boost 1.74 uses std::exchange without including <utility> when coroutines are on (gcc 12).
#include <utility>

#if defined(__clang__)
// Boost 1.74 does not detect co_await of clang with libstdc++ (needed for clang-tidy and libFuzzer
// builds).
#define BOOST_ASIO_HAS_CO_AWAIT 1
#define BOOST_ASIO_HAS_STD_COROUTINE 1
#endif

#if defined(__SANITIZE_THREAD__)
// ThreadSanitizer does not know std::atomic_thread_fence (gcc refuses it under -Werror).
#define BOOST_ASIO_DISABLE_FENCED_BLOCK 1
#endif

#include <boost/asio.hpp>

namespace hapticast {
namespace asio = boost::asio;
}
