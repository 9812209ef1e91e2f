"""The paper cube: how well its pose and the lights that it stands in are told, on painted pictures with known truth."""
