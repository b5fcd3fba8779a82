from .catalogue import UnknownLinkageError as UnknownLinkageError
from .closure.loop_closure import LoopClosure as LoopClosure
from .file import LinkageFileError as LinkageFileError
from .linkage import Linkage as Linkage
from .linkage import load as load
from .loop import GeometryError as GeometryError
from .loop import Loop as Loop
from .mapping import map_linkage as map_linkage
