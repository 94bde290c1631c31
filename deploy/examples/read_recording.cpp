// SPDX-License-Identifier: MIT
// Prints what a recording has: the objects of each frame, and the force of a client's run.
// Usage: read_recording FILE.mcap [SECONDS FROM THE BEGIN]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "hapticast/recording.hpp"

namespace {

void printContent(const hapticast::Recording& recording) {
  const hapticast::RecordingCounts counts = recording.count();
  std::printf("%s: %.1f s, %lu frames, %lu pictures, %lu ticks%s%s\n",
              recording.kind() == hapticast::Recording::Kind::kClient ? "client" : "server",
              1e-9 * static_cast<double>(recording.end_ns() - recording.start_ns()),
              static_cast<unsigned long>(counts.frames),
              static_cast<unsigned long>(counts.pictures), static_cast<unsigned long>(counts.ticks),
              counts.problem.empty() ? "" : "; it ", counts.problem.c_str());
}

void read(const char* file, double from_s) {
  hapticast::Recording recording(file);
  printContent(recording);
  recording.seek(recording.start_ns() + std::llround(1e9 * from_s));
  while (const auto frame = recording.nextFrame())
    for (const hapticast::Object& object : frame->objects)
      std::printf("%.3f s: object %u at z %.1f mm\n", frame->time_s, object.id,
                  object.position_mm.z());
  double most_N = 0.0;
  while (const auto tick = recording.nextTick()) most_N = std::fmax(most_N, tick->force_N.norm());
  std::printf("largest force: %.2f N\n", most_N);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: read_recording FILE.mcap [SECONDS]\n");
    return 2;
  }
  read(argv[1], argc > 2 ? std::atof(argv[2]) : 0.0);
} catch (const std::exception& error) {
  std::fprintf(stderr, "read_recording: %s\n", error.what());
  return 1;
}
