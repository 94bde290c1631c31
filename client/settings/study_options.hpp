// SPDX-License-Identifier: MIT
// Flags of --study. Thread: main, at start-up.
#pragma once

#include "client/settings/settings.hpp"
#include "common/cli/cli11.hpp"

namespace hapticast::client {

/// Adds --study and the flags that need it. They fill `study`, which must outlive `app`.
void addStudyOptions(CLI::App& app, StudySettings& study);
/// Throws CLI::ValidationError if a flag of `study` lacks another one.
void requireStudyOptions(const StudySettings& study);

}  // namespace hapticast::client
