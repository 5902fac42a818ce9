# SPDX-License-Identifier: GPL-3.0-or-later
"""Every node that is supported, beside Cycles: what it gives shines from a surface."""

import unittest

import bpy
import numpy as np
from kestrel.sync.material import read_material
from mathutils import Matrix
from support import SceneTest, image, new_material, turned

TOLERANCE = 2.0 / 255.0
SHARE = 0.99  # of the pixels, as edges may fall on either side


def input_of(node, key):
    """An input by its name or place; also one that these settings of the node do without."""
    return node.inputs[key] if isinstance(key, int) else next(
        socket for socket in node.inputs if socket.name == key)


def set_input(node, key, value):
    socket = input_of(node, key)
    if hasattr(socket.default_value, "__len__") and len(socket.default_value) == 4:
        value = (*value[:3], 1.0)
    socket.default_value = value


class Graph:
    """A material that shines with what `show()` is given."""

    def __init__(self, name="Node"):
        self.material, self.tree, self.output = new_material(name)

    def node(self, kind, inputs=(), **settings):
        """A node; `inputs`: {name or place: value or socket}."""
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for key, value in settings.items():
            setattr(node, key, value)
        for key, value in dict(inputs).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, input_of(node, key))
            else:
                set_input(node, key, value)
        return node

    def coordinates(self, output="Generated"):
        return self.node("TexCoord").outputs[output]

    def math(self, operation, a, b=0.0, c=0.0):
        return self.node("Math", {0: a, 1: b, 2: c}, operation=operation).outputs[0]

    def vectors(self, operation, a, b=(0, 0, 0), c=(0, 0, 0)):
        return self.node("VectorMath", {0: a, 1: b, 2: c}, operation=operation).outputs["Vector"]

    def varied(self, scale=(1, 1, 1), offset=(0, 0, 0.4), coordinates="Generated"):
        """A vector that varies over the surface."""
        return self.vectors("MULTIPLY_ADD", self.coordinates(coordinates), scale, offset)

    def numbers(self):
        """Three numbers between -2 and 2 that vary over the surface, and among them whole ones."""
        parts = self.node("SeparateXYZ", {0: self.coordinates()})
        first, second = (self.math("MULTIPLY_ADD", parts.outputs[i], 4.0, -2.0) for i in (0, 1))
        return first, second, self.math("MULTIPLY", first, second)

    def show(self, socket, scale=0.5, offset=0.5):
        """Let the surface shine with scale * socket + offset."""
        scaled = self.vectors("MULTIPLY_ADD", socket, (scale,) * 3, (offset,) * 3)
        emission = self.node("Emission", {"Color": scaled})
        self.tree.links.new(emission.outputs[0], self.output.inputs["Surface"])
        return self


def enum(node_kind, name):
    """The choices of a node's property."""
    return [item.identifier for item in
            getattr(bpy.types, f"ShaderNode{node_kind}").bl_rna.properties[name].enum_items]


def exists(kind):
    return hasattr(bpy.types, f"ShaderNode{kind}")


class NodeTest(SceneTest):
    size = (64, 64)

    def setUp(self):
        super().setUp()
        self.camera((0.1, -0.2, 6), ortho_scale=2.0)
        self.scene.kestrel.pixel_filter = "box"
        self.scene.kestrel.filter_width = 0.1
        self.scene.cycles.filter_width = 0.01
        self.scene.view_settings.view_transform = "Standard"
        self.surface = self.plane("Surface", 2.1, matrix=turned(20, "Z") @ Matrix.Translation(
            (0.03, 0.02, 0.1)))

    def rounded(self):
        """Show things on a ball in place of the plane."""
        bpy.data.objects.remove(self.surface)
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.95)
        self.surface = bpy.context.object
        bpy.ops.object.shade_smooth()
        self.surface.matrix_world = turned(30, "X") @ turned(15, "Y") @ Matrix.Diagonal(
            (1.0, 0.9, 0.8, 1.0))

    def pictures(self, material):
        slots = self.surface.data.materials
        slots.clear()
        slots.append(material)
        return self.render()[..., :3], self.render_cycles(1)[..., :3]

    def same(self, graph, tolerance=TOLERANCE, share=SHARE):
        ours, theirs = (np.clip(p, 0, 1) for p in self.pictures(graph.material))
        close = (np.abs(ours - theirs) <= tolerance).all(axis=-1).mean()
        worst = np.abs(ours - theirs).max()
        self.assertGreaterEqual(close, share, f"the worst is {worst:.4f}, means are "
                                f"{ours.mean((0, 1))} and {theirs.mean((0, 1))}")

    def each(self, cases, build, **limits):
        """One picture for each case: build(graph, case) gives what is shown."""
        for case in cases:
            with self.subTest(case=case):
                graph = Graph()
                shown = build(graph, case)
                self.same(graph.show(*shown) if isinstance(shown, tuple) else graph.show(shown),
                          **limits)
                self.noted(graph.material)

    def noted(self, material):
        """What is reported of a material: nothing, if all of it is supported."""
        notes = []
        read_material(material, 1.0, notes.append)
        self.assertEqual([str(note) for note in notes], [])


