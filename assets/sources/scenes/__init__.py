"""Pictures of scenes with a known light: specified, path-traced, photographed. README.md of assets/sources says how."""
