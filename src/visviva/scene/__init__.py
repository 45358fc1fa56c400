"""Scene files (YAML or TOML): the constructors of Python, written as data."""

from visviva.scene.read import read_scene
from visviva.scene.schema import scene_schema
from visviva.scene.write import write_scene

__all__ = ["read_scene", "scene_schema", "write_scene"]
