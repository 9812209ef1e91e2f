"""The texture unit of each sampler in the shaders, assigned here and nowhere else.

Samplers get their units when a program is built, so that a pass only binds its textures. OpenGL 3.3 has at least 16
units. Textures that one program samples have different units, and so have those that stay bound from pass to pass;
only full-screen passes share some, as each of them binds all that it samples.
"""

UNIT_OF = {
    # A material's maps.
    "base_map": 0,
    "metallic_roughness_map": 1,
    "normal_map": 2,
    "occlusion_map": 3,
    "emissive_map": 4,
    "cover": 4,  # of ground and composite, which have no material
    "over_sheet": 1,  # of the same
    # What surfaces look up besides.
    "shadow_maps": 5,
    "shadow_depths": 6,  # the same texture by another sampler object, which stays bound to this unit
    "ground_shadows": 7,
    "ground_map": 8,
    "sky_map": 9,
    "mirrored_shares": 14,
    "contact": 10,
    "walls": 12,
    "video": 11,
    # Full-screen passes.
    "sample_places": 12,
    "sample_normals": 13,
    "picture": 12,
    "added_light": 13,
    "removed": 14,
    "straight_from_bent": 15,
    "coarse_light": 12,
    "coarse_gone": 10,
    "outline_steps": 12,
    "ground_mean": 0,
    "silhouette": 2,
    "noisy_shadow": 12,
    "seen_shadow": 13,
    "lit_ground": 0,  # of the ground, which has no material
}