class ConverterTest(NodeTest):
    def test_math(self):
        self.each([(operation, clamp) for operation in enum("Math", "operation")
                   for clamp in (False, True)],
                  lambda graph, case: graph.node("Math", dict(enumerate(graph.numbers())),
                                                 operation=case[0], use_clamp=case[1]).outputs[0])

    def test_vector_math(self):
        def build(graph, operation):
            x, y, z = graph.numbers()
            a = graph.node("CombineXYZ", {0: x, 1: y, 2: z}).outputs[0]
            b = graph.varied((-1, 2, 1), (1.5, -0.7, 0.3))
            node = graph.node("VectorMath", {0: a, 1: b, 2: (0.3, 0.8, 0.5)}, operation=operation)
            if operation in ("SCALE", "REFRACT"):
                node.inputs["Scale"].default_value = 0.7
            return next(o for o in node.outputs if o.enabled)
        self.each(enum("VectorMath", "operation"), build)

    def test_map_range(self):
        def build(graph, case):
            kind, interpolation, clamp = case
            node = graph.node("MapRange", interpolation_type=interpolation, clamp=clamp,
                              data_type=kind)
            vector = kind == "FLOAT_VECTOR"
            values = {"From Min": -0.5, "From Max": 1.3, "To Min": 0.9, "To Max": -0.8,
                      "Steps": 3.0}
            for socket in node.inputs:
                if socket.enabled and socket.name in values:
                    value = values[socket.name]
                    socket.default_value = (value, value + 0.1, value - 0.1) if vector else value
            graph.tree.links.new(graph.numbers()[0], node.inputs["Vector" if vector else "Value"])
            return next(o for o in node.outputs if o.enabled)
        self.each([(kind, interpolation, clamp) for kind in ("FLOAT", "FLOAT_VECTOR")
                   for interpolation in enum("MapRange", "interpolation_type")
                   for clamp in (False, True)], build)

    def test_clamp(self):
        self.each(("MINMAX", "RANGE"), lambda graph, kind: graph.node(
            "Clamp", {0: graph.numbers()[0], 1: 0.6, 2: -0.7}, clamp_type=kind).outputs[0])

    def test_color_ramp(self):
        def build(graph, case):
            interpolation, mode, output = case
            node = graph.node("ValToRGB", {0: graph.math("MULTIPLY", graph.numbers()[0], 0.6)})
            ramp = node.color_ramp
            ramp.color_mode, ramp.interpolation = mode, interpolation
            ramp.elements.new(0.4).color = (0.9, 0.2, 0.1, 0.3)
            ramp.elements[0].color = (0.1, 0.4, 0.9, 1.0)
            ramp.elements[0].position = 0.1
            return node.outputs[output]
        self.each([(kind, "RGB", output) for kind in ("LINEAR", "CONSTANT", "EASE", "B_SPLINE")
                   for output in ("Color", "Alpha")] + [("LINEAR", "HSV", "Color")], build)

    def test_separate_and_combine(self):
        def build(graph, mode):
            color = graph.varied((0.9, 0.8, 1), (0.05, 0.1, 0.4))
            parts = graph.node("SeparateColor", {0: color}, mode=mode)
            third = graph.math("MULTIPLY", parts.outputs[2], 0.8)
            return graph.node("CombineColor", {0: parts.outputs[1], 1: parts.outputs[0], 2: third},
                              mode=mode).outputs[0]
        self.each(("RGB", "HSV", "HSL"), build)

    def test_conversions_between_sockets(self):
        def build(graph, case):
            if case == "color to number":
                color = graph.node("MixRGB", {0: 0.5, 1: graph.varied(), 2: (0.9, 0.1, 0.2)})
                return graph.math("ADD", color.outputs[0], 0.0)
            if case == "vector to number":
                return graph.math("ADD", graph.varied(), 0.0)
            if case == "grey":
                return graph.node("RGBToBW", {0: graph.varied()}).outputs[0]
            return graph.numbers()[0]
        self.each(("color to number", "vector to number", "grey", "number to vector"), build)

    def test_blackbody_and_wavelength(self):
        def build(graph, kind):
            low, high = (800.0, 12000.0) if kind == "Blackbody" else (380.0, 400.0)
            value = graph.math("MULTIPLY_ADD", graph.node(
                "SeparateXYZ", {0: graph.coordinates()}).outputs[0], high, low)
            return graph.node(kind, {0: value}).outputs[0], 0.2, 0.0
        self.each(("Blackbody", "Wavelength"), build)


