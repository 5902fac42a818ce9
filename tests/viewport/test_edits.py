# SPDX-License-Identifier: GPL-3.0-or-later
"""However a scene came about, the viewport has what a fresh export of it has.

KESTREL_EDITS: how many random edits are made, KESTREL_EDITS_SEED: which.
"""

import faulthandler
import os

import bpy
import numpy as np
from kestrel import session, sync
from mathutils import Matrix
from random_edits import EDITS_OT_random, Editor
from scene_files import differences
from support import diffuse, image, shader_material, textured
from test_motion import resident_mib
from viewport_support import ViewportTest

EDITS = int(os.environ.get("KESTREL_EDITS", "1000"))
SEED = int(os.environ.get("KESTREL_EDITS_SEED", "1"))
CHECK_EVERY = 50  # edits
MEMORY_GROWTH = 1.05


def scatter_nodes():
    """Geometry nodes: what comes in, and a cube on each of its vertices."""
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    if hasattr(tree, "interface"):  # 4.0 on
        for direction in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=direction,
                                      socket_type="NodeSocketGeometry")
    else:
        tree.inputs.new("NodeSocketGeometry", "Geometry")
        tree.outputs.new("NodeSocketGeometry", "Geometry")
    source, result = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    points = tree.nodes.new("GeometryNodeInstanceOnPoints")
    cube, join = tree.nodes.new("GeometryNodeMeshCube"), tree.nodes.new("GeometryNodeJoinGeometry")
    cube.inputs["Size"].default_value = (0.1, 0.1, 0.1)
    for start, end in ((source.outputs[0], points.inputs["Points"]),
                       (cube.outputs["Mesh"], points.inputs["Instance"]),
                       (points.outputs[0], join.inputs[0]), (source.outputs[0], join.inputs[0]),
                       (join.outputs[0], result.inputs[0])):
        tree.links.new(start, end)
    return tree


