from pathlib import Path

import numpy as np
import pytest

from ashe_live.errors import UserError
from ashe_live.models.catalogue import load_model, model_names
from ashe_live.models.placement import placed_on_marker


def test_cube_comes_first() -> None:
    names = model_names()
    assert names[0] == "cube"
    assert len(names) >= 4
    assert list(names[1:]) == sorted(names[1:])


@pytest.mark.parametrize("name", model_names())
def test_shipped_model_is_light_and_stands_upright(name: str) -> None:
    model = load_model(name)
    assert model.name == name
    assert 0 < model.triangle_count <= 20_000
    assert all(np.allclose(np.linalg.norm(part.normals, axis=1), 1, atol=1e-3) for part in model.parts)
    lower, upper = placed_on_marker(model, 0.08).bounds
    assert lower[2] == 0
    assert upper[2] > 0.03  # none lies on its side


def test_path_is_loaded_and_unknown_name_answered_with_the_choice(tmp_path: Path) -> None:
    (tmp_path / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert load_model(str(tmp_path / "t.obj")).triangle_count == 1
    with pytest.raises(UserError, match="choose one of cube"):
        load_model("teapot")
    with pytest.raises(UserError, match="there is no file"):
        load_model("teapot.glb")
