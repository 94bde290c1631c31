/* SPDX-License-Identifier: MIT
 * The file that the stand-in driver maps: what a test reads after the death of all others. */
#ifndef HAPTICAST_STANDIN_H
#define HAPTICAST_STANDIN_H

#include <stdint.h>

struct standin_trace {
  volatile uint32_t go;       /* set by the test: misbehave from now on */
  volatile uint32_t opened;
  volatile uint32_t closed;
  volatile uint32_t zeros;    /* calls of zero() */
  volatile uint64_t exchanges;
  volatile int64_t last_force_ns; /* CLOCK_MONOTONIC of the last command that was not zero */
  volatile double force_N;        /* magnitude of the last command */
  volatile double most_N;
};

#endif
