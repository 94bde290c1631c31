/* SPDX-License-Identifier: MIT
 * Stands in for Force Dimension's closed library libdhd: two devices, of which each is a light
 * device in a hand. FAKE_TRACE names the trace file. FAKE_FAULT selects how the library misbehaves;
 * during a touch it does so from the moment the test sets `go`. Axes as documented by the maker: x
 * towards the user, y to the right, z up, in m and N. WITHOUT_OPTIONAL and WITHOUT_POSITION leave
 * functions out. */
#define _GNU_SOURCE
#include <signal.h>
#include <stdio.h>

#include "tests/support/device/light_device.h"

enum { DEVICES = 2, ERROR = -1, TIMEGUARD = 1, SATURATED = 2 };

#ifdef WITHOUT_POSITION
#define dhdGetPosition dhdGetAnotherPosition
#endif
int dhdGetDeviceCount(void);
int dhdOpen(void);
int dhdOpenID(char index);
int dhdClose(char number);
int dhdEnableForce(unsigned char on, char number);
int dhdGetPosition(double* x_m, double* y_m, double* z_m, char number);
int dhdSetForce(double x_N, double y_N, double z_N, char number);
const char* dhdErrorGetLastStr(void);
int dhdGetSerialNumber(unsigned short* serial, char number);
const char* dhdGetSystemName(char number);
unsigned dhdGetButtonMask(char number);

static struct light_device light;
static int is_open[DEVICES], forces_on;
static int errors;
static double last_m[3];

static int fault_is(const char* name) {
  const char* const fault = getenv("FAKE_FAULT");
  return fault != NULL && strcmp(fault, name) == 0;
}

static int has(const char* name) {
  return light.trace != NULL && light.trace->go != 0 && fault_is(name);
}

int dhdGetDeviceCount(void) { return fault_is("none") ? 0 : DEVICES; }

static int open_number(int number) {
  if (fault_is("open_fails") || fault_is("none") || number >= DEVICES) return ERROR;
  if (!begin_light_device(&light, getenv("FAKE_TRACE"))) return ERROR;
  ++light.trace->opened;
  is_open[number] = 1;
  return number;
}

int dhdOpen(void) { return open_number(0); }

int dhdClose(char number) {
  ++light.trace->closed;
  is_open[(int)number] = 0;
  return 0;
}

int dhdEnableForce(unsigned char on, char number) {
  if (fault_is("enable_fails") || !is_open[(int)number]) return ERROR;
  forces_on = on;
  return 0;
}

/* A cable that is loose for a while. */
static int fails(void) { return has("loose") && errors < 300 && ++errors > 0; }

int dhdSetForce(double x_N, double y_N, double z_N, char number) {
  const double force_N[3] = {forces_on ? y_N : 0.0, forces_on ? z_N : 0.0, forces_on ? x_N : 0.0};
  if (!is_open[(int)number] || fails()) return ERROR;
  record_force(&light, force_N);
  if (x_N == 0.0 && y_N == 0.0 && z_N == 0.0) ++light.trace->zeros;
  return has("saturated") ? SATURATED : 0;
}

int dhdGetPosition(double* x_m, double* y_m, double* z_m, char number) {
  if (!is_open[(int)number] || has("position_fails") || fails()) return ERROR;
  if (has("slow")) sleep_ms(5);
  if (has("hang")) hang();
  if (has("segv")) raise(SIGSEGV);
  if (has("timeguard")) return TIMEGUARD;
  move_light_device(&light, now_ns());
  if (!has("frozen")) last_m[0] = 1e-3 * light.position_mm[2];
  last_m[1] = 1e-3 * light.position_mm[0];
  last_m[2] = 1e-3 * light.position_mm[1];
  *x_m = has("nan") ? (double)NAN : last_m[0];
  *y_m = last_m[1];
  *z_m = last_m[2] + (has("jump") && light.trace->exchanges % 2 == 0 ? 0.04 : 0.0);
  return 0;
}

const char* dhdErrorGetLastStr(void) { return "communication \033[31merror"; }

#ifndef WITHOUT_OPTIONAL
int dhdOpenID(char index) { return open_number(index); }

int dhdGetSerialNumber(unsigned short* serial, char number) {
  *serial = (unsigned short)(4711 + number);
  return 0;
}

const char* dhdGetSystemName(char number) { return number == 0 ? "omega.3" : "delta.3"; }

unsigned dhdGetButtonMask(char number) {
  (void)number;
  return has("button") ? 1 : 0;
}
#endif
