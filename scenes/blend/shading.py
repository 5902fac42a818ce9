# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials and generated images of the scene scripts, from nodes that Kestrel understands.

Runs inside Blender 3.4 or newer. Colours are scene-linear RGB in 0..1; image texels are as stored.
"""

import bpy


# ---- materials -------------------------------------------------------------------------------

def new_material(name):
    """Material with an empty node tree; returns material, nodes, links and its output node."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    return material, nodes, links, nodes.new("ShaderNodeOutputMaterial")


def set_input(node, names, value):
    """Set the first of several sockets that this Blender version has."""
    for name in names:
        if name in node.inputs:
            node.inputs[name].default_value = value
            return


def image_node(nodes, image, extension="REPEAT"):
    node = nodes.new("ShaderNodeTexImage")
    node.image = image
    node.extension = extension
    node.interpolation = "Linear"
    return node


def diffuse(name, color=(0.8, 0.8, 0.8), image=None):
    """Lambertian surface (Diffuse BSDF, roughness 0)."""
    material, nodes, links, output = new_material(name)
    shader = nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*color, 1.0)
    if image:
        links.new(image_node(nodes, image).outputs["Color"], shader.inputs["Color"])
    links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    material.diffuse_color = (*color, 1.0)
    return material


def principled(name, color=(0.8, 0.8, 0.8), roughness=1.0, specular=0.0, metallic=0.0,
               image=None, alpha=False, normal_image=None):
    """Principled BSDF; `alpha` links the image's alpha, `normal_image` is a tangent-space map."""
    material, nodes, links, output = new_material(name)
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    set_input(shader, ["Base Color"], (*color, 1.0))
    set_input(shader, ["Roughness"], roughness)
    set_input(shader, ["Metallic"], metallic)
    set_input(shader, ["Specular IOR Level", "Specular"], specular)
    if image:
        texture = image_node(nodes, image)
        links.new(texture.outputs["Color"], shader.inputs["Base Color"])
        if alpha:
            links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
            use_alpha_clip(material)
    if normal_image:
        normal_image.colorspace_settings.name = "Non-Color"
        normal = nodes.new("ShaderNodeNormalMap")
        links.new(image_node(nodes, normal_image).outputs["Color"], normal.inputs["Color"])
        links.new(normal.outputs["Normal"], shader.inputs["Normal"])
    links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    material.diffuse_color = (*color, 1.0)
    return material


def use_alpha_clip(material):
    """Binary alpha with threshold 0.5 in rasterisers, where this Blender has the setting."""
    if hasattr(material, "blend_method"):
        material.blend_method = "CLIP"
        material.alpha_threshold = 0.5


def glossy_node(nodes):
    """Glossy BSDF, whose identifier changed in Blender 4.0."""
    try:
        return nodes.new("ShaderNodeBsdfGlossy")
    except RuntimeError:
        return nodes.new("ShaderNodeBsdfAnisotropic")


def mirror(name, color=(0.95, 0.95, 0.95)):
    """Perfect mirror (Glossy BSDF, roughness 0)."""
    material, nodes, links, output = new_material(name)
    shader = glossy_node(nodes)
    shader.inputs["Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = 0.0
    links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    material.diffuse_color = (*color, 1.0)
    return material


def glass(name, color=(1.0, 1.0, 1.0), ior=1.45):
    """Clear or tinted glass (Glass BSDF, roughness 0)."""
    material, nodes, links, output = new_material(name)
    shader = nodes.new("ShaderNodeBsdfGlass")
    shader.inputs["Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = 0.0
    shader.inputs["IOR"].default_value = ior
    links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    material.diffuse_color = (*color, 1.0)
    return material


def make_matte(material):
    """Make a material Principled without specular, keeping its colour, alpha and normal images.

    Images that then feed nothing (roughness, metallic) are dropped, so they are never loaded.
    """
    shader = next((n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
    if shader is None:
        return

    def source(socket_name):
        links = shader.inputs[socket_name].links
        return links[0].from_node if links else None

    color, alpha, normal = source("Base Color"), source("Alpha"), source("Normal")
    image = color.image if color and color.type == "TEX_IMAGE" else None
    alpha_image = alpha.image if alpha and alpha.type == "TEX_IMAGE" else None
    normal_image = None
    if normal and normal.type == "NORMAL_MAP" and normal.inputs["Color"].links:
        normal_image = normal.inputs["Color"].links[0].from_node.image
    name = material.name
    replacement = principled(name, tuple(shader.inputs["Base Color"].default_value)[:3],
                             image=image, alpha=alpha_image is not None, normal_image=normal_image)
    material.user_remap(replacement)
    bpy.data.materials.remove(material)
    replacement.name = name


def make_all_matte():
    """`make_matte` for every material, then drop the images that nothing uses any more."""
    for material in [m for m in bpy.data.materials if m.use_nodes]:
        make_matte(material)
    bpy.data.batch_remove([image for image in bpy.data.images if image.users == 0])


# ---- generated images ------------------------------------------------------------------------

def image_from_function(name, width, height, texel, non_color=False, is_float=False):
    """Packed image; `texel(u, v)` gives RGBA as stored, u and v in 0..1 at texel centres, v up."""
    image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    if non_color:
        image.colorspace_settings.name = "Non-Color"
    pixels = [channel for y in range(height) for x in range(width)
              for channel in texel((x + 0.5) / width, (y + 0.5) / height)]
    image.pixels.foreach_set(pixels)
    image.update()
    image.pack()
    return image
