// SPDX-License-Identifier: MIT
// Where all pictures of the report are drawn.
#pragma once

#include <filesystem>
#include <string>

namespace hapticast::evaluate {

/// Runs a gnuplot script, which writes NAME.png, in the report's folder; says so where there is
/// none or it fails.
void gnuplot(const std::filesystem::path& out, const std::string& name, const std::string& script);

}  // namespace hapticast::evaluate
