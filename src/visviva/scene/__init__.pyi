from .reading import read_scene
from .schema import scene_schema
from .writing import write_scene

__all__ = ["read_scene", "scene_schema", "write_scene"]