class ColorTest(NodeTest):
    def colors(self, graph):
        return graph.varied((0.9, 0.8, 1), (0.05, 0.1, 0.4)), graph.varied((-0.7, 0.5, 1),
                                                                           (0.8, 0.2, 0.6))

    def test_mix_colors(self):
        def build(graph, case):
            blend, clamp = case
            node = graph.node("Mix", data_type="RGBA", blend_type=blend, clamp_result=clamp)
            sockets = {s.identifier: s for s in node.inputs}
            a, b = self.colors(graph)
            factor = graph.math("MULTIPLY", graph.numbers()[1], 0.7)
            for name, socket in (("Factor_Float", factor), ("A_Color", a), ("B_Color", b)):
                graph.tree.links.new(socket, sockets[name])
            return next(o for o in node.outputs if o.enabled)
        self.each([(blend, clamp) for blend in enum("Mix", "blend_type")
                   for clamp in (False, True)], build)

    def test_mix_numbers_and_vectors(self):
        def build(graph, case):
            kind, mode, clamp = case
            node = graph.node("Mix", data_type=kind, factor_mode=mode, clamp_factor=clamp)
            sockets = {s.identifier: s for s in node.inputs}
            name = "Vector" if kind == "VECTOR" else "Float"
            factor = "Factor_Vector" if mode == "NON_UNIFORM" and name == "Vector" else (
                "Factor_Float")
            a, b = self.colors(graph)
            for key, socket in ((factor, graph.varied((2, 2, 1), (-0.5, -0.5, 0.3))),
                                (f"A_{name}", a), (f"B_{name}", b)):
                graph.tree.links.new(socket, sockets[key])
            return next(o for o in node.outputs if o.enabled)
        self.each([(kind, mode, clamp) for kind in ("FLOAT", "VECTOR")
                   for mode in ("UNIFORM", "NON_UNIFORM") for clamp in (False, True)], build)

    def test_adjustments(self):
        def build(graph, case):
            kind, inputs = case
            return graph.node(kind, {"Color": self.colors(graph)[0], **inputs}).outputs[0]
        self.each([("Invert", {0: 0.7}), ("HueSaturation", {0: 0.7, 1: 1.4, 2: 0.9, 3: 0.8}),
                   ("BrightContrast", {1: 0.1, 2: 0.4}), ("Gamma", {1: 1.7})], build)

    def test_curves(self):
        def curve(mapping, index, points):
            line = mapping.curves[index]
            line.points[0].location, line.points[-1].location = points[0], points[-1]
            for point in points[1:-1]:
                line.points.new(*point)

        def build(graph, case):
            kind, extend = case
            a, _ = self.colors(graph)
            node = graph.node(kind)
            mapping = node.mapping
            mapping.extend = extend
            curve(mapping, 0, ((0.1, 0.2), (0.5, 0.9), (0.8, 0.6)))
            if kind == "RGBCurve":
                curve(mapping, 2, ((0.0, 0.9), (1.0, 0.1)))
                curve(mapping, 3, ((0.0, 0.0), (0.4, 0.6), (1.0, 1.0)))
            mapping.update()
            node.inputs[0].default_value = 0.9
            graph.tree.links.new(a if kind != "FloatCurve" else graph.numbers()[0], node.inputs[1])
            return node.outputs[0]
        self.each([(kind, extend) for kind in ("RGBCurve", "VectorCurve", "FloatCurve")
                   for extend in ("EXTRAPOLATED", "HORIZONTAL")], build)


