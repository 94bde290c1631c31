// SPDX-License-Identifier: MIT
// The topics of hapticast-evaluate. Each measures, fills a Report and writes it. A topic registers
// itself, so a program has the topics whose sources it links.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// A picture that a topic draws itself, in the folder of the report.
struct Picture {
  std::string file;
  std::string caption;
};

/// One topic.
struct Topic {
  std::string about;   ///< what it measures, for --help; one line
  std::string method;  ///< what is measured against which truth; the paragraph of report.md
  void (*evaluate)(const Options& options) = nullptr;
  std::vector<Picture> pictures = {};  ///< empty: error against run time, TOPIC.png
};

/// Returns the topics of this program by name. Thread: one, before and in main().
inline std::map<std::string, Topic>& topics() {
  static std::map<std::string, Topic> registered;
  return registered;
}

/// Adds a topic to topics() before main() begins.
struct RegisteredTopic {
  RegisteredTopic(const char* name, Topic topic) { topics().emplace(name, std::move(topic)); }
};

}  // namespace hapticast::evaluate
