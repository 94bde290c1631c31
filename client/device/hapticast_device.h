/* SPDX-License-Identifier: MIT
 * Interface of a driver for a haptic device. A driver is a shared library NAME.so that exports the
 * one function hapticast_device_v1(). The program hapticast-device loads the driver in a process of
 * its own. This header is C99 and compiles as C++20. It needs nothing else of hapticast.
 *
 * Units: mm, N, kg, s, and ns of CLOCK_MONOTONIC. Axes: right-handed, x to the right, y up, z
 * towards the user. The origin is the centre of the workspace.
 *
 * Contract
 * - Threads. list(), open() and close() run in the main thread. wait() and exchange() run in one
 *   thread, the loop's. zero() may run in any thread from the return of open() to the begin of
 *   close(), also while another call hangs.
 * - Force. The force of an exchange() acts until the next exchange() or zero(). The driver never
 *   repeats or changes a force by itself. If no exchange() follows for 20 ms, the host calls
 *   zero().
 * - Zero. zero() commands a force of zero to the motors. The device is at zero after open() and
 *   after close().
 * - Time. exchange() does not block. The host counts and reports a call of more than 0.5 ms.
 * - Positions. Before the device is homed, exchange() reports HAPTICAST_NO_DATA. 20 ticks of
 *   HAPTICAST_NO_DATA end the touch. After HAPTICAST_LOST the force waits for the user's consent.
 * - Process. A driver throws no exception, does not call exit(), sets no signal handler, and
 *   changes neither the floating-point mode nor the priority of the calling thread. The process may
 *   not open internet sockets, unless the driver has the flag HAPTICAST_NEEDS_NETWORK.
 * - Versions. Structures grow at their end. `size` is the size that the author of the structure
 *   knows. A reader reads and writes no further.
 *
 * The host checks all values of a driver. It cannot detect a driver that renders another force than
 * the commanded one: `hapticast-client check NAME` tests that with the device.
 */
#ifndef HAPTICAST_DEVICE_H
#define HAPTICAST_DEVICE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAPTICAST_DEVICE_ABI 1U

/* The driver's own data of one opened device. */
typedef struct hapticast_device hapticast_device;

/* Functions of the host. The pointer is valid from the call that receives it until close(). */
typedef struct hapticast_host {
  uint32_t size;
  void* self; /* first argument of the functions */
  /* Shows one line to the user. It does not block. Any thread. */
  void (*log)(void* self, const char* line);
  /* Returns the value of --device-option KEY=VALUE, or NULL if the user did not give it. Call it in
   * list() and open() only. */
  const char* (*option)(void* self, const char* key);
} hapticast_host;

/* Properties of the opened device. The host sets all members to "unknown" before open(). It limits
 * each value, and assumes a careful value for an unknown one. */
typedef struct hapticast_profile {
  uint32_t size;
  int32_t delay_ticks;    /* ms from the reading of a position to the begin of its force; -1:
                             unknown. The host measures it, too, and uses the larger one. */
  double mass_kg;         /* apparent mass at the grip, never overstated; 0: unknown */
  double peak_N;          /* largest force; 0: unknown */
  double continuous_N;    /* force that the motors can exert for ever; 0: unknown */
  double count_mm;        /* smallest measured change of the position; 0: unknown */
  double stiffness_N_mm;  /* stiffness for surfaces without one; 0: unknown */
  double workspace_mm[3]; /* width, height, depth; 0: unknown */
  int32_t enable_button;  /* bit of the dead-man's switch in `buttons`; -1: none */
  int32_t pause_button;   /* bit of the button that pauses play time; -1: none */
  int32_t rearm_button;   /* bit of the button that re-arms the force; -1: none */
  int32_t watchdog_ms;    /* the device itself ends a force after so long without a command; 0:
                             never. Without a watchdog the host limits peak_N to 3.3 N until the
                             user gives a --profile. */
  char serial[64];        /* distinguishes devices of one kind; "": unknown */
} hapticast_profile;

/* Status of a reading, and return value of wait() and exchange(). */
enum {
  HAPTICAST_OK = 0,      /* a new position */
  HAPTICAST_NO_DATA = 1, /* no new position */
  HAPTICAST_LOST = 2     /* the device does not answer */
};

typedef struct hapticast_state {
  uint32_t size;
  int32_t status;
  double position_mm[3];
  uint32_t buttons; /* one bit for each button that is down */
  uint32_t reserved;
  int64_t taken_ns; /* time of the measurement; rises with each new position */
  /* Counters since open(); 0 where the driver has none. */
  uint64_t replies;   /* answers of the device */
  uint64_t misses;    /* ticks without an answer */
  uint64_t damaged;   /* answers that could not be used */
  uint64_t saturated; /* ticks in which the motors could not make the commanded force */
} hapticast_state;

/* Flags of a driver. */
enum { HAPTICAST_NEEDS_NETWORK = 1 /* the device is reached through internet sockets */ };

typedef struct hapticast_driver {
  uint32_t size;       /* sizeof(hapticast_driver) */
  uint32_t abi;        /* HAPTICAST_DEVICE_ABI */
  const char* name;    /* name for --device, the file name without .so: [a-z0-9_]{1,32} */
  const char* about;   /* one line for `list --devices` */
  const char* licence; /* SPDX identifier, or "proprietary" */
  uint32_t flags;
  uint32_t reserved;
  /* Calls found(to, id, problem) for each connected device. `id` is its serial number. `problem` is
   * NULL, or one line with the reason why the device cannot be opened and the remedy. Returns
   * HAPTICAST_OK, or HAPTICAST_LOST if devices cannot be searched; the reason is then in `why`. */
  int (*list)(const hapticast_host* host,
              void (*found)(void* to, const char* id, const char* problem), void* to,
              char why[256]);
  /* Opens the device `id` (NULL: the first one) with a force of zero. It may last minutes and log
   * its progress. Returns NULL on failure; the reason and the remedy are then in `why`. A
   * reason that begins with `--` names a flag of the user with a wrong value. */
  hapticast_device* (*open)(const hapticast_host* host, const char* id, hapticast_profile* profile,
                            char why[256]);
  /* Waits for the device's own tick, at most until `until_ns`. NULL: the host's timer paces the
   * loop. Returns HAPTICAST_OK. */
  int (*wait)(hapticast_device* device, int64_t until_ns);
  /* Commands `force_N`, and writes the newest reading into `state`. Does not block. The host may
   * call it twice in one tick: for the reading, and as soon as a newer force is known. Returns
   * HAPTICAST_OK, or HAPTICAST_LOST. */
  int (*exchange)(hapticast_device* device, const double force_N[3], hapticast_state* state);
  /* Commands zero. Returns 0 if the device received it. */
  int (*zero)(hapticast_device* device);
  /* Commands zero, ends all threads of the driver, and frees the device. */
  void (*close)(hapticast_device* device);
  /* Switches a sign on the device on (1) or off (0): a safety state holds that the user must not
   * miss, for example "this stream moves your hand". NULL: the device has no light. Does not block.
   * The thread of exchange() calls it. Drivers built before this member have a smaller `size`; the
   * host then does not call it. */
  void (*warn)(hapticast_device* device, int on);
} hapticast_driver;

/* The only symbol that a driver exports. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const hapticast_driver*
hapticast_device_v1(void);

#ifdef __cplusplus
}
#endif

#endif