class VectorTest(NodeTest):
    def test_mapping(self):
        self.each(enum("Mapping", "vector_type"), lambda graph, kind: graph.node("Mapping", {
            "Vector": graph.varied(), "Location": (0.2, -0.1, 0.4), "Rotation": (0.3, 0.8, -0.5),
            "Scale": (1.5, 0.6, -0.8)}, vector_type=kind).outputs[0])

    def test_vector_rotate(self):
        self.each([(kind, invert) for kind in enum("VectorRotate", "rotation_type")
                   for invert in (False, True)],
                  lambda graph, case: graph.node("VectorRotate", {
                      "Vector": graph.varied(), "Center": (0.2, 0.1, 0.0), "Axis": (0.3, 0.8, 0.4),
                      "Angle": 0.9, "Rotation": (0.3, 0.8, -0.5)}, rotation_type=case[0],
                      invert=case[1]).outputs[0])

    def test_vector_transform(self):
        self.rounded()
        spaces = ("WORLD", "OBJECT", "CAMERA")
        self.each([(kind, a, b) for kind in ("VECTOR", "POINT", "NORMAL") for a in spaces
                   for b in spaces if a != b],
                  lambda graph, case: (graph.node("VectorTransform", {0: graph.varied(
                      (1, 0.7, 0.5), (0, 0.2, 0.4))}, vector_type=case[0], convert_from=case[1],
                      convert_to=case[2]).outputs[0], 0.15, 0.5))

    def test_normal_node(self):
        def build(graph, output):
            node = graph.node("Normal", {0: graph.varied()})
            node.outputs["Normal"].default_value = (0.48, 0.6, 0.64)
            return node.outputs[output]
        self.each(("Normal", "Dot"), build)

    def normal_map_color(self, graph):
        return graph.varied((0.6, 0.6, 0), (0.2, 0.2, 0.8), "UV")

    def test_normal_map(self):
        """Tangents are made from the UVs in another way than Cycles': up to 0.02 apart."""
        self.rounded()
        self.each(enum("NormalMap", "space"), lambda graph, space: graph.node("NormalMap", {
            "Color": self.normal_map_color(graph), "Strength": 0.8}, space=space).outputs[0],
            tolerance=5 / 255, share=0.98)

    def test_bump(self):
        """The size of the step to the sides differs; the slopes of smooth heights do not."""
        self.rounded()

        def build(graph, case):
            source, invert = case
            vector = graph.varied((9, 7, 8), (0, 0, 0), source)
            parts = graph.node("SeparateXYZ", {0: vector})
            height = graph.math("SINE", graph.math("ADD", parts.outputs[0], parts.outputs[1]))
            return graph.node("Bump", {"Height": height, "Strength": 0.7, "Distance": 0.05},
                              invert=invert).outputs[0]
        self.each([(source, invert) for source in ("UV", "Object", "Generated")
                   for invert in (False, True)], build, tolerance=6 / 255, share=0.92)

    def test_displacement_bends_normals(self):
        self.rounded()
        graph = Graph()
        parts = graph.node("SeparateXYZ", {0: graph.varied((9, 7, 8), (0, 0, 0), "Object")})
        node = graph.node("Displacement", {"Height": graph.math("SINE", parts.outputs[0]),
                                           "Scale": 0.03})
        graph.tree.links.new(node.outputs[0], graph.output.inputs["Displacement"])
        graph.show(graph.node("NewGeometry").outputs["Normal"])
        self.same(graph, 6 / 255, 0.95)


