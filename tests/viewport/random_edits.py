# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits such as an artist makes, at random.

An edit looks up by itself what it changes, and keeps nothing: undo, deletion and switches leave no
reference valid.
"""

import math
import os
import random

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector
from support import diffuse, image, shader_material, textured

MOST_OBJECTS = 30
MOST_MATERIALS = 12
MOST_IMAGES = 5
MOST_STEPS = 3  # of undo or redo at once

EDITS = []  # (weight, whether it needs object mode, function)


def edit(weight=1.0, object_mode=False):
    """Lists a function of an Editor among the edits."""
    def listed(function):
        EDITS.append((weight, object_mode, function))
        return function
    return listed


VERBOSE = "KESTREL_EDITS_VERBOSE" in os.environ  # each edit's name is printed first


class Editor:
    """Makes edits in a window's 3D view. The same seed makes the same edits."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.count = 0  # of edits; makes names unique

    # ---- what there is ----

    @property
    def scene(self):
        return bpy.context.scene

    @property
    def view_layer(self):
        return bpy.context.view_layer

    @property
    def space(self):
        return bpy.context.space_data

    def objects(self, *types):
        """Those of the scene, in order of their names."""
        return sorted((obj for obj in self.scene.objects if not types or obj.type in types),
                      key=lambda obj: obj.name)

    def some(self, items):
        """One of them, None where there are none."""
        items = list(items)
        return self.random.choice(items) if items else None

    def some_object(self, *types):
        return self.some(self.objects(*types))

    def some_visible(self, *types):
        return self.some(obj for obj in self.objects(*types) if obj.visible_get())

    def some_material(self):
        return self.some(sorted(bpy.data.materials, key=lambda item: item.name))

    def some_image(self):
        return self.some(sorted((item for item in bpy.data.images if item.source == "GENERATED"),
                                key=lambda item: item.name))

    def name(self, kind):
        return f"{kind} {self.count}"

    def place(self, spread=2.5):
        return Vector(self.random.uniform(-spread, spread) for _ in range(3))

    def color(self):
        return tuple(self.random.random() for _ in range(3))

    # ---- doing ----

    def activate(self, obj):
        """Make this the only selected object; whether that could be done."""
        for other in self.view_layer.objects:
            other.select_set(False)
        self.view_layer.objects.active = obj
        if not obj.visible_get(view_layer=self.view_layer):
            return False
        obj.select_set(True)
        return True

    def leave_mode(self):
        active = self.view_layer.objects.active
        if active is not None and active.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")

    def step(self):
        """Make one edit and remember it for undo."""
        weights = [weight for weight, _, _ in EDITS]
        _, object_mode, function = self.random.choices(EDITS, weights)[0]
        self.count += 1
        if object_mode:
            self.leave_mode()
        if VERBOSE:
            print(self.count, function.__name__, flush=True)
        function(self)
        if function not in (undo, redo):
            bpy.ops.ed.undo_push(message=function.__name__)


# ---- transforming ------------------------------------------------------------------------------

@edit(10)
def move(editor):
    obj = editor.some_object()
    if obj:
        obj.location += 0.3 * editor.place()


@edit(4)
def rotate(editor):
    obj = editor.some_object()
    if obj:
        obj.rotation_euler = Euler(editor.place(math.pi))


@edit(4)
def scale(editor):
    """Mirrored at times."""
    obj = editor.some_object("MESH", "CURVE", "EMPTY")
    if obj:
        obj.scale = [editor.random.choice((-1.0, 1.0, 1.0)) * editor.random.uniform(0.3, 1.5)
                     for _ in range(3)]


@edit(1, object_mode=True)
def parent(editor):
    child, other = editor.some_object(), editor.some_object("MESH", "EMPTY")
    if child and other:
        above = other
        while above is not None and above != child:
            above = above.parent
        child.parent = other if above is None else None


# ---- adding and deleting -----------------------------------------------------------------------

def _add(editor, name, data):
    while len(editor.scene.objects) >= MOST_OBJECTS:
        bpy.data.objects.remove(editor.some_object())
    obj = bpy.data.objects.new(name, data)
    collections = [editor.scene.collection, *editor.scene.collection.children]
    editor.some(collections).objects.link(obj)
    obj.location = editor.place()
    return obj


