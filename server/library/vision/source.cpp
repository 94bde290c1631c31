// SPDX-License-Identifier: MIT
#include <algorithm>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>

#include "server/library/member_names.hpp"
#include "server/library/vision/images.hpp"
#include "server/library/vision/source_impl.hpp"

namespace hapticast {

namespace {

/// Calls `work`. Throws the errors of the server and of OpenCV as std::runtime_error of one line.
template <class Work>
auto translateErrors(Work work) {
  try {
    return work();
  } catch (const server::SourceError& error) {
    throw std::runtime_error(nameMembers(error.what()));
  } catch (const cv::Exception& error) {
    throw std::runtime_error("OpenCV: " + error.err);
  }
}

}  // namespace

Source::Impl::Impl(const std::string& spec, double fps)
    : source_(server::openSource(spec, fps)), info_(exportSourceInfo(source_->info())) {}

std::optional<Images> Source::Impl::read() {
  auto frame = source_->read();
  // A live source waits 50 ms inside read(), then it has no frame.
  while (!frame && info_.live) frame = source_->read();
  if (!frame) return std::nullopt;
  has_begun_ = true;
  return exportImages(*frame, findTime_s(*frame));
}

double Source::Impl::findTime_s(const server::RgbdFrame& frame) {
  if (!info_.live) return last_s_ = begin_s_ + frame.clip_time_s;
  // Ages are measured before now(), so two frames could change their order.
  last_captured_ = std::max(clock_.now() - frame.age, last_captured_ + kTickPeriod);
  return toSeconds(Duration(last_captured_ - opened_));
}

void Source::Impl::rewind() {
  source_->rewind();
  if (std::exchange(has_begun_, false)) begin_s_ = last_s_ + 1.0 / info_.fps;
}

Source::Source(const std::string& spec, double fps)
    : impl_(translateErrors([&] { return std::make_unique<Impl>(spec, fps); })) {}

Source::~Source() = default;
Source::Source(Source&& from) noexcept = default;
Source& Source::operator=(Source&& from) noexcept = default;

const SourceInfo& Source::info() const { return impl_->info(); }

std::optional<Images> Source::read() {
  return translateErrors([this] { return impl_->read(); });
}

void Source::rewind() {
  translateErrors([this] { impl_->rewind(); });
}

}  // namespace hapticast
