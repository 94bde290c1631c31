/* SPDX-License-Identifier: MIT
 * A driver for tests, in C99 and with the header alone: a light device in a hand that presses and
 * lifts again and again. Each command goes into a mapped file that outlives the process, so a test
 * reads the last force after any death. --device-option fault=NAME selects how the driver
 * misbehaves, from the moment the test sets `go` in the file. */
#define _GNU_SOURCE
#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "client/device/hapticast_device.h"
#include "tests/support/device/light_device.h"

struct hapticast_device {
  struct light_device light;
  char fault[32];
  const hapticast_host* host;
  hapticast_state state;
};

static int has(const hapticast_device* device, const char* fault) {
  return device->light.trace->go != 0 && strcmp(device->fault, fault) == 0;
}

static const char* option(const hapticast_host* host, const char* key) {
  const char* const value = host->option(host->self, key);
  return value == NULL ? "" : value;
}

static int list(const hapticast_host* host, void (*found)(void*, const char*, const char*),
                void* to, char why[256]) {
  const char* const fault = option(host, "fault");
  int count = strcmp(fault, "crowd") == 0 ? 10000 : 1;
  if (strcmp(fault, "list_hangs") == 0) hang();
  if (strcmp(fault, "list_fails") == 0) {
    snprintf(why, 256, "the bus \033[31mis\007 off");
    return HAPTICAST_LOST;
  }
  while (count-- > 0) found(to, "S1", strcmp(fault, "busy") == 0 ? "it is busy" : NULL);
  return HAPTICAST_OK;
}

static hapticast_device* open_device(const hapticast_host* host, const char* id,
                                     hapticast_profile* profile, char why[256]) {
  hapticast_device* const device = calloc(1, sizeof *device);
  (void)id;
  device->host = host;
  snprintf(device->fault, sizeof device->fault, "%s", option(host, "fault"));
  if (!begin_light_device(&device->light, option(host, "trace")) ||
      strcmp(device->fault, "open_fails") == 0) {
    snprintf(why, 256, "it is switched off: switch it on");
    free(device);
    return NULL;
  }
  if (strcmp(device->fault, "open_hangs") == 0) hang();
  ++device->light.trace->opened;
  host->log(host->self, "standin: \033[31mopened\007");
  profile->delay_ticks = 1;
  profile->mass_kg = 0.045;
  profile->peak_N = strcmp(device->fault, "absurd_profile") == 0 ? (double)INFINITY : 8.0;
  profile->continuous_N = 0.88;
  profile->count_mm = 0.055;
  profile->workspace_mm[0] = 160.0;
  profile->workspace_mm[1] = 120.0;
  profile->workspace_mm[2] = 70.0;
  strcpy(profile->serial, "S1");
  return device;
}

static int wait(hapticast_device* device, int64_t until) {
  const struct timespec time = {(time_t)(until / 1000000000), (long)(until % 1000000000)};
  if (has(device, "wait_hangs")) hang();
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, NULL);
  return HAPTICAST_OK;
}

static void misbehave(hapticast_device* device, int64_t now) {
  hapticast_state* const state = &device->state;
  int i;
  if (has(device, "nan")) state->position_mm[1] = (double)NAN;
  if (has(device, "jump")) state->position_mm[0] += device->light.trace->exchanges % 2 == 0 ? 40.0 : 0.0;
  if (has(device, "back")) state->taken_ns = now - 15000000 - (int64_t)device->light.trace->exchanges;
  if (strcmp(device->fault, "old") == 0) state->taken_ns = now - 2600000;
  if (strcmp(device->fault, "gaps") == 0 && device->light.trace->exchanges % 4 < 2) {
    state->status = HAPTICAST_NO_DATA;
    state->taken_ns = 0;
  }
  if (has(device, "future")) state->taken_ns = now + 1000000000;
  if (has(device, "status")) state->status = 77;
  if (has(device, "silent")) state->status = HAPTICAST_NO_DATA;
  if (has(device, "lost")) state->status = HAPTICAST_LOST;
  if (has(device, "chatter")) device->host->log(device->host->self, "standin: chatter");
  if (has(device, "slow")) sleep_ms(5);
  if (has(device, "exchange_hangs")) hang();
  if (has(device, "segv")) raise(SIGSEGV);
  if (has(device, "abort")) abort();
  if (has(device, "exit")) exit(0);
  if (has(device, "descriptors"))
    for (i = 3; i < 64; ++i) close(i);
  if (has(device, "rounding")) fesetround(FE_UPWARD);
}

static int exchange(hapticast_device* device, const double force_N[3], hapticast_state* state) {
  const int64_t now = now_ns();
  const double sign = strcmp(device->fault, "turned") == 0 ? -1.0 : 1.0;
  const double motors_N[3] = {force_N[0], sign * force_N[1], force_N[2]};
  const uint32_t size = state->size < sizeof *state ? state->size : (uint32_t)sizeof *state;
  move_light_device(&device->light, now);
  record_force(&device->light, motors_N);
  if (!has(device, "frozen"))
    memcpy(device->state.position_mm, device->light.position_mm, sizeof device->state.position_mm);
  device->state.status = HAPTICAST_OK;
  device->state.taken_ns = now;
  device->state.replies += 1;
  misbehave(device, now);
  device->state.size = size;
  memcpy(state, &device->state, size);
  return HAPTICAST_OK;
}

static int zero(hapticast_device* device) {
  const double none[3] = {0.0, 0.0, 0.0};
  ++device->light.trace->zeros;
  if (strcmp(device->fault, "zero_fails") == 0) return 1;
  record_force(&device->light, none);
  return 0;
}

static void close_device(hapticast_device* device) {
  (void)zero(device);
  ++device->light.trace->closed;
  munmap(device->light.trace, sizeof *device->light.trace);
  free(device);
}

static void warn(hapticast_device* device, int on) { device->light.trace->sign = on != 0; }

const hapticast_driver* hapticast_device_v1(void) {
  static hapticast_driver driver = {sizeof driver, HAPTICAST_DEVICE_ABI, "standin",
                                    "a light device in a hand", "MIT", 0, 0, list, open_device,
                                    wait, exchange, zero, close_device, warn};
  /* A driver of another version. The environment reaches it before any option does. */
  const char* const shape = getenv("STANDIN_SHAPE");
  if (shape != NULL && strcmp(shape, "size") == 0) driver.size = 16;
  if (shape != NULL && strcmp(shape, "no_sign") == 0)
    driver.size = (uint32_t)offsetof(hapticast_driver, warn);
  if (shape != NULL && strcmp(shape, "abi") == 0) driver.abi = 7;
  if (shape != NULL && strcmp(shape, "null") == 0) driver.exchange = NULL;
  if (shape != NULL && strcmp(shape, "name") == 0) driver.name = "other";
  if (shape != NULL && strcmp(shape, "none") == 0) return NULL;
  return &driver;
}
