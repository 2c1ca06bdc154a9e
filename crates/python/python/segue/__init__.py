"""Motion capture as NumPy arrays, and Segue's labs.

>>> import segue
>>> walk = segue.load("walk.bvh")           # any format that Segue reads
>>> walk.rotations.shape                    # (frames, joints, 4): w x y z, in the parent
(181, 24, 4)
>>> walk.global_positions()                 # (frames, joints, 3): metres, Y up

Units are metres, seconds and frames; an angle is in degrees where its name says so. The world is
right-handed, with Y up. Quaternions are in the order w x y z.
"""

from ._core import Clip, __version__
from ._errors import LabError, ReadError, ReadErrors, SegueError, WriteError
from ._load import load, load_all, read_bytes

__all__ = [
    "Clip",
    "LabError",
    "ReadError",
    "ReadErrors",
    "SegueError",
    "WriteError",
    "__version__",
    "load",
    "load_all",
    "read_bytes",
]
