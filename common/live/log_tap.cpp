// SPDX-License-Identifier: MIT
#include "common/live/log_tap.hpp"

#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/dist_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <utility>

namespace hapticast {

namespace {

/// Sink of a LogTap. The list of sinks calls it with one line at a time.
class TapSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit TapSink(LogTap::OnLine on_line) : on_line_(std::move(on_line)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& line) override {
    on_line_(line.level, {line.payload.data(), line.payload.size()});
  }
  void flush_() override {}

  LogTap::OnLine on_line_;
};

/// Returns the list of sinks that startLog() has made; null: there is none.
std::shared_ptr<spdlog::sinks::dist_sink_mt> findSinks() {
  const auto& sinks = spdlog::default_logger()->sinks();
  return sinks.empty() ? nullptr
                       : std::dynamic_pointer_cast<spdlog::sinks::dist_sink_mt>(sinks.front());
}

}  // namespace

LogTap::LogTap(OnLine on_line) : sink_(std::make_shared<TapSink>(std::move(on_line))) {
  if (const auto sinks = findSinks()) sinks->add_sink(sink_);
}

LogTap::~LogTap() {
  if (const auto sinks = findSinks()) sinks->remove_sink(sink_);
}

}  // namespace hapticast
