"""The pinhole camera: intrinsics and distortion in OpenCV's model, pixel centres at integer coordinates."""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from ashe_live.core import arguments
from ashe_live.core.arrays import Float, frozen_floats, read_only_copies, set_frozen
from ashe_live.core.ranges import DISTORTION, DRAWN, FIELD_OF_VIEW, FOCAL, FOCAL_ERROR, PIXEL
from ashe_live.errors import UserError
from ashe_live.files.reading import read_json

Size = tuple[int, int]
LEAST_SKEW = 1e-6  # of the focal length: what is less comes from rounding
MOST_ASIDE = 1000.0  # focal lengths from the picture to the principal point: nearly at right angles to the view
MOST_OBLONG = 1.5  # sides of pixels, one over the other: those of wide-screen DVDs have 1.42
CameraSource = Literal["file", "flag", "exif", "assumed", "estimated"]

# What a picture's longer side spans where nothing is known of its camera: webcams, and phones held across, see 45 to
# 80 degrees there; what is upright comes from a phone: 67 degrees in photos (26 mm on 35 mm film), 60 to 65 in clips.
ASSUMED_FOV_DEG, ASSUMED_UPRIGHT_FOV_DEG = 60.0, 65.0
# Relative standard deviation of a focal length by where it comes from: a calibration with a board; a data sheet; the
# 35 mm equivalent in a photo's EXIF data; webcams and phones in general; views of a marker.
FOCAL_SIGMA: dict[CameraSource, float] = {
    "file": 0.003,
    "flag": 0.02,
    "exif": 0.03,
    "assumed": 0.25,
    "estimated": 0.08,
}
DISTORTION_LENGTHS = (4, 5, 8, 12, 14)
# Names of models whose four coefficients are no k1, k2, p1, p2, as files of other programs state them.
FOREIGN_MODELS = ("fisheye", "equidistant", "kannala")


