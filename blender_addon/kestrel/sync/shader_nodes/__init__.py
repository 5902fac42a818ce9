# SPDX-License-Identifier: GPL-3.0-or-later
"""Node graphs of materials as node programs."""

from .compiler import compile_material

__all__ = ["compile_material"]
