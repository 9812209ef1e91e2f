"""The paper cube: how well its pose and its lights are estimated, on painted pictures with known truth."""
