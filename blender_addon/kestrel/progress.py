# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a final render is: the share that is done, the time left, memory, and the text of it."""

import os
import time

STEADY_S = 3.0   # over which an estimate of the end is averaged
KNOWN_AFTER_S = 1.0  # of rendering, before the time left is told


class Progress:
    """One render of several view layers, one after the other. It never goes back."""

    def __init__(self, clock=time.monotonic):
        self.fraction = 0.0     # of all view layers
        self._clock = clock
        self._layer = (0, 1)    # index, number
        self._begun = None      # (time, fraction) when the first pixels came
        self._end = None        # estimated, on the clock
        self._last = 0.0        # time of the last estimate

    def begin_layer(self, index, count):
        self._layer = (index, count)
        self.advance(0.0)

    def advance(self, fraction):
        """`fraction` of the view layer under way is done."""
        index, count = self._layer
        self.fraction = min(max(self.fraction, (index + fraction) / count), 1.0)
        now = self._clock()
        if self._begun is None:
            if fraction > 0.0:
                self._begun, self._last = (now, self.fraction), now
            return
        self._estimate(now)

    def _estimate(self, now):
        elapsed, done = now - self._begun[0], self.fraction - self._begun[1]
        if done <= 0.0 or now <= self._last:
            return
        end = now + elapsed * (1.0 - self.fraction) / done
        weight = 1.0 if self._end is None else min((now - self._last) / min(elapsed, STEADY_S), 1.0)
        self._end = end if self._end is None else self._end + weight * (end - self._end)
        self._last = now

    @property
    def remaining_s(self):
        """Seconds left, None while nobody can know."""
        if self._end is None or self._clock() - self._begun[0] < KNOWN_AFTER_S:
            return None
        return max(self._end - self._clock(), 0.0)


def time_text(seconds):
    """00:12.34, or 1:02:03.45, as Blender writes it."""
    hundredths = round(100.0 * seconds)
    minutes, rest = divmod(hundredths, 6000)
    hours, minutes = divmod(minutes, 60)
    text = f"{minutes:02}:{rest // 100:02}.{rest % 100:02}"
    return f"{hours}:{text}" if hours else text


class Memory:
    """Memory of the whole process, MB; 0 where the system does not say it."""

    def __init__(self):
        self.used = self.peak = 0.0
        self.measure()

    def measure(self):
        try:
            with open("/proc/self/statm", encoding="ascii") as file:
                pages = int(file.read().split()[1])
        except OSError:
            return
        self.used = pages * os.sysconf("SC_PAGE_SIZE") / 2.0 ** 20
        self.peak = max(self.peak, self.used)


def status_text(place, stage, remaining_s, memory):
    """What stands beside Blender's own frame number and time. `place`: scene and view layer."""
    parts = []
    if remaining_s is not None:
        parts.append(f"Remaining:{time_text(remaining_s)}")
    if memory.used:
        parts.append(f"Mem:{memory.used:.2f}M, Peak:{memory.peak:.2f}M")
    return " | ".join((*parts, place, stage))
