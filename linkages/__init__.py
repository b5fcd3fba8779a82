"""Spatial linkages: a catalogue, linkage files, and their transition maps.

What is listed here is public; everything else may change. Names are imported when they
are first used, so that `import linkages` costs next to nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
