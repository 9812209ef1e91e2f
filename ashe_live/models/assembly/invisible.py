"""Detects models of which nothing is seen, as every surface lets all light through or is cut out whole."""

from collections.abc import Sequence

from ashe_live.models.material import Alpha
from ashe_live.models.mesh import Mesh

WORDS = "nothing of it is seen, as all its materials are wholly transparent: export it with opaque ones"


def nothing_is_seen(parts: Sequence[Mesh]) -> bool:
    """Whether no part is seen anywhere; wherever its picture is used, its most opaque texel counts."""
    return not any(map(_may_be_seen, parts))


def _may_be_seen(part: Mesh) -> bool:
    material = part.material
    if material.alpha is Alpha.OPAQUE:
        return True
    opacity = part.greatest_opacity
    return opacity >= material.alpha_cutoff if material.alpha is Alpha.CUT_OUT else opacity > 0