@edit(3, object_mode=True)
def add_mesh(editor):
    kind = editor.random.choice((
        bpy.ops.mesh.primitive_cube_add, bpy.ops.mesh.primitive_monkey_add,
        bpy.ops.mesh.primitive_uv_sphere_add, bpy.ops.mesh.primitive_torus_add))
    kind(location=editor.place(), rotation=editor.place())
    obj = bpy.context.view_layer.objects.active
    obj.scale *= 0.5
    obj.data.materials.append(editor.some_material())


@edit(2, object_mode=True)
def add_linked_duplicate(editor):
    source = editor.some_object("MESH", "CURVE", "FONT", "META", "LIGHT")
    if source:
        copy = _add(editor, editor.name("Linked"), source.data)
        if copy.type == "MESH" and copy.material_slots:
            copy.material_slots[0].link = editor.random.choice(("OBJECT", "DATA"))
            copy.material_slots[0].material = editor.some_material()


@edit(1, object_mode=True)
def duplicate(editor):
    source = editor.some_visible()
    if source and editor.activate(source):
        bpy.ops.object.duplicate(linked=editor.random.random() < 0.5)


@edit(1, object_mode=True)
def add_collection_instance(editor):
    source = editor.some(sorted(editor.scene.collection.children, key=lambda item: item.name))
    empty = _add(editor, editor.name("Instance"), None)
    for collection in list(empty.users_collection):  # a collection cannot hold its own instance
        collection.objects.unlink(empty)
    editor.scene.collection.objects.link(empty)
    empty.instance_type, empty.instance_collection = "COLLECTION", source


@edit(1, object_mode=True)
def add_light(editor):
    kind = editor.random.choice(("POINT", "SUN", "SPOT", "AREA"))
    light = bpy.data.lights.new(editor.name("Light"), kind)
    light.energy = 3.0 if kind == "SUN" else 100.0
    light.color = editor.color()
    _add(editor, light.name, light)