@read_only_copies
@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """Intrinsics for frames of one size, by OpenCV's model, pixel centres at integers.

    size: width, height in pixels.
    K: (3, 3) pixels, last row 0 0 1.
    dist: (4, 5, 8, 12 or 14,) OpenCV's distortion coefficients; given also as a row or a column, as by OpenCV.
    source: where the numbers come from.
    focal_sigma_px: standard deviation of the focal length; not given, that which cameras of its `source` have.

    Raises ValueError for what no camera has by that model, which knows no skew, TypeError for what is no number or text
    where there should be one.
    """

    size: Size
    K: Float
    dist: Float
    source: CameraSource
    focal_sigma_px: float = math.nan  # not given: by FOCAL_SIGMA

    if TYPE_CHECKING:  # OpenCV's types do not say of a calibration's K and dist that they are float64

        def __init__(
            self, size: Size, K: ArrayLike, dist: ArrayLike, source: CameraSource, focal_sigma_px: float = ...
        ) -> None: ...

    def __post_init__(self) -> None:
        is_row_or_column = isinstance(self.dist, np.ndarray) and self.dist.ndim == 2 and 1 in self.dist.shape
        dist = self.dist.ravel() if is_row_or_column else self.dist
        set_frozen(self, K=frozen_floats(self.K, (3, 3), "K"), dist=frozen_floats(dist, (-1,), "dist"))
        set_frozen(self, size=arguments.picture_size(self.size, "size"))
        arguments.one_of(self.source, FOCAL_SIGMA, "source")
        if not np.array_equal(self.K[2], (0, 0, 1)):
            raise ValueError("K needs the last row 0 0 1")
        if self.K[1, 0] != 0:
            raise ValueError(f"K[1][0] is {self.K[1, 0]:g}, and must be 0")
        for name, value, allowed in (
            ("the focal length K[0][0]", self.K[0, 0], FOCAL),
            ("the focal length K[1][1]", self.K[1, 1], FOCAL),
            ("the principal point K[0][2]", self.K[0, 2], PIXEL),
            ("the principal point K[1][2]", self.K[1, 2], PIXEL),
            *((f"dist[{index}]", value, DISTORTION) for index, value in enumerate(self.dist)),
        ):
            allowed.checked(float(value), name)
        for axis, (focal_px, middle_px) in enumerate(((self.K[0, 0], self.K[0, 2]), (self.K[1, 1], self.K[1, 2]))):
            beside_px = max(-middle_px, middle_px - self.size[axis])
            if beside_px > MOST_ASIDE * focal_px:
                raise ValueError(
                    f"the principal point K[{axis}][2] is {beside_px:g} px beside the picture, and the focal length "
                    f"{focal_px:g} px: no lens looks so far aside"
                )
        if abs(self.K[0, 1]) > LEAST_SKEW * self.K[0, 0]:
            raise ValueError(f"the skew K[0][1] is {self.K[0, 1]:g} px, and OpenCV's model of cameras has none")
        if len(self.dist) not in DISTORTION_LENGTHS:
            raise ValueError(f"dist has {len(self.dist)} coefficients, not one of {DISTORTION_LENGTHS}")
        is_given = not (isinstance(self.focal_sigma_px, float) and math.isnan(self.focal_sigma_px))
        sigma_px = self.focal_sigma_px if is_given else FOCAL_SIGMA[self.source] * float(self.K[0, 0])
        set_frozen(self, focal_sigma_px=FOCAL_ERROR.checked(sigma_px, "focal_sigma_px"))

    @classmethod
    def from_focal(
        cls, size: Size, focal_px: float, source: CameraSource = "flag", focal_sigma_px: float = math.nan
    ) -> "Camera":
        """Square pixels, principal point at the image's centre, no distortion. Raises as the class does."""
        width, height = arguments.picture_size(size, "size")
        FOCAL.checked(focal_px, "focal_px")
        K = [[focal_px, 0, (width - 1) / 2], [0, focal_px, (height - 1) / 2], [0, 0, 1]]
        return cls(size, np.array(K, dtype=np.float64), np.zeros(5), source, focal_sigma_px)

    @classmethod
    def from_hfov(cls, size: Size, hfov_deg: float, source: CameraSource = "flag") -> "Camera":
        """Square pixels whose `size[0]` columns together span `hfov_deg`, otherwise as `from_focal`."""
        FIELD_OF_VIEW.checked(hfov_deg, "hfov_deg")
        width, _ = arguments.picture_size(size, "size")
        return cls.from_focal(size, width / 2 / math.tan(math.radians(hfov_deg) / 2), source)

    @classmethod
    def from_longer_side(cls, size: Size, fov_deg: float, source: CameraSource = "flag") -> "Camera":
        """As `from_hfov`, but the picture's longer side, be it a row or a column, spans `fov_deg`."""
        FIELD_OF_VIEW.checked(fov_deg, "fov_deg")
        width, height = arguments.picture_size(size, "size")
        focal_px = cls.from_hfov((max(width, height), min(width, height)), fov_deg).K[0, 0]
        return cls.from_focal(size, float(focal_px), source)

    @classmethod
    def assumed(cls, size: Size) -> "Camera":
        """A camera of which nothing is known."""
        width, height = arguments.picture_size(size, "size")
        fov_deg = ASSUMED_UPRIGHT_FOV_DEG if height > width else ASSUMED_FOV_DEG
        return cls.from_longer_side(size, fov_deg, "assumed")

    @property
    def hfov_deg(self) -> float:
        """The horizontal angle that the columns span, were the principal point central."""
        return math.degrees(2 * math.atan(self.size[0] / 2 / self.K[0, 0]))

    @property
    def is_distorted(self) -> bool:
        """Whether a coefficient of `dist` is not 0."""
        return bool(self.dist.any())

    def without_distortion(self) -> "Camera":
        """The pinhole camera with the same K: of pixels from which the distortion was taken out."""
        return replace(self, dist=np.zeros(5))

    def resized(self, size: Size) -> "Camera":
        """The same camera for frames scaled to `size`; distortion does not depend on the scale.

        Raises ValueError when the aspect ratio differs by more than rounding to whole pixels explains.
        """
        if arguments.picture_size(size, "size") == self.size:
            return self
        scales = np.divide(size, self.size)
        # Either side may be the rounded one, and the shorter one's rounding weighs more.
        differences = np.abs(scales[::-1] * self.size - size)
        if (differences > np.maximum(1.0, scales[::-1])).all():
            raise ValueError(f"{size[0]}x{size[1]} has another aspect ratio than {self.size[0]}x{self.size[1]}")
        K = self.K.copy()
        K[:2, :2] *= scales[:, None]
        K[:2, 2] = scaled_pixels(self.K[:2, 2], scales)
        return Camera(size, K, self.dist, self.source, self.focal_sigma_px * float(scales[0]))


