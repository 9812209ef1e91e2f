"""A stage for render tests: one context, cameras that look at the marker, grey ground."""

import math
import pickle
from collections.abc import Callable, Iterator
from dataclasses import replace

import moderngl
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.colour import LINEAR_FROM_SRGB_8BIT
from ashe_live.core.light import Light
from ashe_live.core.transforms import direction_from_angles, project
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.errors import UserError
from ashe_live.models.material import Alpha, Material
from ashe_live.models.mesh import Mesh, Model
from ashe_live.models.placement import PlacedModel
from ashe_live.quality import FAST
from ashe_live.render.gl.offscreen import offscreen_context
from ashe_live.render.gl.preset import RenderPreset
from ashe_live.render.occlusion.occlusion import Hidden, Known
from ashe_live.render.renderer import SceneRenderer
from ashe_live.render.scene import Scene
from tests.camera_poses import looking_at
from tests.render.uniform_audit import UniformAudit, begin_audit

SIZE = (480, 360)
FOCAL_PX = 520.0
PLACED: dict[bytes, PlacedModel] = {}


class KnownByShape(Known):
    """What models hide, found once for all of one shape: of an opaque part the rest of its material hides nothing."""

    def __init__(self) -> None:
        super().__init__()
        self._by_shape: dict[bytes, Hidden] = {}

    @staticmethod
    def _shape(placed: PlacedModel) -> bytes:
        return pickle.dumps(
            [
                (part.vertices, part.normals, part.triangles, part.motion, part.material.double_sided)
                if part.material.alpha is Alpha.OPAQUE
                else part
                for part in placed.model.parts
            ]
        )

    def __contains__(self, placed: object) -> bool:
        return isinstance(placed, PlacedModel) and self._shape(placed) in self._by_shape

    def __getitem__(self, placed: PlacedModel) -> Hidden:
        return self._by_shape[self._shape(placed)]

    def __setitem__(self, placed: PlacedModel, hidden: Hidden) -> None:
        self._by_shape[self._shape(placed)] = hidden


# That takes half of the time of many tests. It is looked at anew by each renderer where a test is about it, or about
# what renderers leave behind.
HIDDEN = KnownByShape()
LOOK_ANEW = ("test_self_occlusion.py", "test_renderer.py", "test_golden.py")


@pytest.fixture(scope="session")
def ctx() -> moderngl.Context:
    try:
        return offscreen_context()
    except UserError as error:
        pytest.fail(str(error))


@pytest.fixture(scope="session", autouse=True)
def audit() -> Iterator[UniformAudit]:
    """In every test here a uniform that no shader declares, or that nobody sets, is an error."""
    with pytest.MonkeyPatch.context() as patch:
        yield begin_audit(patch)


@pytest.fixture
def make_renderer(ctx: moderngl.Context, request: pytest.FixtureRequest) -> Iterator[Callable[..., SceneRenderer]]:
    made: list[SceneRenderer] = []

    def make(preset: RenderPreset = FAST.render, size: tuple[int, int] = SIZE) -> SceneRenderer:
        made.append(SceneRenderer(ctx, preset, size, known=None if request.path.name in LOOK_ANEW else HIDDEN))
        return made[-1]

    yield make
    for renderer in made:
        renderer.release()
    assert ctx.error == "GL_NO_ERROR"


class Stage:
    """Builds what a scene needs."""

    @staticmethod
    def pose(
        azimuth_deg: float, elevation_deg: float, distance_m: float = 0.35, target: tuple[float, ...] = (0, 0, 0.02)
    ) -> np.ndarray:
        """T_cam_marker of a camera that looks at `target` from a direction of the marker frame, upright."""
        outwards = direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))
        return looking_at(target, np.array(target) + outwards * distance_m)

    @staticmethod
    def camera(size: tuple[int, int] = SIZE) -> Camera:
        return Camera.from_focal(size, FOCAL_PX)

    @staticmethod
    def tracked(image: np.ndarray | int, T_cam_marker: np.ndarray | None, camera: Camera | None = None) -> TrackedFrame:
        """A frame of one grey value, or a picture, with the marker at the given pose."""
        if isinstance(image, int):
            image = np.full((SIZE[1], SIZE[0], 3), image, dtype=np.uint8)
        camera = camera or Stage.camera((image.shape[1], image.shape[0]))
        marker = None if T_cam_marker is None else MarkerPose(T_cam_marker, np.zeros((4, 2)), 0.08, 0.0, None)
        return TrackedFrame(Frame(image, 0, 0.0), camera, marker)

    @staticmethod
    def picture(renderer: SceneRenderer, scene: Scene) -> np.ndarray:
        """(h, w, 3) BGR, as the renderer draws the scene."""
        renderer.render(scene)
        return renderer.read_bgr()

    @staticmethod
    def rgb_at(picture: np.ndarray, tracked: TrackedFrame, point: tuple[float, ...]) -> np.ndarray:
        """(3,) from 0 to 255, where a picture (h, w, 3) BGR shows a point of the marker frame."""
        ((column, row),) = np.round(project(tracked.camera, tracked.marker.T_cam_marker, [point])).astype(int)
        return picture[row, column, ::-1].astype(int)

    @staticmethod
    def placed(*parts: Mesh) -> PlacedModel:
        """Meshes that are in the marker frame already."""
        model = Model("test", parts)
        return PLACED.setdefault(pickle.dumps(parts), PlacedModel(model, model.bounds))

    @staticmethod
    def glowing_green(mesh: Mesh) -> Mesh:
        """The same mesh, which is told from the ground by its colour, and whose sides throw no light onto that."""
        return replace(
            mesh, colours=None, material=Material(base_colour=(0.0, 0.0, 0.0, 1.0), emissive=(0.0, 1.0, 0.0))
        )

    @staticmethod
    def light(azimuth_deg: float, elevation_deg: float, ratio: tuple[float, ...] | None = None) -> Light:
        direction = direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))
        return Light(direction, shadow_rgb_ratio=None if ratio is None else np.array(ratio))

    @staticmethod
    def along(picture: np.ndarray, tracked: TrackedFrame, xs: np.ndarray, y: float = 0.0) -> np.ndarray:
        """Linear brightness over the lit ground's at places (x, y, 0), between pixels interpolated."""
        points = np.column_stack([xs, np.full(len(xs), y), np.zeros(len(xs))])
        columns, rows = project(tracked.camera, tracked.marker.T_cam_marker, points).T
        grey = LINEAR_FROM_SRGB_8BIT[picture[..., 1]] / LINEAR_FROM_SRGB_8BIT[255]
        left, top = np.floor(columns).astype(int), np.floor(rows).astype(int)
        u, v = columns - left, rows - top
        upper = grey[top, left] * (1 - u) + grey[top, left + 1] * u
        lower = grey[top + 1, left] * (1 - u) + grey[top + 1, left + 1] * u
        return upper * (1 - v) + lower * v

    @staticmethod
    def noise(seed: int = 1, size: tuple[int, int] = SIZE) -> np.ndarray:
        return np.random.default_rng(seed).integers(0, 256, (size[1], size[0], 3), dtype=np.uint8)


@pytest.fixture
def stage() -> type[Stage]:
    return Stage
