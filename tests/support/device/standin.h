/* SPDX-License-Identifier: MIT
 * The file that a stand-in maps: what a test reads after the death of all others. */
#ifndef HAPTICAST_STANDIN_H
#define HAPTICAST_STANDIN_H

#include <stdint.h>

#define STANDIN_FORCES 32768

/* One command at the motors, in the axes of hapticast_device.h. */
struct standin_force {
  int64_t at_ns; /* CLOCK_MONOTONIC */
  double force_N[3];
};

struct standin_trace {
  volatile uint32_t go; /* set by the test: misbehave from now on */
  volatile uint32_t opened;
  volatile uint32_t closed;
  volatile uint32_t zeros; /* calls of zero() */
  volatile uint32_t sign;  /* 1: warn() has switched the sign on */
  volatile uint64_t exchanges;
  volatile int64_t last_force_ns; /* CLOCK_MONOTONIC of the last command that was not zero */
  volatile double force_N;        /* magnitude of the last command */
  volatile double most_N;
  struct standin_force
      forces[STANDIN_FORCES]; /* number i of `exchanges` is at i % STANDIN_FORCES */
};

#endif
