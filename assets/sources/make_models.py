"""Makes the shipped models (wooden block, mug, lantern, bonsai, goblet) as GLB files; deterministic.

    python make_models.py [--out ../models]        needs numpy, pillow, trimesh

glTF convention: metres, y up, standing on y = 0, centred on the y axis; made of closed shells with outward faces. Each
model is one mesh with one material and one base-colour texture, but the goblet, which has three of metal and enamel.
"""

import argparse
from pathlib import Path

import numpy as np
from model_block import block
from model_goblet import goblet
from model_lantern import lantern
from model_mesh import write_glb
from model_mug import mug
from model_tree import tree

SEED = 8123


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--out", type=Path, default=Path(__file__).resolve().parents[1] / "models")
    out = ask.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    for name, make in {"cube": block, "mug": mug, "lantern": lantern, "tree": tree}.items():
        model, image, roughness = make(np.random.default_rng(SEED))
        model.save(out / f"{name}.glb", image, roughness)
    parts = goblet()
    write_glb(out / "goblet.glb", {name: model.mesh(material) for name, (model, material) in parts.items()})


if __name__ == "__main__":
    main()
