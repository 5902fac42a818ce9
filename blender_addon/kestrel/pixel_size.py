# SPDX-License-Identifier: GPL-3.0-or-later
"""How coarse the picture is while something changes, so that frames come in time."""

COARSEST = 8
RETRY_S = 3.0  # before a size is tried again that took too long


class PixelSize:
    """Automatic pixel size: 1, 2, 4 or 8 pixels of the screen for one of the picture.

    It starts coarse, for a first picture soon, and follows the measured times.
    """

    def __init__(self):
        self.value = 4
        self._too_slow = {}  # size: when it was last seen to take too long

    def learn(self, frame_ms, budget_ms, target_ms, now):
        """A frame of the current size took `frame_ms`, of which ray tracing may have had
        `budget_ms`; `now` in seconds."""
        if frame_ms > target_ms:
            self._too_slow[self.value] = now
            self.value = min(2 * self.value, COARSEST)
            return
        finer = self.value // 2
        # Four times the pixels; what the budget limits stays.
        expected_ms = min(frame_ms, budget_ms) + 4.0 * max(frame_ms - budget_ms, 0.0)
        if finer and expected_ms < target_ms and (
                now - self._too_slow.get(finer, -RETRY_S) >= RETRY_S):
            self.value = finer
