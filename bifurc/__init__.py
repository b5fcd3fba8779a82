"""Continuation and bifurcation analysis: all solution curves of a system of equations,
the points where they meet, and the ways between them.

What is listed here is public; everything else may change. Names are imported when they
are first used, so that `import bifurc` costs next to nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = "0.1.0"
