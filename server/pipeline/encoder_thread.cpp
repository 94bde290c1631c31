// SPDX-License-Identifier: MIT
#include "server/pipeline/encoder_thread.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/vision/describe.hpp"

namespace hapticast::server {

namespace {
constexpr int kJpegQuality = 80;      // chosen: a 640 x 480 picture is some 30 KB
constexpr std::size_t kMostJobs = 2;  // bounds the latency: with more jobs vision waits
}  // namespace

EncoderThread::EncoderThread(std::vector<StreamSink*> sinks, FrameSigner* signer,
                             SliceSettings slices, const Clock* clock)
    : sinks_(std::move(sinks)), signer_(signer), clock_(clock), slices_(slices), thread_([this] {
        run();
      }) {}

EncoderThread::~EncoderThread() { stop(); }

void EncoderThread::push(StreamDescription description, VisionResult result) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.size() < kMostJobs || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  jobs_.push_back({std::move(description), std::move(result)});
  changed_.notify_all();
}

void EncoderThread::setSlices(const SliceSettings& slices) {
  const std::lock_guard lock(mutex_);
  slices_ = slices;
}

void EncoderThread::finish() {
  stop();
  if (failure_) std::rethrow_exception(failure_);
}

ReliefBytes EncoderThread::reliefBytes() const {
  const std::lock_guard lock(mutex_);
  return relief_bytes_;
}

EncoderTimes EncoderThread::times() const {
  const std::lock_guard lock(mutex_);
  return times_;
}

void EncoderThread::stop() noexcept {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void EncoderThread::run() {
  while (true) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !jobs_.empty() || ended_; });
    if (jobs_.empty()) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    const SliceSettings slices = slices_;
    changed_.notify_all();
    lock.unlock();
    try {
      encode(std::move(job), slices);
    } catch (...) {
      lock.lock();
      failure_ = std::current_exception();
      changed_.notify_all();
      return;
    }
  }
}

void EncoderThread::encode(Job job, const SliceSettings& slices) {
  if (described_ != job.description) {
    described_ = std::move(job.description);
    for (StreamSink* sink : sinks_) sink->describe(*described_);
  }
  if (signer_ != nullptr) rotateKey(*signer_, sinks_);
  const LocalTime begin = now();
  const EncodedFrame frame =
      encoder_.encode(job.result.frame, slices, signer_, areDatagramsWanted(sinks_));
  {
    const std::lock_guard lock(mutex_);
    relief_bytes_ = encoder_.reliefBytes();
    if (clock_ != nullptr) times_.encode.add(now() - begin);
  }
  for (StreamSink* sink : sinks_) sink->publish(frame);
  if (isVideoWanted(sinks_)) encodeVideoOf(job);
}

void EncoderThread::encodeVideoOf(const Job& job) {
  const LocalTime begin = now();
  const HapticFrame& frame = job.result.frame;
  const EncodedVideo video = encodeVideo(
      {frame.epoch, frame.id, frame.media_time, encodePicture(job.result.color, kJpegQuality)});
  if (clock_ != nullptr) {
    const std::lock_guard lock(mutex_);
    times_.picture.add(now() - begin);
  }
  for (StreamSink* sink : sinks_) sink->publish(video);
}

double computeHeightError_mm(const VisionSettings& vision) {
  // Chosen: larger steps between slices are perceptible as edges.
  constexpr double kMost_mm = 0.25;
  const double usual_N = kUsualStiffness_N_mm * kDefaultHeightError_mm;
  const double share = vision.plan.error_budget_N / PlanSettings{}.error_budget_N;
  return std::min(share * usual_N / vision.stiffness_N_mm(), kMost_mm);
}

}  // namespace hapticast::server
