/* SPDX-License-Identifier: MIT
 * Stands in for OpenHaptics' closed library libHD: a light device in a hand, and a thread that calls
 * back a thousand times a second. FAKE_TRACE names the trace file. FAKE_FAULT selects how the library
 * misbehaves; during a touch it does so from the moment the test sets `go`. The device `Left` has
 * another serial number than the default one. WITHOUT_FORCE leaves a function out. */
#define _GNU_SOURCE
#include <pthread.h>
#include <signal.h>
#include <stdio.h>

#include "tests/support/device/light_device.h"

enum { HANDLE = 7 };
enum { INVALID_VALUE = 0x101, WARM_MOTORS = 0x200, EXCEEDED_FORCE = 0x201, FAULT = 0x300,
       COMMUNICATION = 0x302, BUTTONS = 0x2000, POSITION = 0x2050, SERIAL_NUMBER = 0x2504,
       CALIBRATION_STYLE = 0x2555, FORCE = 0x2700, FORCE_OUTPUT = 0x4000, CALIBRATED = 0x5000,
       NEEDS_UPDATE = 0x5001, NEEDS_HAND = 0x5002, INKWELL = 4 };

typedef struct {
  unsigned code;
  int internal_code;
  unsigned device;
} fake_error;

unsigned hdInitDevice(const char* name);
void hdDisableDevice(unsigned device);
void hdMakeCurrentDevice(unsigned device);
void hdBeginFrame(unsigned device);
void hdEndFrame(unsigned device);
void hdEnable(unsigned capability);
void hdDisable(unsigned capability);
fake_error hdGetError(void);
const char* hdGetErrorString(unsigned code);
void hdGetDoublev(unsigned value, double* to);
void hdGetIntegerv(unsigned value, int* to);
const char* hdGetString(unsigned value);
#ifdef WITHOUT_FORCE
#define hdSetDoublev hdSetAnotherDoublev
#endif
void hdSetDoublev(unsigned value, const double* from);
unsigned hdCheckCalibration(void);
void hdUpdateCalibration(unsigned style);
unsigned long hdScheduleAsynchronous(unsigned (*callback)(void*), void* data,
                                     unsigned short priority);
void hdUnschedule(unsigned long callback);
void hdStartScheduler(void);
void hdStopScheduler(void);

static struct light_device light;
static const char* serial = "D1";
static unsigned (*scheduled)(void*);
static void* scheduled_data;
static pthread_t thread;
static volatile int runs, output_on, updated, in_frame;
static unsigned error_code;
static double wanted_N[3];
static double frozen_mm;

static int fault_is(const char* name) {
  const char* const fault = getenv("FAKE_FAULT");
  return fault != NULL && strcmp(fault, name) == 0;
}

static int has(const char* name) {
  return light.trace != NULL && light.trace->go != 0 && fault_is(name);
}

static void record_zero(void) {
  const double none_N[3] = {0.0, 0.0, 0.0};
  record_force(&light, none_N);
  ++light.trace->zeros;
}

unsigned hdInitDevice(const char* name) {
  error_code = fault_is("open_fails") ? COMMUNICATION : 0;
  if (error_code != 0 || !begin_light_device(&light, getenv("FAKE_TRACE"))) return 0xFFFFFFFF;
  if (name != NULL && strcmp(name, "Left") == 0) serial = "D2";
  ++light.trace->opened;
  return HANDLE;
}

void hdDisableDevice(unsigned device) {
  record_zero();
  light.trace->closed += device == HANDLE;
}

void hdMakeCurrentDevice(unsigned device) {
  if (device != HANDLE) error_code = INVALID_VALUE;
}

void hdEnable(unsigned capability) { output_on = output_on || capability == FORCE_OUTPUT; }

void hdDisable(unsigned capability) {
  if (capability != FORCE_OUTPUT) return;
  output_on = 0;
  record_zero();
}

void hdBeginFrame(unsigned device) {
  if (has("slow")) sleep_ms(5);
  if (has("hang")) hang();
  if (has("segv") && light.trace->opened == 1) raise(SIGSEGV);
  move_light_device(&light, now_ns());
  if (!has("frozen")) frozen_mm = light.position_mm[2];
  in_frame = device == HANDLE;
}

void hdEndFrame(unsigned device) {
  const double none_N[3] = {0.0, 0.0, 0.0};
  in_frame = in_frame && device != HANDLE;
  record_force(&light, output_on ? wanted_N : none_N);
  if (has("comm_error")) error_code = COMMUNICATION;
  if (has("fault")) error_code = FAULT;
  if (has("loose") && light.trace->exchanges % 1024 < 512) error_code = COMMUNICATION;
  if (has("warm")) error_code = WARM_MOTORS;
  if (has("limited")) error_code = EXCEEDED_FORCE;
}

fake_error hdGetError(void) {
  const fake_error error = {error_code, 0, HANDLE};
  error_code = 0;
  return error;
}

const char* hdGetErrorString(unsigned code) {
  return code == COMMUNICATION ? "communication \033[31merror" : "some error";
}

void hdGetDoublev(unsigned value, double* to) {
  if (value != POSITION || !in_frame) {
    error_code = INVALID_VALUE;
    return;
  }
  to[0] = light.position_mm[0] + (has("jump") && light.trace->exchanges % 2 == 0 ? 40.0 : 0.0);
  to[1] = has("nan") ? (double)NAN : light.position_mm[1];
  to[2] = frozen_mm;
}

void hdGetIntegerv(unsigned value, int* to) {
  *to = value == CALIBRATION_STYLE ? INKWELL : 0;
  if (value != CALIBRATION_STYLE && value != BUTTONS) error_code = INVALID_VALUE;
}

const char* hdGetString(unsigned value) { return value == SERIAL_NUMBER ? serial : NULL; }

/* Only within a frame a force reaches the motors. */
void hdSetDoublev(unsigned value, const double* from) {
  if (value != FORCE || !in_frame) error_code = INVALID_VALUE;
  if (value == FORCE && in_frame) memcpy(wanted_N, from, sizeof wanted_N);
}

unsigned hdCheckCalibration(void) {
  const int hand_late = now_ns() - light.begin_ns < 1500000000;
  if (fault_is("inkwell") && hand_late) return NEEDS_HAND;
  return fault_is("inkwell") && !updated ? NEEDS_UPDATE : CALIBRATED;
}

void hdUpdateCalibration(unsigned style) { updated = style == INKWELL; }

unsigned long hdScheduleAsynchronous(unsigned (*callback)(void*), void* data,
                                     unsigned short priority) {
  (void)priority;
  scheduled = callback;
  scheduled_data = data;
  return 1;
}

void hdUnschedule(unsigned long callback) {
  if (callback == 1) scheduled = NULL;
}

static void* run(void* unused) {
  struct timespec next;
  clock_gettime(CLOCK_MONOTONIC, &next);
  while (runs && scheduled != NULL && scheduled(scheduled_data) == 1) {
    next.tv_nsec += 1000000;
    if (next.tv_nsec >= 1000000000) next.tv_nsec -= 1000000000, ++next.tv_sec;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
  }
  return unused;
}

void hdStartScheduler(void) {
  runs = 1;
  if (!fault_is("no_callback")) pthread_create(&thread, NULL, run, NULL);
}

void hdStopScheduler(void) {
  runs = 0;
  if (!fault_is("no_callback")) pthread_join(thread, NULL);
  record_zero();
}
