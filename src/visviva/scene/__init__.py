"""Scene files (YAML or TOML): the constructors of Python, written as data."""

from visviva.scene.reading import read_scene
from visviva.scene.schema import scene_schema
from visviva.scene.writing import write_scene

__all__ = ["read_scene", "scene_schema", "write_scene"]