def scaled_pixels(pixels: Float, scale: float | Float) -> Float:
    """Where pixels (..., 2) of a picture are in the same picture scaled by `scale`, or by one (2,) of each axis.

    Pixel centres are integers, so that the picture's corner at -0.5 stays where it is.
    """
    return (pixels + 0.5) * scale - 0.5


def fitted(camera: Camera, size: Size, name: str = "the camera") -> Camera:
    """`camera` for frames of another size of the same aspect ratio. Raises UserError, with that name, for any other.

    ValueError for a size that no picture may have, which no camera could mend.
    """
    arguments.picture_size(size, "the picture's size")
    try:
        return camera.resized(size)
    except ValueError as error:
        remedy = "calibrate at this aspect ratio"
        if (size[0] < size[1]) != (camera.size[0] < camera.size[1]):
            remedy = "hold the camera as it was calibrated, upright or on its side, or calibrate it as it is held now"
        raise UserError(f"{name} does not fit the picture ({error})", remedy) from error


def drawn_size(size: Size) -> Size:
    """`size`, or one of its shape that is not too large to be drawn at."""
    scale = math.sqrt(min(1.0, DRAWN.high / (size[0] * size[1])))
    return max(1, int(scale * size[0])), max(1, int(scale * size[1]))


def read_camera_file(path: str | Path) -> Camera:
    """Reads `{"size": [w, h], "K": 3x3, "dist": [...]}`; raises UserError when that is not what it holds."""
    remedy = 'it needs {"size": [width, height], "K": 3x3 numbers, "dist": [k1, k2, p1, p2, k3]}'
    path = arguments.path(path, "path")
    try:
        content = read_json(path, remedy=remedy)
        if not isinstance(content, dict):
            raise ValueError("it is no object in braces")
        _check_model(content)
        size, K, dist = content["size"], content["K"], content.get("dist") or [0.0] * 5
        if not (isinstance(size, list) and len(size) == 2):
            raise ValueError("size is not a width and a height")
        width, height = (_whole_number(value) for value in size)
        camera = Camera((width, height), _numbers(K, "K"), _numbers(dist, "dist"), "file")
        _check_lens(camera)
        return camera
    except KeyError as error:
        raise UserError(f"the camera file {path} is not a calibration: it has no {error}", remedy) from error
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise UserError(f"the camera file {path} is not a calibration ({error})", remedy) from error


def _check_model(content: dict[str, object]) -> None:
    """Raises ValueError for a file that names a model whose coefficients would be taken for others."""
    for key, value in content.items():
        name = str(value).lower()
        if "model" in key.lower() and any(foreign in name for foreign in FOREIGN_MODELS):
            raise ValueError(f"its {key} is {value!r}, and only OpenCV's model with k1, k2, p1, p2 is read")


def _check_lens(camera: Camera) -> None:
    """Raises ValueError for a camera matrix that no camera has by the model of OpenCV, by which pictures are seen."""
    (fx, _, x), (_, fy, y), _ = camera.K
    if not 1 / MOST_OBLONG <= fx / fy <= MOST_OBLONG:
        raise ValueError(f"the focal lengths {fx:g} and {fy:g} px are too unlike for the pixels of any camera")
    if not all(-0.5 * side <= at <= 1.5 * side for at, side in zip((x, y), camera.size, strict=True)):
        raise ValueError(f"the principal point ({x:g}, {y:g}) is far outside of the picture")


def _numbers(value: object, name: str) -> Float:
    try:
        return np.array(value, dtype=np.float64)
    except (ValueError, TypeError):
        raise ValueError(f"{name} is not made of numbers, in rows of one length") from None


def _whole_number(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise ValueError(f"{value!r} is not a whole number of pixels")
    return value
