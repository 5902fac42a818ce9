# SPDX-License-Identifier: GPL-3.0-or-later
"""Color ramps and curves as tables of constants."""


def curves(site, value, mapping, channels, first=None):
    """x, y and z of a value through these curves of a CurveMapping, after the curve `first`."""
    mapping.update()
    used = [mapping.curves[channel] for channel in channels]
    ends = [point.location[0] for curve in (*used, *([mapping.curves[first]] if first else []))
            for point in (curve.points[0], curve.points[len(curve.points) - 1])]
    low, high = min(ends), max(ends)
    size = site.b.table["table_size"]

    def at(curve, x):
        return mapping.evaluate(curve, x)

    rows = []
    for step in range(size):
        x = low + (high - low) * step / (size - 1)
        if first is not None:
            x = at(mapping.curves[first], x)
        rows.append((*(at(curve, x) for curve in used), 1.0))
    extends = 1.0 if mapping.extend == "EXTRAPOLATED" else 0.0
    return site.b.op("table", value, modes=("CURVES",), data=((low, high, extends, 0.0), *rows))


def color_ramp(site, value, ramp):
    """RGBA of a ColorRamp; the alpha in w."""
    size = site.b.table["table_size"]
    rows = tuple(tuple(ramp.evaluate(step / (size - 1))) for step in range(size))
    stepped = ramp.interpolation == "CONSTANT"
    return site.b.op("table", value, modes=("CONSTANT" if stepped else "LINEAR",), data=rows)
