// SPDX-License-Identifier: MIT
// Files of the page for browsers (client/web/page). The build compresses them and compiles them
// into the program, so a server needs no folder of files. Thread: any.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace hapticast::server {

/// One file of the page.
struct PageFile {
  std::string_view name;  ///< without folders, such as index.html
  std::string_view content_type;
  std::span<const std::uint8_t> gzipped;  ///< content in the format gzip (RFC 1952)
  std::string_view etag;                  ///< in quotes; it differs if the content differs
};

/// Returns all files of the page. Without the packages for its core, core.wasm is missing.
[[nodiscard]] std::span<const PageFile> listPageFiles();
/// Returns the one of `files` for the path of a request: / is index.html, /NAME the file with that
/// name. Returns null if there is none. Paths have no folders.
[[nodiscard]] const PageFile* findPageFile(std::string_view path,
                                           std::span<const PageFile> files = listPageFiles());
/// Returns whether `files` have what the page needs: index.html and core.wasm.
[[nodiscard]] bool isPageComplete(std::span<const PageFile> files = listPageFiles());
/// Returns the content of `file` without compression.
[[nodiscard]] std::vector<std::uint8_t> inflate(const PageFile& file);

}  // namespace hapticast::server
