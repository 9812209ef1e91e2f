"""What the demo clip shows: a paper cup and a printed marker on a sunlit wooden table (Blender, no external textures).

World = marker frame: metres, origin at the marker's centre, x right and y up as printed, z out of the table.
"""

import math

import bpy
import cv2
import numpy as np
from mathutils import Matrix
from scenes.tracing.nodes import Nodes, material, mesh_object

MARKER_DICTIONARY, MARKER_ID, MARKER_SIDE, PAPER_SIDE = "DICT_4X4_50", 0, 0.080, 0.115
TABLE_Z = -0.0002  # the paper is 0.2 mm thick, its upper side is z = 0
SUN_AZIMUTH, SUN_ELEVATION, SUN_DIAMETER = math.radians(17.0), math.radians(43.0), math.radians(0.53)
SUN_COLOUR, SUN_STRENGTH = (1.0, 0.92, 0.80), 3.6
SKY_ZENITH, SKY_HORIZON, SKY_STRENGTH = (0.20, 0.30, 0.46), (0.42, 0.45, 0.48), 0.80
CUP_XY = (-0.150, 0.092)
PLANK_WIDTH, PLANK_ANGLE = 0.165, math.radians(-11.0)
TEAL, CREAM, LID = (0.010, 0.165, 0.180), (0.80, 0.72, 0.58), (0.80, 0.79, 0.76)
# The cup's profile: (radius, height, material of the band that ends here).
CUP = [
    (0.0, 0.0040, 0),
    (0.0268, 0.0040, 0),
    (0.0275, 0.0, 0),
    (0.0290, 0.0, 0),
    (0.0294, 0.0012, 0),
    (0.0322, 0.0300, 0),
    (0.0330, 0.0302, 1),
    (0.0371, 0.0718, 1),
    (0.0363, 0.0722, 1),
    (0.0390, 0.0975, 0),
    (0.0412, 0.0980, 2),
    (0.0420, 0.0990, 2),
    (0.0420, 0.1015, 2),
    (0.0412, 0.1027, 2),
    (0.0392, 0.1032, 2),
    (0.0383, 0.1105, 2),
    (0.0375, 0.1122, 2),
    (0.0362, 0.1128, 2),
    (0.0350, 0.1120, 2),
    (0.0342, 0.1080, 2),
    (0.0330, 0.1070, 2),
    (0.0, 0.1066, 2),
]


def wood():
    """Oiled ash planks: broad figure, fine fibres, a narrow groove between boards; low contrast on purpose."""
    made, n = material("wood")
    where = n("ShaderNodeMapping", n("ShaderNodeTexCoord", output=3), _Rotation=(0, 0, PLANK_ANGLE))
    split = n("ShaderNodeSeparateXYZ", where)
    x, y = split, split.node.outputs[1]
    across = n.math("ADD", n.math("DIVIDE", y, PLANK_WIDTH), 0.36)
    board = n.math("FLOOR", across)
    random = n("ShaderNodeTexWhiteNoise", None, board, noise_dimensions="1D")
    shifted = n("ShaderNodeCombineXYZ", n.math("ADD", x, n.math("MULTIPLY", random, 9.0)), y, board)
    stretch = lambda sx, sy: n("ShaderNodeVectorMath", shifted, (sx, sy, 1.0), operation="MULTIPLY")  # noqa: E731
    figure = n.noise(stretch(1.1, 9.0), 1.6, 3.0)
    rings = n.math("SINE", n.math("MULTIPLY", figure, 62.0))
    broad = n.noise(stretch(1.0, 7.0), 3.0, 4.0)
    fibre = n.noise(stretch(9.0, 330.0), 1.0, 3.0)
    pores = n.ramp(n.noise(stretch(16.0, 520.0), 1.0, 1.0), 0.62, 0.74)
    colour = n.mix(n.ramp(broad, 0.30, 0.72), (0.40, 0.250, 0.130), (0.545, 0.370, 0.210))
    colour = n.mix(n.ramp(rings, -0.2, 1.0, 0.0, 0.34), colour, (0.33, 0.200, 0.105))
    colour = n.mix(n.ramp(fibre, 0.30, 0.70, 0.0, 0.22), colour, (0.30, 0.185, 0.10))
    colour = n.mix(n.math("MULTIPLY", pores, 0.30), colour, (0.17, 0.095, 0.05))
    colour = n("ShaderNodeHueSaturation", _Value=n.ramp(random, 0.0, 1.0, 0.90, 1.10), _Color=colour)
    edge = n.math(
        "MULTIPLY",
        n.math("SUBTRACT", 0.5, n.math("ABSOLUTE", n.math("SUBTRACT", n.math("FRACT", across), 0.5))),
        PLANK_WIDTH,
    )
    colour = n.mix(n.ramp(edge, 0.0004, 0.0014, 0.72, 0.0), colour, (0.05, 0.028, 0.015))
    height = n.math("ADD", n.ramp(edge, 0.0, 0.0032, 0.0, 0.0016), n.math("MULTIPLY", fibre, 0.00022))
    bump = n("ShaderNodeBump", _Height=height, _Strength=0.7, _Distance=1.0)
    n.principled(colour, n.ramp(fibre, 0.3, 0.7, 0.42, 0.56), _Normal=bump, _Specular_IOR_Level=0.35)
    return made