class InputTest(NodeTest):
    def test_texture_coordinates(self):
        for rounded in (False, True):
            if rounded:
                self.rounded()
            self.each([o.name for o in Graph().node("TexCoord").outputs],
                      lambda graph, name: graph.coordinates(name))

    def test_coordinates_of_another_object(self):
        other = self.link("Other", None, turned(40, "X") @ Matrix.Translation((0.3, 0.1, 0.2)))

        def build(graph, _case):
            return graph.node("TexCoord", object=other).outputs["Object"]
        bpy.context.view_layer.update()
        self.each(("Object",), build)

    def test_geometry(self):
        self.rounded()
        self.each(("Position", "Normal", "Tangent", "True Normal", "Incoming", "Backfacing"),
                  lambda graph, name: graph.node("NewGeometry").outputs[name])

    def test_tangent(self):
        self.rounded()
        self.each([("RADIAL", axis) for axis in "XYZ"] + [("UV_MAP", "Z")],
                  lambda graph, case: graph.node("Tangent", direction_type=case[0],
                                                 axis=case[1]).outputs[0])

    def test_angles(self):
        self.rounded()
        self.each([("LayerWeight", 0, 0), ("LayerWeight", 0, 1), ("Fresnel", 1, 0)],
                  lambda graph, case: graph.node(case[0], {0: 0.3 + case[1]}).outputs[case[2]])

    def test_object_info(self):
        self.surface.pass_index = 3
        self.surface.location.x += 0.2

        def build(graph, name):
            graph.material.pass_index = 2
            return graph.node("ObjectInfo").outputs[name], 0.2, 0.1
        self.each(("Location", "Object Index", "Material Index"), build)

    def test_random_differs_by_object(self):
        graph = Graph()
        graph.show(graph.node("ObjectInfo").outputs["Random"], 1.0, 0.0)
        first = self.pictures(graph.material)[0].mean()
        self.surface.name = "Another"
        second = self.render()[..., :3].mean()
        self.assertNotAlmostEqual(float(first), float(second), 3)

    def test_camera_data(self):
        self.scene.camera.data.type = "PERSP"
        self.each(("View Vector", "View Z Depth", "View Distance"),
                  lambda graph, name: (graph.node("CameraData").outputs[name], 0.1, 0.1))

    def test_light_path(self):
        self.each(("Is Camera Ray", "Is Shadow Ray", "Is Diffuse Ray", "Is Glossy Ray",
                   "Is Reflection Ray", "Is Transmission Ray", "Ray Depth"),
                  lambda graph, name: graph.node("LightPath").outputs[name])

    def test_attributes(self):
        mesh = self.surface.data
        layer = mesh.uv_layers.new(name="Second")
        layer.data.foreach_set("uv", [0.1, 0.2, 0.9, 0.1, 0.8, 0.9, 0.3, 0.7])
        colors = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "CORNER")
        for item, color in zip(colors.data, ((1, 0, 0), (0, 1, 0), (0.2, 0.3, 1), (1, 1, 0))):
            item.color = (*color, 1.0)
        mesh.attributes.new("Height", "FLOAT", "POINT").data.foreach_set(
            "value", (0.1, 0.5, 0.9, 0.3))
        self.each((("UVMap", "uv_map", "Second", 0), ("VertexColor", "layer_name", "Paint", 0),
                   ("Attribute", "attribute_name", "Paint", 0),
                   ("Attribute", "attribute_name", "Paint", 1),
                   ("Attribute", "attribute_name", "Paint", 2),
                   ("Attribute", "attribute_name", "Height", 2),
                   ("Attribute", "attribute_name", "Second", 1)),
                  lambda graph, case: graph.node(case[0], **{case[1]: case[2]}).outputs[case[3]])


class ImageTest(NodeTest):
    def setUp(self):
        super().setUp()
        self.pixels = np.random.default_rng(1).random((8, 16, 4)).astype(np.float32)
        self.pixels[..., 3] = 0.25 + 0.75 * self.pixels[..., 3]

    def picture(self):
        return image("Noise", self.pixels, non_color=True)

    def test_extensions_and_interpolations(self):
        picture = self.picture()
        self.each([(extension, interpolation, output)
                   for extension in enum("TexImage", "extension")
                   for interpolation in ("Linear", "Closest") for output in ("Color", "Alpha")],
                  lambda graph, case: (graph.node(
                      "TexImage", {"Vector": graph.varied((2.7, 3.1, 1), (-0.9, -1.2, 0), "UV")},
                      image=picture, extension=case[0], interpolation=case[1]).outputs[case[2]],
                      1.0, 0.0), share=0.97)

    def test_projections(self):
        self.rounded()
        self.pixels[..., 3] = 1.0
        picture = self.picture()

        def build(graph, case):
            projection, blend = case
            return graph.node("TexImage", {"Vector": graph.coordinates()}, image=picture,
                              projection=projection, projection_blend=blend).outputs[0], 1.0, 0.0
        self.each([("FLAT", 0.0), ("BOX", 0.0), ("BOX", 0.4), ("SPHERE", 0.0), ("TUBE", 0.0)],
                  build, share=0.97)

    def test_environment_texture(self):
        self.rounded()
        self.pixels[..., 3] = 1.0
        picture = self.picture()
        self.each(enum("TexEnvironment", "projection"), lambda graph, projection: (graph.node(
            "TexEnvironment", {"Vector": graph.coordinates("Normal")}, image=picture,
            projection=projection).outputs[0], 1.0, 0.0), share=0.97)


