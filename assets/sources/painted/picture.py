"""A scene's picture, ray by ray at twice its size: what each ray meets, and the light that comes from there."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from painted.bodies import Convex, Floats, Masks
from painted.ground import ground_albedo
from painted.lights import direction, fall, seen_from
from painted.openness import open_disc, open_sky
from painted.scene_list import Scene

SIZE = (480, 360)
FOCAL_PX = 430.0
K = np.array([(FOCAL_PX, 0, (SIZE[0] - 1) / 2), (0, FOCAL_PX, (SIZE[1] - 1) / 2), (0, 0, 1)])
SUN_TINT, SKY_TINT = np.array([1.0, 0.97, 0.92]), np.array([0.92, 0.97, 1.05])
FROM_GROUND = 0.12  # light from below, over the sky's on level ground


@dataclass(frozen=True)
class Rays:
    """Where the n rays of a picture, four a pixel, end."""

    eye: Floats  # (n, 3)
    ways: Floats  # (n, 3) unit vectors
    distance: Floats  # (n,) to the nearest body; inf where there is none
    owner: NDArray[np.intp]  # (n,) index of that body, -1 where there is none
    face: NDArray[np.intp]  # (n,) of the body
    down: Masks  # (n,) whether the ray meets the ground

    @staticmethod
    def of(scene: Scene) -> "Rays":
        R, t = pose(*scene.eye)
        v, u = np.meshgrid(*((np.arange(2 * n) + 0.5) / 2 - 0.5 for n in SIZE[::-1]), indexing="ij")
        ways = np.column_stack([u.ravel(), v.ravel(), np.ones(u.size)]) @ np.linalg.inv(K).T @ R
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        eye = np.broadcast_to(-R.T @ t, ways.shape)
        nearest, owner = np.full(len(ways), np.inf), np.full(len(ways), -1)
        face = np.zeros(len(ways), np.intp)
        for number, body in enumerate(scene.everything):
            at, its_face = body.hit(eye, ways)
            closer = at < nearest
            nearest[closer], owner[closer], face[closer] = at[closer], number, its_face[closer]
        return Rays(eye, ways, nearest, owner, face, (owner < 0) & (ways[:, 2] < -1e-3))

    @property
    def on_ground(self) -> Floats:
        """(d, 3) where those that are `down` meet the ground."""
        eye, ways = self.eye[self.down], self.ways[self.down]
        return np.asarray(eye - eye[:, 2:] / ways[:, 2:] * ways)

    def on_body(self, number: int, normals: Floats) -> Floats:
        """(m, 3) where rays meet a body, a little outside of its faces with `normals` (m, 3)."""
        here = self.owner == number
        return np.asarray((self.eye[here] + self.distance[here, None] * self.ways[here]) + 1e-5 * normals)


def pictured(scene: Scene, rays: Rays, rng: np.random.Generator) -> NDArray[np.uint8]:
    """The picture (h, w, 3) BGR."""
    light = np.zeros((len(rays.ways), 3))
    for number in range(len(scene.everything)):
        light[rays.owner == number] = _light_of_body(scene, rays, number)
    light[rays.down] = _light_of_ground(scene, rays.on_ground, rng)
    return developed(light.reshape(2 * SIZE[1], 2 * SIZE[0], 3), rng)


def masks_of(scene: Scene, rays: Rays) -> dict[str, Masks]:
    """(h, w) each, by name: the object, clutter if there is any, and every light's shadow on the ground."""
    masks = {"object": _by_pixel((rays.owner >= 0) & (rays.owner < len(scene.bodies)))}
    if scene.clutter:
        masks["clutter"] = _by_pixel(rays.owner >= len(scene.bodies))
    for number, sun in enumerate(scene.lights):
        name = "shadow" if number == 0 else f"shadow{number + 1}"
        masks[name] = _shadow(scene.everything, sun, rays)
        if scene.clutter and number == 0:
            masks["shadow_caster"] = _shadow(scene.bodies, sun, rays)
    return masks


def _light_of_body(scene: Scene, rays: Rays, number: int) -> Floats:
    """(m, 3) linear RGB that comes from the places of a body that are seen."""
    body = scene.everything[number]
    normals = body.normals[rays.face[rays.owner == number]]
    points = rays.on_body(number, normals)
    shade = SKY_TINT * (0.5 + 0.5 * normals[:, 2:]) + FROM_GROUND * (0.5 - 0.5 * normals[:, 2:])
    for sun, (_, _, strength) in zip(scene.lights, scene.suns, strict=True):
        facing = np.maximum((normals * seen_from(points, sun)).sum(axis=1), 0) * fall(points, sun)
        clear = facing > 0
        for other in scene.everything:
            if other is not body:
                clear &= ~other.shades(points, sun)
        shade += (strength / sun[2] * facing * clear)[:, None] * SUN_TINT
    return np.array(body.albedo) * shade


def _light_of_ground(scene: Scene, points: Floats, rng: np.random.Generator) -> Floats:
    """(d, 3) linear RGB that comes from places (d, 3) of the ground."""
    falls = SKY_TINT * open_sky(points, scene.everything)[:, None]
    for sun, (_, _, strength) in zip(scene.lights, scene.suns, strict=True):
        share = open_disc(points, scene.everything, sun, math.radians(scene.sun_deg))
        falls = falls + (strength * share * fall(points, sun))[:, None] * SUN_TINT
    return np.asarray(ground_albedo(scene.ground, points, rng) * falls)


def _shadow(bodies: tuple[Convex, ...], sun: Floats, rays: Rays) -> Masks:
    whole = np.zeros(len(rays.ways), np.bool_)
    whole[rays.down] = np.any([body.shades(rays.on_ground, sun) for body in bodies], axis=0)
    return _by_pixel(whole)


def _by_pixel(which: Masks) -> Masks:
    """(h, w) pixels most of whose rays are among `which` (n,)."""
    return np.asarray(which.reshape(SIZE[1], 2, SIZE[0], 2).mean(axis=(1, 3)) > 0.5)


def pose(distance: float, pitch_deg: float, heading_deg: float) -> tuple[Floats, Floats]:
    """R and t of a camera that looks down at a place between the marker and the object, along the heading."""
    forward = direction(heading_deg, -pitch_deg)
    right = direction(heading_deg - 90, 0)
    R = np.array([right, np.cross(forward, right), forward])
    return R, -R @ (np.array([0.03, 0.02, 0.02]) - distance * forward)


def developed(light: Floats, rng: np.random.Generator) -> NDArray[np.uint8]:
    """The picture (h, w, 3) BGR of linear light at twice its size: exposed, a little blurred and noisy, as sRGB."""
    height, width = light.shape[0] // 2, light.shape[1] // 2
    light = cv2.GaussianBlur(light.astype(np.float32), (0, 0), 1.1)
    light = light.reshape(height, 2, width, 2, 3).mean(axis=(1, 3))
    light = 0.85 * light / np.percentile(light, 99)
    light = np.clip(light + rng.normal(size=light.shape) * np.sqrt(2e-5 + 1.5e-4 * np.maximum(light, 0)), 0, 1)
    encoded = np.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.ascontiguousarray((255 * encoded + 0.5).astype(np.uint8)[:, :, ::-1])