class EditsTest(ViewportTest):
    samples = 1

    # ---- the scene that is edited ----

    def fill_window(self):
        pass  # Blender has not made the new file's window yet

    def small_view(self):
        """One small 3D view: drawing a large one takes Blender longer than all else."""
        for area in self.window.screen.areas:
            area.type = "VIEW_3D" if area.type == "PROPERTIES" else "TEXT_EDITOR"
        self.space.overlay.show_overlays = False
        self.space.show_gizmo = self.space.show_region_header = False
        self.space.show_region_toolbar = self.space.show_region_ui = False

    def build(self):
        """Something of everything that the edits change."""
        self.still_life()
        self.furniture()
        self.instances()
        self.strands()
        other = bpy.data.scenes.new("Other")
        other.render.engine = "KESTREL"
        other.kestrel.viewport_samples = self.samples
        other.world = self.scene.world
        for name in ("Floor", "Red", "Sun"):
            other.collection.objects.link(bpy.data.objects[name])

    def furniture(self):
        """Linked duplicates, several materials, images, modifiers."""
        random = np.random.default_rng(0)
        for number in range(2):
            texels = random.random((16, 16, 4), np.float32)
            picture = image(f"Picture {number}", texels)
            textured(f"Textured {number}", picture, "ShaderNodeBsdfDiffuse")
        glass = shader_material("Glass", "ShaderNodeBsdfGlass", Color=(0.9, 1.0, 0.9), IOR=1.4)
        table = self.cube("Table", 0.8, glass, Matrix.Translation((1.5, 1.0, 0.4)))
        table.data.materials.append(bpy.data.materials["Textured 0"])
        table.data.polygons[0].material_index = 1
        for number in range(2):
            self.link(f"Chair {number}", table.data,
                      Matrix.Translation((-2.0, number - 1.0, 0.4)) @ Matrix.Scale(0.5, 4))
        bpy.data.objects["Chair 1"].scale.x = -0.5
        bpy.data.objects["Red"].modifiers.new("Bevel", "BEVEL").width = 0.1
        self.light("POINT", 100.0, (-2, -2, 3))

    def instances(self):
        """By collections and by geometry nodes."""
        for number in range(2):
            collection = bpy.data.collections.new(f"Collection {number}")
            self.scene.collection.children.link(collection)
            for part in range(2):
                cube = self.cube(f"Part {number} {part}", 0.4, bpy.data.materials["Red"],
                                 Matrix.Translation((part, number, 1.5)))
                self.scene.collection.objects.unlink(cube)
                collection.objects.link(cube)
            empty = self.link(f"Copy {number}", None, Matrix.Translation((0, -2, number)))
            empty.instance_type, empty.instance_collection = "COLLECTION", collection
        plane = self.plane("Scattered", 1.0, bpy.data.materials["Textured 1"],
                           Matrix.Translation((0, 2, 1)))
        plane.modifiers.new("Scatter", "NODES").node_group = scatter_nodes()

    def strands(self):
        """Hair, a curve and a text."""
        emitter = self.plane("Meadow", 1.0, diffuse("Green", (0.1, 0.6, 0.1)),
                             Matrix.Translation((2, -2, 0)))
        emitter.modifiers.new("Hair", "PARTICLE_SYSTEM")
        settings = emitter.particle_systems[0].settings
        settings.type, settings.count, settings.hair_length = "HAIR", 20, 0.4
        text = bpy.data.curves.new("Text", "FONT")
        text.body, text.extrude = "Kestrel", 0.1
        self.link("Text", text, Matrix.Translation((-2, 2, 0.5)))

    # ---- comparing ----

    def write_viewport(self, path):
        """The viewport's scene as a file."""
        self.viewport._session.scene.write(str(path))

    def write_fresh(self, path):
        """What a session that knows nothing makes of Blender's data now, as a file."""
        fresh = session.acquire("fresh")
        try:
            with self.context():
                depsgraph = bpy.context.evaluated_depsgraph_get()
            sync.export_viewport(fresh, depsgraph, self.space, lambda _text: None)
            fresh.scene.set_camera(self.viewport.picture.view.camera())
            for name in sync.VIEWPORT_SETTINGS:
                fresh.scene.set_setting(name, self.viewport._session.scene.get_setting(name))
            fresh.commit()
            fresh.scene.write(str(path))
        finally:
            session.drop("fresh")

    def check_scene(self, after):
        """`after`: what was done, for the message."""
        folders = [self.folder / name for name in ("viewport", "fresh")]
        for folder in folders:
            folder.mkdir(exist_ok=True)
        self.write_viewport(folders[0] / "scene.kscene")
        self.write_fresh(folders[1] / "scene.kscene")
        found = differences(*(folder / "scene.kscene" for folder in folders))
        self.assertEqual(found, [], f"after {after}")

    # ---- the test ----

    def edit(self, count):
        """Make edits between Blender's events, then let the picture settle."""
        EDITS_OT_random.todo = count
        yield lambda: EDITS_OT_random.todo == 0
        if EDITS_OT_random.error:
            raise EDITS_OT_random.error
        self.render_shading()
        yield self.settled

    def test_random_edits(self):
        faulthandler.enable()  # says what Python was doing if Blender crashes
        yield None
        self.small_view()
        self.build()
        self.look()
        self.render_shading()
        yield self.settled
        self.check_scene("nothing")
        with self.context():
            EDITS_OT_random.start(Editor(SEED))
        self.addCleanup(EDITS_OT_random.stop)
        used = []
        for done in range(CHECK_EVERY, EDITS + 1, CHECK_EVERY):
            yield from self.edit(CHECK_EVERY)
            self.check_scene(f"{done} edits of seed {SEED}")
            used.append(resident_mib())
        third = len(used) // 3
        if third:  # the first third fills the scene and Blender's undo memory
            early, late = (float(np.median(part)) for part in (used[third:2 * third],
                                                               used[2 * third:]))
            print(f"{EDITS} edits of seed {SEED}: resident memory {early:.0f} MiB in the second "
                  f"third, {late:.0f} in the last")
            self.assertLess(late, MEMORY_GROWTH * early)