def paper():
    """The printed sheet: 640 px of marker in 920 px of paper, image up = +y."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, MARKER_DICTIONARY))
    side, total = 640, 920
    sheet = np.full((total, total), 255, np.uint8)
    margin = (total - side) // 2
    sheet[margin : margin + side, margin : margin + side] = cv2.aruco.generateImageMarker(dictionary, MARKER_ID, side)
    cv2.putText(sheet, "4x4 id 0   80 mm", (margin, total - 36), cv2.FONT_HERSHEY_SIMPLEX, 0.8, 150, 2, cv2.LINE_AA)
    reflectance = 0.030 + 0.80 * (sheet[::-1].astype(np.float32) / 255.0)  # Blender's rows run upwards
    image = bpy.data.images.new("marker", total, total, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels = np.dstack([reflectance, reflectance * 0.992, reflectance * 0.965, np.ones_like(reflectance)]).ravel()
    image.pack()
    made, n = material("paper")
    n.principled(n("ShaderNodeTexImage", image=image), 0.62, _Specular_IOR_Level=0.25)
    return made


def cup_materials():
    body, n = material("cup")
    n.principled(TEAL, 0.28, _Coat_Weight=0.35, _Coat_Roughness=0.08)
    sleeve, n = material("sleeve")
    split = n("ShaderNodeSeparateXYZ", n("ShaderNodeTexCoord", output=3))
    angle = n.math("ARCTAN2", split.node.outputs[1], split)
    ribs = n.math("SINE", n.math("MULTIPLY", angle, 74.0))
    stripe = n.ramp(n.math("ABSOLUTE", n.math("SUBTRACT", split.node.outputs[2], 0.0512)), 0.0042, 0.0045, 1.0, 0.0)
    bump = n("ShaderNodeBump", _Height=ribs, _Strength=0.35, _Distance=0.0006)
    n.principled(n.mix(stripe, CREAM, (0.62, 0.085, 0.035)), 0.75, _Normal=bump)
    lid, n = material("lid")
    n.principled(LID, 0.38, _Subsurface_Weight=0.0)
    dark, n = material("hole")
    n.principled((0.01, 0.008, 0.006), 0.6)
    return [body, sleeve, lid, dark]


def square(name, side, z, made):
    h = side / 2
    obj = mesh_object(name, [(-h, -h, z), (h, -h, z), (h, h, z), (-h, h, z)], [(0, 1, 2, 3)], [made])
    uv = obj.data.uv_layers.new()
    for corner, at in zip(uv.data, [(0, 0), (1, 0), (1, 1), (0, 1)], strict=True):
        corner.uv = at
    return obj


def cup():
    """Lathed cup; returns the object and its points in the marker frame."""
    turns = 128
    angles = np.arange(turns) * 2 * math.pi / turns
    points = [(r * math.cos(a), r * math.sin(a), z) for r, z, _ in CUP for a in angles]
    faces = [
        (i * turns + k, i * turns + (k + 1) % turns, (i + 1) * turns + (k + 1) % turns, (i + 1) * turns + k)
        for i in range(len(CUP) - 1)
        for k in range(turns)
    ]
    slots = [CUP[i + 1][2] for i in range(len(CUP) - 1) for _ in range(turns)]
    obj = mesh_object("cup", points, faces, cup_materials(), slots, smooth=True)
    obj.data.set_sharp_from_angle(angle=math.radians(38))
    obj.location = (*CUP_XY, TABLE_Z)
    hole = [(0.0045 * math.cos(a), 0.0245 + 0.0022 * math.sin(a), 0.10705) for a in angles]
    lip = mesh_object("hole", hole, [tuple(range(turns))], [bpy.data.materials["hole"]])
    lip.parent = obj
    obj.rotation_euler = (0, 0, math.radians(205))
    turn = np.array(Matrix.Rotation(math.radians(205), 3, "Z"))
    return obj, np.array(points) @ turn.T + np.array([*CUP_XY, TABLE_Z])


def sun_direction():
    c = math.cos(SUN_ELEVATION)
    return np.array([c * math.cos(SUN_AZIMUTH), c * math.sin(SUN_AZIMUTH), math.sin(SUN_ELEVATION)])


def lights():
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.color, lamp.angle = SUN_STRENGTH, SUN_COLOUR, SUN_DIAMETER
    sun = bpy.data.objects.new("sun", lamp)
    d = sun_direction()  # a sun shines along its own -z
    x = np.cross([0, 0, 1], d) / np.linalg.norm(np.cross([0, 0, 1], d))
    sun.matrix_world = Matrix(np.column_stack([x, np.cross(d, x), d]).tolist()).to_4x4()
    bpy.context.scene.collection.objects.link(sun)
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    bpy.context.scene.world = world
    n = Nodes(world.node_tree)
    direction = n("ShaderNodeTexCoord", output=0)
    up = n("ShaderNodeSeparateXYZ", direction).node.outputs[2]
    sky = n.mix(n.ramp(up, 0.0, 0.75), SKY_HORIZON, SKY_ZENITH)
    cloud = n.ramp(n.noise(direction, 2.2, 4.0), 0.48, 0.70, 0.0, 0.7)
    sky = n.mix(cloud, sky, (0.55, 0.56, 0.58))
    n("ShaderNodeOutputWorld", n("ShaderNodeBackground", sky, SKY_STRENGTH))
