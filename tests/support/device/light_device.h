/* SPDX-License-Identifier: MIT
 * A light device in a hand that presses and lifts. Each command goes into a mapped file that
 * outlives the process, so a test reads the last force after any death. The stand-in driver and the
 * stand-in libraries share it. Include it after _GNU_SOURCE is defined. */
#ifndef HAPTICAST_LIGHT_DEVICE_H
#define HAPTICAST_LIGHT_DEVICE_H

#include <fcntl.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "tests/support/device/standin.h"

struct light_device {
  struct standin_trace* trace;
  double z_mm, speed_mm_s, force_N;
  int64_t last_ns, begin_ns;
};

static inline int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static inline void sleep_ms(long ms) {
  const struct timespec time = {ms / 1000, ms % 1000 * 1000000};
  nanosleep(&time, NULL);
}

/* Maps the trace `file` and lifts the hand. Returns 0 if there is no such file. */
static inline int begin_light_device(struct light_device* device, const char* file) {
  const int descriptor = open(file == NULL ? "" : file, O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return 0;
  device->trace =
      mmap(NULL, sizeof *device->trace, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  close(descriptor);
  device->z_mm = 25.0;
  device->speed_mm_s = device->force_N = 0.0;
  device->begin_ns = device->last_ns = now_ns();
  return device->trace != MAP_FAILED;
}

/* A hand of 0.2 N/mm that wants to be 8 mm below the picture's front, or 20 mm above it. */
static inline void move_light_device(struct light_device* device, int64_t now) {
  const double time_s = 1e-9 * (double)(now - device->begin_ns);
  const double wanted_mm = fmod(time_s, 2.5) < 2.0 ? -8.0 : 20.0;
  double left_s = 1e-9 * (double)(now - device->last_ns);
  device->last_ns = now;
  if (left_s > 0.1) left_s = 0.1;
  for (; left_s > 0.0; left_s -= 1e-4) {
    const double hand_N = 0.2 * (wanted_mm - device->z_mm) - 0.008 * device->speed_mm_s;
    device->speed_mm_s += 1e-4 * 1e3 * (hand_N + device->force_N) / 0.25;
    if (device->speed_mm_s > 150.0) device->speed_mm_s = 150.0;
    if (device->speed_mm_s < -150.0) device->speed_mm_s = -150.0;
    device->z_mm += 1e-4 * device->speed_mm_s;
  }
}

/* The motors receive this command. */
static inline void record_force(struct light_device* device, const double force_N[3]) {
  struct standin_trace* const trace = device->trace;
  struct standin_force* const each = &trace->forces[trace->exchanges % STANDIN_FORCES];
  const double magnitude_N =
      sqrt(force_N[0] * force_N[0] + force_N[1] * force_N[1] + force_N[2] * force_N[2]);
  device->force_N = force_N[2];
  each->at_ns = now_ns();
  memcpy(each->force_N, force_N, sizeof each->force_N);
  trace->force_N = magnitude_N;
  if (magnitude_N > trace->most_N) trace->most_N = magnitude_N;
  if (magnitude_N > 0.0) trace->last_force_ns = each->at_ns;
  ++trace->exchanges;
}

#endif
