# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings: the parameter table's rows, from the properties of that name."""

from ..native import loader

# Rows that are Blender's own settings, not properties of Kestrel: read from the scene.
BLENDERS_OWN = {"film_transparent": lambda scene: scene.render.film_transparent,
                "motion_blur": lambda scene: scene.render.use_motion_blur}


def as_text(row, value):
    """A property's value in the table's notation."""
    if row["type"] == "bool":
        return "true" if value else "false"
    if row["type"] == "color":
        return " ".join(f"{channel:.9g}" for channel in value)
    if row["type"] == "float":  # a limit itself may be beyond it once rounded to 32 bits
        return f"{min(max(value, row['min']), row['max']):.9g}"
    return str(value)


def rows(scope):
    return [row for row in loader.parameter_table() if row["scope"] == scope]


def scene_value(scene, name):
    read = BLENDERS_OWN.get(name)
    return read(scene) if read else getattr(scene.kestrel, name)


def sync_settings(export, scene, view_layer, world_ambient, without=()):
    """Send a scene's settings, but those called `without`. The view layer's own samples count
    where it has some. The world's ambient light joins the artist's own, and Blender's fixed thread
    count holds where Kestrel's is left automatic."""
    values = {row["name"]: scene_value(scene, row["name"]) for row in rows("scene")}
    values["samples"] = view_layer.samples or values["samples"]
    values["ambient"] = [own + world for own, world in zip(values["ambient"], world_ambient)]
    if values["threads"] == 0 and scene.render.threads_mode == "FIXED":
        values["threads"] = scene.render.threads
    for row in rows("scene"):
        if row["name"] not in without:
            text = as_text(row, values[row["name"]])
            export.note(row["name"], text)
            export.scene.set_setting(row["name"], text)
