# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs tests step by step between Blender's own events.

A test method may be a generator: it yields a function, and goes on once that is true, or fails
after WAIT_S; None waits for the next round of events alone.
"""

import inspect
import time
import traceback
import unittest

import bpy

STEP_S = 0.01
WAIT_S = 60.0


def flatten(suite):
    for item in suite:
        if isinstance(item, unittest.TestSuite):
            yield from flatten(item)
        else:
            yield item


def steps(test):
    """Every step of a test, set-up and clean-up included; raises what the test raises."""
    try:
        test.setUp()
        made = getattr(test, test._testMethodName)()
        if inspect.isgenerator(made):
            for condition in made:
                yield
                limit = time.monotonic() + WAIT_S
                while condition is not None and not condition():
                    if time.monotonic() > limit:
                        raise AssertionError(f"waited {WAIT_S:.0f} s in vain for\n"
                                             f"{inspect.getsource(condition)}")
                    yield
        test.tearDown()
    finally:
        if not test.doCleanups():
            raise AssertionError("the clean-up failed")


def run(suite, end):
    """Run all tests from a timer, print what came of them, then call `end(all passed)`."""
    tests = list(flatten(suite))
    failed = []

    def all_steps():
        for test in tests:
            begin = time.monotonic()
            try:
                yield from steps(test)
                outcome = "ok"
            except unittest.SkipTest as reason:
                outcome = f"SKIP: {reason}"
            except Exception:
                failed.append(test.id())
                outcome = f"FAIL\n{traceback.format_exc()}"
            print(f"{test.id()} ({time.monotonic() - begin:.1f} s) ... {outcome}", flush=True)
        print(f"{len(tests)} tests, failed: {', '.join(failed) or 'none'}", flush=True)
        end(bool(tests) and not failed)

    todo = all_steps()

    def step():
        return STEP_S if next(todo, todo) is not todo else None

    bpy.app.timers.register(step, first_interval=1.0, persistent=True)
