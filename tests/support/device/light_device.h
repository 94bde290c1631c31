/* SPDX-License-Identifier: MIT
 * A light device in a hand that presses and lifts, or with a free grip (STANDIN_HAND=free in the
 * environment; the client then checks a device). Each command goes into a mapped file that
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
  double position_mm[3], speed_mm_s[3], force_N[3]; /* x to the right, y up, z to the user */
  int free_grip;
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

/* Does not return any more. */
static inline void hang(void) {
  for (;;) pause();
}

/* Maps the trace `file` and lifts the hand. Returns 0 if there is no such file. */
static inline int begin_light_device(struct light_device* device, const char* file) {
  const int descriptor = open(file == NULL ? "" : file, O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return 0;
  device->trace =
      mmap(NULL, sizeof *device->trace, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  close(descriptor);
  memset(device->speed_mm_s, 0, sizeof device->speed_mm_s);
  memset(device->force_N, 0, sizeof device->force_N);
  device->position_mm[0] = 3.0;
  device->position_mm[1] = 2.0;
  device->position_mm[2] = 25.0;
  device->free_grip = getenv("STANDIN_HAND") != NULL;
  device->begin_ns = device->last_ns = now_ns();
  return device->trace != MAP_FAILED;
}

/* A grip of 45 g with some friction, which nobody holds. */
static inline void step_free_grip(struct light_device* device, double time_s) {
  int i;
  for (i = 0; i < 3; ++i) {
    double* const speed = &device->speed_mm_s[i];
    const double drive_N = device->force_N[i] - 0.0005 * *speed;
    const double friction_mm_s = time_s * 1e3 * 0.03 / 0.045;
    *speed += time_s * 1e3 * drive_N / 0.045;
    *speed = fabs(*speed) < friction_mm_s ? 0.0 : *speed - copysign(friction_mm_s, *speed);
    device->position_mm[i] += time_s * *speed;
  }
}

/* A hand of 0.2 N/mm that wants to be 8 mm below the picture's front, or 20 mm above it. */
static inline void step_held_grip(struct light_device* device, double wanted_mm, double time_s) {
  double* const speed = &device->speed_mm_s[2];
  const double hand_N = 0.2 * (wanted_mm - device->position_mm[2]) - 0.008 * *speed;
  *speed += time_s * 1e3 * (hand_N + device->force_N[2]) / 0.25;
  if (*speed > 150.0) *speed = 150.0;
  if (*speed < -150.0) *speed = -150.0;
  device->position_mm[2] += time_s * *speed;
}

static inline void move_light_device(struct light_device* device, int64_t now) {
  const double time_s = 1e-9 * (double)(now - device->begin_ns);
  const double wanted_mm = fmod(time_s, 2.5) < 2.0 ? -8.0 : 20.0;
  double left_s = 1e-9 * (double)(now - device->last_ns);
  device->last_ns = now;
  if (left_s > 0.1) left_s = 0.1;
  for (; left_s > 0.0; left_s -= 1e-4) {
    if (device->free_grip)
      step_free_grip(device, left_s < 1e-4 ? left_s : 1e-4);
    else
      step_held_grip(device, wanted_mm, 1e-4);
  }
}

/* The motors receive this command. */
static inline void record_force(struct light_device* device, const double force_N[3]) {
  struct standin_trace* const trace = device->trace;
  struct standin_force* const each = &trace->forces[trace->exchanges % STANDIN_FORCES];
  const double magnitude_N =
      sqrt(force_N[0] * force_N[0] + force_N[1] * force_N[1] + force_N[2] * force_N[2]);
  memcpy(device->force_N, force_N, sizeof device->force_N);
  each->at_ns = now_ns();
  memcpy(each->force_N, force_N, sizeof each->force_N);
  trace->force_N = magnitude_N;
  if (magnitude_N > trace->most_N) trace->most_N = magnitude_N;
  if (magnitude_N > 0.0) trace->last_force_ns = each->at_ns;
  ++trace->exchanges;
}

#endif
