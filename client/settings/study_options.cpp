// SPDX-License-Identifier: MIT
#include "client/settings/study_options.hpp"

#include <string>
#include <utility>

#include "client/study/simulated_observer.hpp"
#include "common/cli/parse.hpp"
#include "common/text.hpp"

namespace hapticast::client {

void addStudyOptions(CLI::App& app, StudySettings& study) {
  app.add_option("--study", study.file,
                 "Run a study with people: the trials in this file (client/study/README.md)")
      ->type_name("FILE.json");
  app.add_option("--subject", study.subject, "The code of the subject: letters and digits, no name")
      ->type_name("CODE");
  app.add_option("--out", study.out, "The folder of the results, a dataset of BIDS 1.9 (Motion)")
      ->type_name("DIR");
  app.add_flag("--resume", study.resume, "Continue the interrupted study of this subject");
  const auto set = [&study](const std::string& text) {
    study.simulate = parseObserver(text);
    if (!study.simulate)
      throw CLI::ValidationError("--simulate",
                                 quote(text) + " is not threshold=T[,slope=S][,lapse=L]");
  };
  app.add_option_function<std::string>(
         "--simulate", set,
         "A simulated observer answers in place of a subject: in a forced choice by a psychometric "
         "function, on a scale at random")
      ->type_name("threshold=T[,slope=S][,lapse=L]");
  const auto set_markers = [&study](const std::string& text) {
    study.markers = parseEndpointOr(text, {"localhost", 0}, "--markers", 1, "HOST:PORT");
  };
  app.add_option_function<std::string>(
         "--markers", set_markers,
         "Send a line as a UDP datagram to this address at each event of the study (for an EEG)")
      ->type_name("HOST:PORT");
}

void requireStudyOptions(const StudySettings& study) {
  const std::pair<const char*, bool> others[] = {{"--subject", !study.subject.empty()},
                                                 {"--out", !study.out.empty()},
                                                 {"--resume", study.resume},
                                                 {"--simulate", study.simulate.has_value()},
                                                 {"--markers", study.markers.has_value()}};
  for (const auto& [flag, is_given] : others)
    if (is_given && study.file.empty()) throw CLI::ValidationError(flag, "needs --study");
  if (study.file.empty()) return;
  if (study.subject.empty()) throw CLI::ValidationError("--study", "needs --subject");
  if (study.out.empty()) throw CLI::ValidationError("--study", "needs --out");
}

}  // namespace hapticast::client
