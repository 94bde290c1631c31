// SPDX-License-Identifier: MIT
// The topics of hapticast-evaluate. Each measures, fills a Report and writes it. A topic registers
// itself, so a program has the topics whose sources it links.
#pragma once

#include <map>
#include <string>

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// One topic.
struct Topic {
  std::string about;  ///< what it measures, for --help
  void (*evaluate)(const Options& options);
};

/// Returns the topics of this program by name. Thread: one, before and in main().
inline std::map<std::string, Topic>& topics() {
  static std::map<std::string, Topic> registered;
  return registered;
}

/// Adds a topic to topics() before main() begins.
struct RegisteredTopic {
  RegisteredTopic(const char* name, const char* about, void (*evaluate)(const Options&)) {
    topics().emplace(name, Topic{about, evaluate});
  }
};

}  // namespace hapticast::evaluate
