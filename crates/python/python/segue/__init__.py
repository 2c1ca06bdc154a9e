"""Motion capture as NumPy arrays, and Segue's labs.

>>> import segue
>>> walk = segue.load("walk.bvh")           # any format that Segue reads
>>> walk.rotations.shape                    # (frames, joints, 4): w x y z, in the parent
(181, 24, 4)
>>> walk.global_positions()                 # (frames, joints, 3): metres, Y up
>>> run = segue.builtin("run")
>>> segue.blend(walk, run, window=20).save("blend.bvh")

Units are metres and seconds; where a number is in frames, centimetres or degrees, its text says
so. The world is right-handed with Y up. Quaternions are in the order w x y z.
"""

from ._arrays import from_arrays
from ._core import Clip, Result, __version__
from ._errors import LabError, ReadError, ReadErrors, SegueError, WriteError
from ._graph import (
    Distances,
    Graph,
    Hits,
    MatchDatabase,
    distance_matrix,
    graph,
    match_database,
)
from ._labs import (
    METRICS,
    blend,
    builtin,
    builtins,
    clean,
    contacts,
    edit,
    in_place,
    layers,
    link,
    loop,
    metrics,
    open_link,
    parameters,
    path,
    register,
    retarget,
    run_lab,
    speed,
    synthesize,
    transition,
    view,
)
from ._load import load, load_all, read_bytes

__all__ = [
    "METRICS",
    "Clip",
    "Distances",
    "Graph",
    "Hits",
    "LabError",
    "MatchDatabase",
    "ReadError",
    "ReadErrors",
    "Result",
    "SegueError",
    "WriteError",
    "__version__",
    "blend",
    "builtin",
    "builtins",
    "clean",
    "contacts",
    "distance_matrix",
    "edit",
    "from_arrays",
    "graph",
    "in_place",
    "layers",
    "link",
    "load",
    "load_all",
    "loop",
    "match_database",
    "metrics",
    "open_link",
    "parameters",
    "path",
    "read_bytes",
    "register",
    "retarget",
    "run_lab",
    "speed",
    "synthesize",
    "transition",
    "view",
]
