"""Short hand for Blender: shader node trees and meshes from arrays (the clip and the scenes share it)."""

import bpy


class Nodes:
    """Short hand for a shader node tree: `n("ShaderNodeMath", a, b, operation="ADD")` returns the first output."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def __call__(self, kind, *inputs, output=0, **settings):
        node = self.tree.nodes.new(kind)
        named = {k[1:]: v for k, v in settings.items() if k.startswith("_")}
        for key, value in settings.items():
            if not key.startswith("_"):
                setattr(node, key, value)
        for key, value in [*enumerate(inputs), *((k.replace("_", " "), v) for k, v in named.items())]:
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[key])
            elif value is not None:
                socket = node.inputs[key]
                rgba = socket.type == "RGBA" and len(value) == 3
                socket.default_value = (*value, 1.0) if rgba else value
        return node.outputs[output] if len(node.outputs) else None

    def math(self, operation, a, b=None):
        return self("ShaderNodeMath", a, b, operation=operation)

    def mix(self, factor, a, b, blend="MIX"):
        return self("ShaderNodeMixRGB", factor, a, b, blend_type=blend)

    def ramp(self, value, low, high, to_low=0.0, to_high=1.0):
        return self("ShaderNodeMapRange", value, low, high, to_low, to_high, interpolation_type="SMOOTHSTEP")

    def noise(self, vector, scale, detail=2.0):
        return self("ShaderNodeTexNoise", _Vector=vector, _Scale=scale, _Detail=detail)

    def principled(self, colour, roughness, **more):
        shader = self("ShaderNodeBsdfPrincipled", _Base_Color=colour, _Roughness=roughness, **more)
        self("ShaderNodeOutputMaterial", shader)


def material(name):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    return made, Nodes(made.node_tree)


def mesh_object(name, points, faces, materials, slots=None, smooth=False):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(map(float, p)) for p in points], [], faces)
    for each in materials:
        mesh.materials.append(each)
    if slots is not None:
        mesh.polygons.foreach_set("material_index", slots)
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(faces))
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made