@edit(1, object_mode=True)
def add_curve(editor):
    curve = bpy.data.curves.new(editor.name("Curve"), "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(3)
    for point in spline.bezier_points:
        point.co = editor.place(1.0)
        point.handle_left_type = point.handle_right_type = "AUTO"
    curve.materials.append(editor.some_material())
    _add(editor, curve.name, curve)


@edit(1, object_mode=True)
def add_text(editor):
    text = bpy.data.curves.new(editor.name("Text"), "FONT")
    text.body, text.extrude = editor.name("Text"), 0.1
    _add(editor, text.name, text)


@edit(1, object_mode=True)
def add_metaball(editor):
    data = bpy.data.metaballs.new("Family")
    data.resolution = 0.3
    data.elements.new().co = editor.place(0.5)
    _add(editor, "Family", data)


@edit(3, object_mode=True)
def delete_object(editor):
    if len(editor.scene.objects) > 8:
        obj = editor.some_visible()
        if obj and editor.activate(obj):
            bpy.ops.object.delete()


@edit(1, object_mode=True)
def remove_object(editor):
    if len(editor.scene.objects) > 8:
        bpy.data.objects.remove(editor.some_object())


@edit(0.5, object_mode=True)
def remove_mesh_in_use(editor):
    obj = editor.some_object("MESH")
    if obj and len(editor.scene.objects) > 12:
        bpy.data.meshes.remove(obj.data)


@edit(0.5)
def remove_material_in_use(editor):
    material = editor.some_material()
    if material and len(bpy.data.materials) > 3:
        bpy.data.materials.remove(material)


@edit(0.5)
def remove_image_in_use(editor):
    picture = editor.some_image()
    if picture and len(bpy.data.images) > 2:
        bpy.data.images.remove(picture)


@edit(0.5, object_mode=True)
def purge(editor):
    bpy.data.orphans_purge(do_recursive=True)


@edit(1)
def rename(editor):
    item = editor.some((editor.some_object(), editor.some_material(), editor.some_image()))
    if item:
        item.name = editor.name("Renamed")


# ---- materials ---------------------------------------------------------------------------------

def _picture(editor):
    while len(bpy.data.images) >= MOST_IMAGES + 1:
        picture = editor.some_image()
        if picture is None:
            break
        bpy.data.images.remove(picture)
    texels = np.ones((16, 16, 4), np.float32)
    texels[..., :3] = np.random.default_rng(editor.count).random((16, 16, 3))
    return image(editor.name("Picture"), texels)


@edit(2)
def new_material(editor):
    name = editor.name("Material")
    while len(bpy.data.materials) >= MOST_MATERIALS:
        bpy.data.materials.remove(editor.some_material())
    kind = editor.random.randrange(5)
    if kind == 0:
        made = diffuse(name, editor.color())
    elif kind == 1:
        made = shader_material(name, "ShaderNodeBsdfGlossy", Color=editor.color(), Roughness=0.0)
    elif kind == 2:
        made = shader_material(name, "ShaderNodeBsdfGlass", Color=editor.color(), IOR=1.4)
    elif kind == 3:
        made = shader_material(name, "ShaderNodeBsdfPrincipled", Base_Color=editor.color(),
                               Roughness=0.3)
    else:
        made, _ = textured(name, editor.some_image() or _picture(editor), "ShaderNodeBsdfDiffuse")
    _assign(editor, made)


def _assign(editor, material):
    obj = editor.some_object("MESH", "CURVE", "FONT", "META")
    if obj is None or obj.data.materials is None:
        return
    if len(obj.data.materials):
        obj.data.materials[editor.random.randrange(len(obj.data.materials))] = material
    else:
        obj.data.materials.append(material)


@edit(3)
def assign_material(editor):
    _assign(editor, editor.some_material())


@edit(4)
def change_material(editor):
    material = editor.some_material()
    if material is None or material.node_tree is None:
        return
    sockets = [socket for node in material.node_tree.nodes for socket in node.inputs
               if socket.type in {"RGBA", "VALUE"} and socket.enabled and not socket.is_linked]
    socket = editor.some(sockets)
    if socket is not None and socket.type == "RGBA":
        socket.default_value = (*editor.color(), 1.0)
    elif socket is not None:
        socket.default_value = editor.random.random()


@edit(1)
def change_image_of_material(editor):
    nodes = [node for material in bpy.data.materials if material.node_tree
             for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
    node = editor.some(nodes)
    if node is not None:
        node.image = editor.some_image()


@edit(1)
def paint_image(editor):
    picture = editor.some_image()
    if picture is not None:
        texels = np.ones(picture.size[0] * picture.size[1] * 4, np.float32)
        texels[editor.random.randrange(4)::4] = editor.random.random()
        picture.pixels.foreach_set(texels)
        picture.update()
        picture.update_tag()


@edit(1)
def add_image(editor):
    _picture(editor)


@edit(2, object_mode=True)
def change_slots(editor):
    obj = editor.some_object("MESH")
    if obj is None:
        return
    if len(obj.data.materials) < 3:
        obj.data.materials.append(editor.some_material())
    else:
        obj.data.materials.pop()
    count = max(len(obj.data.materials), 1)
    for polygon in list(obj.data.polygons)[::3]:
        polygon.material_index = editor.random.randrange(count)
    obj.data.update()


@edit(0.5)
def override_material(editor):
    layer = editor.view_layer
    layer.material_override = None if layer.material_override else editor.some_material()


# ---- modifiers and meshes ----------------------------------------------------------------------

@edit(4, object_mode=True)
def add_modifier(editor):
    obj = editor.some_object("MESH")
    if obj is None or len(obj.data.polygons) > 3000:
        return
    kind = editor.random.choice(("SUBSURF", "BEVEL", "ARRAY", "MIRROR", "SOLIDIFY", "DECIMATE",
                                 "WIREFRAME", "TRIANGULATE"))
    while len(obj.modifiers) >= 2:
        obj.modifiers.remove(obj.modifiers[0])
    modifier = obj.modifiers.new(kind.title(), kind)
    if kind == "SUBSURF":
        modifier.levels = 1


@edit(2, object_mode=True)
def remove_modifier(editor):
    obj = editor.some(obj for obj in editor.objects("MESH") if obj.modifiers)
    if obj:
        obj.modifiers.remove(editor.some(obj.modifiers))


@edit(2)
def switch_modifier(editor):
    obj = editor.some(obj for obj in editor.objects("MESH") if obj.modifiers)
    if obj:
        modifier = editor.some(obj.modifiers)
        modifier.show_viewport = not modifier.show_viewport


@edit(1, object_mode=True)
def apply_modifier(editor):
    obj = editor.some(obj for obj in editor.objects("MESH")
                      if obj.modifiers and obj.data.users == 1 and obj.visible_get())
    kinds = {"SUBSURF", "BEVEL", "ARRAY", "MIRROR", "SOLIDIFY", "DECIMATE", "TRIANGULATE"}
    if obj and obj.modifiers[0].type in kinds and len(obj.data.polygons) < 1000 and (
            editor.activate(obj)):
        try:
            bpy.ops.object.modifier_apply(modifier=obj.modifiers[0].name)
        except RuntimeError:  # a modifier that is switched off
            pass


@edit(3, object_mode=True)
def deform_mesh(editor):
    obj = editor.some_object("MESH")
    if obj:
        obj.data.transform(Matrix.Diagonal((*(editor.random.uniform(0.7, 1.4) for _ in range(3)),
                                            1.0)))
        obj.data.update()


@edit(1, object_mode=True)
def shade(editor):
    obj = editor.some_object("MESH")
    if obj:
        smooth = editor.random.random() < 0.5
        obj.data.polygons.foreach_set("use_smooth", np.full(len(obj.data.polygons), smooth))
        obj.data.update()


@edit(1, object_mode=True)
def change_attributes(editor):
    obj = editor.some_object("MESH")
    if obj is None:
        return
    if len(obj.data.uv_layers) < 3:
        obj.data.uv_layers.new()
    else:
        obj.data.uv_layers.remove(obj.data.uv_layers[0])
    if not obj.data.color_attributes:
        obj.data.color_attributes.new("Color", "FLOAT_COLOR", "POINT")


@edit(1, object_mode=True)
def give_other_mesh(editor):
    obj, other = editor.some_object("MESH"), editor.some_object("MESH")
    if obj and other:
        obj.data = other.data


@edit(1, object_mode=True)
def replace_mesh(editor):
    """Another mesh of as many vertices."""
    obj = editor.some_object("MESH")
    if obj:
        old = obj.data
        obj.data = old.copy()
        obj.data.transform(Matrix.Diagonal((1.0, 1.0, 0.8, 1.0)))
        if old.users == 0:
            bpy.data.meshes.remove(old)


# ---- instances and hair ------------------------------------------------------------------------

@edit(1, object_mode=True)
def add_particles(editor):
    """Hair, or instances of an object, on some mesh."""
    obj = editor.some_object("MESH")
    if obj is None or len(obj.data.polygons) == 0:
        return
    systems = [other for other in editor.objects("MESH") if other.particle_systems]
    if len(systems) >= 3:
        used = editor.some(systems)
        used.modifiers.clear()
        return
    obj.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = obj.particle_systems[-1].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 15, 0.5
    source = editor.some_object("MESH")
    if editor.random.random() < 0.5 and source != obj:
        settings.render_type, settings.instance_object = "OBJECT", source
        settings.particle_size = 0.2


@edit(2, object_mode=True)
def change_particles(editor):
    obj = editor.some(obj for obj in editor.objects("MESH") if obj.particle_systems)
    if obj:
        settings = obj.particle_systems[0].settings
        settings.count = editor.random.randrange(1, 30)
        settings.hair_length = editor.random.uniform(0.1, 0.6)


@edit(1, object_mode=True)
def instance_on_vertices(editor):
    parent_ = editor.some_object("MESH")
    if parent_ is None or len(parent_.data.vertices) > 600:
        return
    parent_.instance_type = "NONE" if parent_.instance_type == "VERTS" else "VERTS"
    child = editor.some_object("MESH")
    if child != parent_ and child.parent is None and parent_.parent is None and (
            not child.children):
        child.parent = parent_


@edit(1, object_mode=True)
def add_geometry_nodes(editor):
    """Instances of a cube on the points of a mesh, made real or not."""
    tree = bpy.data.node_groups.get("Scatter")
    obj = editor.some_object("MESH")
    if tree is None or obj is None or len(obj.data.vertices) > 1000:
        return
    using = [(other, modifier) for other in editor.objects("MESH") for modifier in other.modifiers
             if modifier.type == "NODES"]
    if len(using) >= 3:
        other, modifier = editor.some(using)
        other.modifiers.remove(modifier)
        return
    obj.modifiers.new("Scatter", "NODES").node_group = tree


@edit(2)
def change_geometry_nodes(editor):
    tree = bpy.data.node_groups.get("Scatter")
    if tree:
        cube = next(node for node in tree.nodes if node.bl_idname == "GeometryNodeMeshCube")
        cube.inputs["Size"].default_value = [editor.random.uniform(0.05, 0.3) for _ in range(3)]


@edit(1, object_mode=True)
def mute_geometry_nodes(editor):
    """What the points carry: cubes, or nothing."""
    tree = bpy.data.node_groups.get("Scatter")
    if tree:
        node = next(node for node in tree.nodes
                    if node.bl_idname == "GeometryNodeInstanceOnPoints")
        node.mute = not node.mute


# ---- lights, world, settings -------------------------------------------------------------------

@edit(2)
def change_light(editor):
    obj = editor.some_object("LIGHT")
    if obj:
        obj.data.color = editor.color()
        obj.data.energy *= editor.random.uniform(0.7, 1.4)


@edit(1)
def change_light_type(editor):
    obj = editor.some_object("LIGHT")
    if obj:
        obj.data.type = editor.random.choice(("POINT", "SUN", "SPOT", "AREA"))
        obj.data.energy = 3.0 if obj.data.type == "SUN" else 100.0


@edit(1)
def change_world(editor):
    world = editor.scene.world
    if world:
        background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
        background.inputs["Color"].default_value = (*editor.color(), 1.0)


@edit(1)
def change_relevance(editor):
    obj = editor.some_object()
    if obj:
        obj.kestrel.relevance = editor.random.uniform(0.5, 3.0)
        obj.kestrel.reflections = editor.random.choice(("auto", "always", "never"))


@edit(1)
def change_settings(editor):
    editor.scene.kestrel.max_depth = editor.random.randrange(1, 6)
    editor.scene.render.film_transparent = editor.random.random() < 0.5


# ---- time --------------------------------------------------------------------------------------

@edit(4)
def change_frame(editor):
    editor.scene.frame_set(editor.random.randrange(1, 30))


@edit(1)
def animate(editor):
    obj = editor.some_object()
    if obj is None:
        return
    if obj.animation_data:
        obj.animation_data_clear()
        return
    for frame in (1, 15, 30):
        obj.location += 0.5 * editor.place(1.0)
        obj.keyframe_insert("location", frame=frame)


# ---- visibility --------------------------------------------------------------------------------

@edit(4)
def hide(editor):
    obj = editor.some_object()
    if obj and obj.mode == "OBJECT" and obj.name in editor.view_layer.objects:
        how = editor.random.randrange(4)
        if how == 0:
            obj.hide_set(not obj.hide_get())
        elif how == 1:
            obj.hide_viewport = not obj.hide_viewport
        elif how == 2:
            obj.hide_render = not obj.hide_render
        else:
            obj.visible_camera = not obj.visible_camera


@edit(2, object_mode=True)
def unhide_all(editor):
    for obj in editor.objects():
        obj.hide_viewport = False
        if obj.name in editor.view_layer.objects:
            obj.hide_set(False)


@edit(2, object_mode=True)
def hide_collection(editor):
    layer = editor.some(editor.view_layer.layer_collection.children)
    if layer is None:
        return
    how = editor.random.randrange(5)
    if how == 0:
        layer.exclude = not layer.exclude
    elif how == 1:
        layer.hide_viewport = not layer.hide_viewport
    elif how == 2:
        layer.collection.hide_viewport = not layer.collection.hide_viewport
    elif how == 3:
        layer.holdout = not layer.holdout
    else:
        layer.indirect_only = not layer.indirect_only


@edit(1, object_mode=True)
def move_to_collection(editor):
    obj = editor.some_object("MESH", "LIGHT", "CURVE")
    target = editor.some(editor.scene.collection.children)
    if obj and target and not obj.users_collection[0] == target:
        obj.users_collection[0].objects.unlink(obj)
        if obj.name not in target.objects:
            target.objects.link(obj)


@edit(2, object_mode=True)
def local_view(editor):
    if editor.space.local_view is None:
        obj = editor.some_visible()
        if obj is None or not editor.activate(obj):
            return
    bpy.ops.view3d.localview(frame_selected=False)


# ---- modes -------------------------------------------------------------------------------------

@edit(5)
def switch_mode(editor):
    active = editor.view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        editor.leave_mode()
        return
    obj = editor.some_visible("MESH", "CURVE", "FONT", "META")
    if obj and editor.activate(obj):
        modes = ("EDIT", "EDIT", "SCULPT", "VERTEX_PAINT", "WEIGHT_PAINT") if (
            obj.type == "MESH") else ("EDIT",)
        bpy.ops.object.mode_set(mode=editor.random.choice(modes))


@edit(5)
def work_in_mode(editor):
    """Change the mesh that is in edit mode."""
    active = editor.view_layer.objects.active
    if active is None or active.mode != "EDIT" or active.type != "MESH":
        return
    bpy.ops.mesh.select_all(action="SELECT")
    how = editor.random.randrange(4)
    if how == 0:
        bpy.ops.transform.translate(value=0.2 * editor.place(1.0))
    elif how == 1 and len(active.data.polygons) < 500:
        bpy.ops.mesh.subdivide()
    elif how == 2:
        bpy.ops.mesh.select_random(ratio=0.1, seed=editor.count)
        bpy.ops.mesh.delete(type="FACE")
    else:
        bpy.ops.mesh.flip_normals()


# ---- the view ----------------------------------------------------------------------------------

@edit(3)
def orbit(editor):
    turn = Euler((0.0, 0.0, editor.random.uniform(-0.5, 0.5))).to_quaternion()
    editor.space.region_3d.view_rotation = turn @ editor.space.region_3d.view_rotation


@edit(0.5)
def switch_shading(editor):
    """What the view held goes, and comes back."""
    shading = editor.space.shading
    shading.type = "SOLID" if shading.type == "RENDERED" else "RENDERED"


@edit(12)
def render_shading(editor):
    editor.space.shading.type = "RENDERED"


@edit(1, object_mode=True)
def switch_scene(editor):
    if editor.space.local_view is None:
        bpy.context.window.scene = editor.some(sorted(bpy.data.scenes, key=lambda item: item.name))


# ---- back and forth ----------------------------------------------------------------------------

@edit(8)
def undo(editor):
    for _ in range(editor.random.randrange(1, MOST_STEPS + 1)):
        if bpy.ops.ed.undo.poll():
            try:
                bpy.ops.ed.undo()
            except RuntimeError:  # nothing to undo
                return


@edit(5)
def redo(editor):
    for _ in range(editor.random.randrange(1, MOST_STEPS + 1)):
        if bpy.ops.ed.redo.poll():
            try:
                bpy.ops.ed.redo()
            except RuntimeError:  # nothing to redo
                return


# ---- in Blender's events -----------------------------------------------------------------------

class EDITS_OT_random(bpy.types.Operator):
    """Makes an edit with every event of a timer, as a modal operator of the 3D view that it is
    started in. So operators have their context from Blender: in one that Python overrides,
    Blender with Python 3.11 crashes when another thread happens to hold Python's lock."""
    bl_idname = "kestrel_tests.random_edits"
    bl_label = "Random Edits"

    todo = 0        # edits
    editor = None
    error = None    # what an edit has raised; there are no more then

    @classmethod
    def start(cls, editor):
        """To be called with the context of the 3D view."""
        cls.editor, cls.todo, cls.error = editor, 0, None
        bpy.utils.register_class(cls)
        bpy.ops.kestrel_tests.random_edits("INVOKE_DEFAULT")

    @classmethod
    def stop(cls):
        """Let the operator end with its next event."""
        cls.editor = None

    def invoke(self, context, _event):
        self._timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        cls = type(self)
        if cls.editor is None:
            context.window_manager.event_timer_remove(self._timer)
            return {"FINISHED"}
        if event.type == "TIMER" and cls.todo:
            try:
                cls.editor.step()
                cls.todo -= 1
            except Exception as error:
                cls.error, cls.todo = error, 0
        return {"PASS_THROUGH"}
