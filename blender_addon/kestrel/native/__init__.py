# SPDX-License-Identifier: GPL-3.0-or-later
"""The way to libkestrel.so. Nothing in here knows Blender."""
