# SPDX-License-Identifier: MIT
"""How tests in Python wait: for an event, by one loop (tests/README.md, "Waiting and ports")."""

import time

SOON_S = 60  # what takes moments on an idle machine; it only ends a test that has failed


def wait_until(condition, what, seconds=SOON_S):
    """Returns the first true value of `condition()`; fails with `what` after a deadline."""
    deadline = time.monotonic() + seconds
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError(f"{what()} after {seconds} s" if callable(what) else what)
        time.sleep(0.02)
