"""Scene files (YAML or TOML): the constructors of Python, written as data."""

import lazy_loader

# loaded when they are asked for: the command line must start without the core to say what is wrong with it
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