class PatternTest(NodeTest):
    """Procedural textures."""

    def textures(self, kind, cases, build=None, **limits):
        """Pictures of a texture over the plane; cases: (settings, inputs, output)."""
        def made(graph, case):
            settings, inputs, output = case
            return graph.node(kind, {"Vector": graph.varied((1, 1.3, 1)), **inputs},
                              **settings).outputs[output]
        self.each(cases, build or made, **limits)

    def test_checker(self):
        self.textures("TexChecker", [({}, {"Scale": 4.3, "Color1": (0.9, 0.1, 0.3)}, output)
                                     for output in ("Color", "Fac")])

    def test_gradient(self):
        self.textures("TexGradient", [({"gradient_type": kind}, {}, "Fac")
                                      for kind in enum("TexGradient", "gradient_type")])

    def test_magic(self):
        self.textures("TexMagic", [({"turbulence_depth": depth}, {"Scale": 3.0, "Distortion": 1.5},
                                    output) for depth in (0, 2, 5, 10)
                                   for output in ("Color", "Fac")])

    def test_wave(self):
        inputs = {"Scale": 3.0, "Distortion": 1.5, "Detail": 2.5, "Detail Scale": 1.2,
                  "Detail Roughness": 0.6, "Phase Offset": 0.4}
        self.textures("TexWave", [
            ({"wave_type": kind, f"{kind.lower()}_direction": direction, "wave_profile": profile},
             inputs, "Fac") for kind in ("BANDS", "RINGS")
            for direction in enum("TexWave", f"{kind.lower()}_direction")
            for profile in enum("TexWave", "wave_profile")])

    def test_brick(self):
        self.textures("TexBrick", [({"offset": 0.4, "offset_frequency": 3, "squash": 1.3,
                                     "squash_frequency": 2},
                                    {"Scale": 4.0, "Color1": (0.9, 0.2, 0.1), "Bias": 0.2,
                                     "Color2": (0.2, 0.3, 0.9), "Mortar": (0.1, 0.6, 0.1),
                                     "Mortar Smooth": 0.3, "Mortar Size": 0.04}, output)
                                   for output in ("Color", "Fac")])

    def test_white_noise(self):
        """Of whole numbers: what differs in the last bit is another number."""
        def build(graph, case):
            dimensions, output = case
            cells = graph.vectors("FLOOR", graph.varied((5, 6, 1)))
            number = graph.math("FLOOR", graph.math("MULTIPLY", graph.numbers()[0], 3.0))
            node = graph.node("TexWhiteNoise", noise_dimensions=dimensions)
            for socket, source in ((input_of(node, "Vector"), cells),
                                   (input_of(node, "W"), number)):
                graph.tree.links.new(source, socket)
            return node.outputs[output]
        self.each([(d, o) for d in enum("TexWhiteNoise", "noise_dimensions")
                   for o in ("Value", "Color")], build)

    def test_noise(self):
        inputs = {"Scale": 4.0, "Detail": 3.5, "Roughness": 0.6, "Distortion": 0.4}
        kinds = enum("TexNoise", "noise_type") if hasattr(
            bpy.types.ShaderNodeTexNoise, "noise_type") else [None]
        self.textures("TexNoise", [
            ({"noise_dimensions": d, **({"noise_type": kind} if kind else {})},
             {**inputs, "W": 0.7}, output) for d in enum("TexNoise", "noise_dimensions")
            for kind in kinds for output in ("Fac", "Color")])

    @unittest.skipUnless(exists("TexMusgrave"), "Musgrave is a kind of Noise from 4.1 on")
    def test_musgrave(self):
        self.textures("TexMusgrave", [
            ({"musgrave_dimensions": d, "musgrave_type": kind},
             {"Scale": 3.0, "Detail": 3.5, "Dimension": 0.8, "Lacunarity": 2.1, "W": 0.7,
              "Offset": 0.3, "Gain": 1.2}, "Fac")
            for d in enum("TexMusgrave", "musgrave_dimensions")
            for kind in enum("TexMusgrave", "musgrave_type")])

    def test_voronoi(self):
        inputs = {"Scale": 4.0, "Randomness": 0.9, "W": 0.7}

        def outputs(feature):
            if feature == "DISTANCE_TO_EDGE":
                return ("Distance",)
            return ("Radius",) if feature == "N_SPHERE_RADIUS" else ("Distance", "Color")
        cases = [({"voronoi_dimensions": d, "feature": feature}, {**inputs, "Smoothness": 0.6},
                  output) for d in enum("TexVoronoi", "voronoi_dimensions")
                 for feature in enum("TexVoronoi", "feature") for output in outputs(feature)]
        cases += [({"distance": distance}, {**inputs, "Exponent": 0.7}, output)
                  for distance in enum("TexVoronoi", "distance")
                  for output in ("Distance", "Color", "Position")]
        self.textures("TexVoronoi", cases)
