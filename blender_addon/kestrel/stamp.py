# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture says of how it was made: fields for the metadata of image files."""

NAMES = 20  # of selected objects; of more, these are the most relevant


def seconds(ms):
    return f"{ms / 1000.0:.3f} s"


def selection(objects):
    """How many of the objects in view were ray traced, and which."""
    visible = [item for item in objects if item["area_px"] > 0]
    chosen = sorted((item for item in visible if item["effects"]),
                    key=lambda item: -item["relevance"])
    text = f"{len(chosen)} of {len(visible)} objects"
    names = ", ".join(item["name"] for item in chosen[:NAMES])
    more = ", ..." if len(chosen) > NAMES else ""
    return f"{text}: {names}{more}" if names else text


def fields(version, layer, stats, read_s, total_s):
    """{name: text} of a view layer. `stats`: the library's of the frame; `read_s`: seconds that
    reading the scene took; `total_s`: since it began."""
    budget, stages, rays = stats["budget_ms"], stats["stages_ms"], stats["rays"]
    values = {
        "version": version,
        "samples": str(stats["samples"]),
        "primary": stats["primary"],
        "budget": f"{budget:g} ms" if budget > 0 else "unlimited",
        "selection": selection(stats["objects"]),
        "rays": ", ".join(f"{name} {count}" for name, count in rays.items()),
        "total_time": f"{total_s:.3f} s",
        "synchronization_time": f"{read_s:.3f} s",
        "render_time": seconds(stats["frame_ms"]),
    }
    values.update((f"{stage}_time", seconds(ms)) for stage, ms in stages.items())
    return {f"kestrel.{layer}.{name}": text for name, text in values.items()}
