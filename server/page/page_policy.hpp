// SPDX-License-Identifier: MIT
// The Content-Security-Policy of the page: no content of another host, no code in the page itself.
// Nothing that is injected would run. Thread: any.
#pragma once

namespace hapticast::server {

/// The directives that a page may also state itself; the server adds frame-ancestors.
inline constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; "
    "connect-src 'self'; img-src 'self' blob:; style-src 'self'; base-uri 'none'; "
    "form-action 'none'";

}  // namespace hapticast::server
