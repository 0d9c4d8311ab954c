"""Materials: ids, albedo and normals as passes, and a diffuse surface while the G-buffer renders."""

import os

import bpy

from .fault import Fault, warn
from .geometry import CURVATURE
from .principled import PRESET, Surface

# Passes of materials ("AOVs") by name, and whether they are colours or single values.
AOVS = (("NShading", "COLOR"), ("NGeom", "COLOR"), ("Albedo", "COLOR"), ("Curvature", "VALUE"),
        ("Roughness", "VALUE"), ("ScatterWeight", "VALUE"))

# Shaders whose colour is the albedo, and the name of that input.
COLOURS = {"BSDF_PRINCIPLED": "Base Color", "BSDF_DIFFUSE": "Color", "SUBSURFACE_SCATTERING": "Color",
           "BSDF_GLOSSY": "Color", "BSDF_TOON": "Color", "BSDF_VELVET": "Color",
           "EEVEE_SPECULAR": "Base Color"}


def files(image):
    path = bpy.path.abspath(image.filepath, library=image.library)
    return [path.replace("<UDIM>", str(tile.number)) for tile in image.tiles]


def prepare(things):
    """Gives each material its passes. Returns (id, material, Surface) for each that is to be shaded.

    Ids are the materials' own pass indices; if none has one, they are numbered from 1 in the order of their
    names. A material whose index is 0 while others have one is left alone, as background is."""
    skin = None
    for thing in things:
        if not thing.data.materials:
            thing.data.materials.append(None)
        for i, material in enumerate(thing.data.materials):
            if material is None:
                if skin is None:
                    skin = bpy.data.materials.new("Skin")
                    skin.diffuse_color = (0.72, 0.49, 0.39, 1)
                    skin.use_nodes = True
                    skin.node_tree.nodes.clear()  # Blender 5 has put a grey shader there
                    skin[PRESET] = "skin"
                thing.data.materials[i] = skin
    missing = [i.name for i in bpy.data.images if i.users and i.source in ("FILE", "TILED")
               and not i.packed_files and not any(map(os.path.isfile, files(i)))]
    if missing:
        warn("images whose files are missing, which are pink: " + ", ".join(missing))
    used = sorted({m for thing in things for m in thing.data.materials}, key=lambda m: m.name)
    if not any(m.pass_index for m in used):
        for i, material in enumerate(used):
            material.pass_index = i + 1
    chosen, surfaces = {}, {}
    for material in used:
        if material.pass_index > 255:
            raise Fault(f"material '{material.name}': pass index {material.pass_index}; 1 to 255 are "
                        f"possible, 0 leaves it alone")
        if material.pass_index:
            chosen.setdefault(material.pass_index, material)
        surfaces[material] = add_passes(material)
    return [(id_, material, surfaces[material]) for id_, material in sorted(chosen.items())]


def first_shader(socket):
    """The first shader of a surface that has a colour; of a mix, the first side is searched first."""
    for link in socket.links:
        node = link.from_node
        if node.type in COLOURS:
            return node
        for inner in node.inputs:
            if inner.type == "SHADER":
                found = first_shader(inner)
                if found:
                    return found
    return None


def source(socket):
    """The socket that feeds this socket, or None."""
    return socket.links[0].from_socket if socket and socket.is_linked else None


def add_passes(material):
    """Replaces the material's shader by the shader of the G-buffer; returns the original as a Surface."""
    flat = tuple(material.diffuse_color)
    if not material.use_nodes:
        material.use_nodes = True
        material.node_tree.nodes.clear()
    tree = material.node_tree
    output = tree.get_output_node("CYCLES") or tree.nodes.new("ShaderNodeOutputMaterial")
    shader = first_shader(output.inputs["Surface"])
    colour = normal = None
    surface = Surface(material, shader)
    if shader:
        socket = shader.inputs[COLOURS[shader.type]]
        colour, flat = source(socket), tuple(socket.default_value)
        normal = source(shader.inputs.get("Normal"))
    elif output.inputs["Surface"].is_linked:
        warn(f"material '{material.name}': no shader with a colour was found in it; its viewport colour is "
             f"taken as albedo")
    tint = surface.scattering and surface.scattering.tint
    if tint:
        mix = tree.nodes.new("ShaderNodeMixRGB")
        mix.inputs["Fac"].default_value = tint[1]
        mix.inputs["Color1"].default_value = flat
        mix.inputs["Color2"].default_value = tint[0]
        if colour:
            tree.links.new(colour, mix.inputs["Color1"])
        colour = mix.outputs["Color"]
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = flat
    if colour:
        tree.links.new(colour, diffuse.inputs["Color"])
    if normal:
        tree.links.new(normal, diffuse.inputs["Normal"])
    tree.links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    for inner in ("Volume", "Displacement"):
        for link in list(output.inputs[inner].links):
            tree.links.remove(link)
    curvature = tree.nodes.new("ShaderNodeAttribute")
    curvature.attribute_name = CURVATURE
    width = None
    if surface.roughness:  # of GGX: its square
        power = tree.nodes.new("ShaderNodeMath")
        power.operation = "POWER"
        power.inputs[1].default_value = 2
        tree.links.new(surface.roughness, power.inputs[0])
        width = power.outputs[0]
    feeds = {"NShading": normal or geometry.outputs["Normal"], "NGeom": geometry.outputs["Normal"],
             "Albedo": colour,
             "Curvature": curvature.outputs["Fac"], "Roughness": width, "ScatterWeight": surface.weight}
    values = {"Albedo": flat, "Roughness": 1.0,
              "ScatterWeight": surface.scattering.weight if surface.scattering else 1.0}
    for name, kind in AOVS:
        node = tree.nodes.new("ShaderNodeOutputAOV")
        node.name = name
        if hasattr(node, "aov_name"):  # Blender 4.1; before it, the pass has the node's name
            node.aov_name = name
        socket = node.inputs["Color" if kind == "COLOR" else "Value"]
        if feeds[name]:
            tree.links.new(feeds[name], socket)
        else:
            socket.default_value = values[name]
    return surface
