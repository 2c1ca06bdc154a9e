"""Labs: what the page makes, for scripts.

Every parameter of the page's link is a keyword here, under the same name and with the same range,
default and unit: ``segue.parameters("blend")`` lists them. The results are those of the page and
of the command line, bit for bit.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import Clip, Result
from ._errors import LabError
from ._load import load_all

#: A value of a parameter; None leaves it to Segue.
Value = float | bool | str | Clip | None

#: Shorter names of parameters, by lab.
ALIASES: Mapping[str, Mapping[str, str]] = {
    "blend": {"window": "blend_window"},
    "graph": {
        "window": "blend_window",
        "threshold_cm": "edge_threshold",
        "seconds": "walk_seconds",
    },
    "register": {"weight": "warp_weight"},
}


def parameters(lab: str) -> dict[str, dict[str, Any]]:
    """Return the parameters of a lab.

    Parameters
    ----------
    lab : str
        The lab's name in links: "view", "clean", "blend", "transition", "speed", "loop",
        "layers", "register", "path", "graph", "match", "in_place", "edit" or "make".

    Returns
    -------
    dict of str to dict
        For every parameter its ``label``, ``kind``, ``unit``, ``default`` and ``help``; numbers
        have ``range``, ``step`` and ``auto`` (whether ``None`` leaves the value to Segue), choices
        have ``choices``.
    """
    return {row.pop("name"): row for row in _core.parameter_rows(lab)}


def metrics(
    clip: Clip | Sequence[Clip],
) -> Any:
    """Measure a clip: foot skating, penetration, jitter and its like.

    Parameters
    ----------
    clip : Clip or sequence of Clip
        Several clips are measured on all cores.

    Returns
    -------
    dict of str to float or None, or a list of them
        The numbers by name; ``None`` where there is nothing to measure. `METRICS` has their units
        and what they mean.
    """
    if isinstance(clip, Clip):
        return _core.metrics_of([clip])[0]
    return _core.metrics_of(list(clip))


def contacts(clip: Clip) -> NDArray[np.bool_]:
    """Return the frames in which each foot is on the ground.

    Parameters
    ----------
    clip : Clip

    Returns
    -------
    ndarray of bool, shape (frames, 2) or (frames, 4)
        Left foot, right foot; of a body on four legs the hind feet, then the left and the right
        forefoot. A foot is planted while it is low and slow, as in the page.
    """
    return clip.contacts()


def clean(clip: Clip | Sequence[Clip], **parameters: Value) -> Any:
    """Mend spikes, gaps, flips, jitter, drift, the ground and foot skating.

    Parameters
    ----------
    clip : Clip or sequence of Clip
        Several clips are cleaned on all cores.
    **parameters
        Parameters of the lab "clean", such as ``clean_sure=80`` (per cent).

    Returns
    -------
    Result or list of Result
        The mended clip; its ``faults`` say what was found, and whether it was mended.
    """
    return _each("clean", clip, parameters)


def loop(clip: Clip | Sequence[Clip], **parameters: Value) -> Any:
    """Make a part of a clip a cycle without a seam.

    Parameters
    ----------
    clip : Clip or sequence of Clip
    **parameters
        Parameters of the lab "loop", such as ``loop_from=0.5`` and ``loop_to=1.6`` (seconds).

    Returns
    -------
    Result or list of Result
    """
    return _each("loop", clip, parameters)


def retarget(clip: Clip | Sequence[Clip], body: Clip, **parameters: Value) -> Any:
    """Put clips on another body, with feet and hands where they belong.

    Parameters
    ----------
    clip : Clip or sequence of Clip
    body : Clip
        The clip whose skeleton and proportions the result gets.
    **parameters
        Parameters of the lab "edit", such as ``foot_lock=True`` and ``retarget_hands=0.5``.

    Returns
    -------
    Result or list of Result
    """
    return _each("edit", clip, parameters, body)


def edit(clip: Clip | Sequence[Clip], **parameters: Value) -> Any:
    """Trim, mirror, reverse, resample, scale, turn or move clips.

    Parameters
    ----------
    clip : Clip or sequence of Clip
    **parameters
        Parameters of the lab "edit", such as ``edit_from=0.5``, ``edit_to=2.0`` (seconds) and
        ``mirror=True``.

    Returns
    -------
    Result or list of Result
    """
    return _each("edit", clip, parameters)


def in_place(clip: Clip | Sequence[Clip], **parameters: Value) -> Any:
    """Remove the motion over the ground, or rebuild it from planted feet.

    Parameters
    ----------
    clip : Clip or sequence of Clip
    **parameters
        Parameters of the lab "in_place", such as ``root_way="put_back"``.

    Returns
    -------
    Result or list of Result
    """
    return _each("in_place", clip, parameters)


def path(clip: Clip | Sequence[Clip], **parameters: Value) -> Any:
    """Move a clip along an edited path.

    Parameters
    ----------
    clip : Clip or sequence of Clip
    **parameters
        Parameters of the lab "path", such as ``path_smoothing=1``.

    Returns
    -------
    Result or list of Result
    """
    return _each("path", clip, parameters)


def view(clip: Clip | Sequence[Clip], **parameters: Value) -> Any:
    """Lock the feet of a clip, or put it elsewhere on the ground.

    Parameters
    ----------
    clip : Clip or sequence of Clip
    **parameters
        Parameters of the lab "view", such as ``foot_lock=True``.

    Returns
    -------
    Result or list of Result
    """
    return _each("view", clip, parameters)


def blend(a: Clip, b: Clip, *, window: float = 30, **parameters: Value) -> Any:
    """Dissolve one clip into another at their best match.

    Parameters
    ----------
    a, b : Clip
        The clip that plays first, and the one that follows.
    window : int
        The length of the dissolve, frames: the parameter ``blend_window``.
    **parameters
        Further parameters of the lab "blend", such as ``weight_law="linear"``.

    Returns
    -------
    Result
        Its ``transition`` says where A was left and B entered. A list of them where
        ``compare=`` asks for several.
    """
    parameters.setdefault("blend_window", window)
    return _together("blend", [a, b], parameters)


def transition(
    a: Clip, b: Clip, *, method: str = "inertialize", **parameters: Value
) -> Any:
    """Inertialize, dead-blend or cut from one clip to another.

    Parameters
    ----------
    a, b : Clip
        The clip that plays first, and the one that follows.
    method : str
        ``segue.parameters("transition")["method"]["choices"]`` lists them.
    **parameters
        Further parameters of the lab "transition", such as ``half_life=0.2`` (seconds).

    Returns
    -------
    Result
    """
    return _together("transition", [a, b], {"method": method, **parameters})


def speed(a: Clip, b: Clip, **parameters: Value) -> Any:
    """Make a gait of any speed from a walk and a run.

    Parameters
    ----------
    a, b : Clip
        The slower gait and the faster one.
    **parameters
        Parameters of the lab "speed": ``speed=2.2`` is in metres per second.

    Returns
    -------
    Result
    """
    return _together("speed", [a, b], parameters)


def layers(a: Clip, b: Clip, **parameters: Value) -> Any:
    """Put a part of one body over another, or add a difference.

    Parameters
    ----------
    a, b : Clip
        The motion below, and the one that is put over it.
    **parameters
        Parameters of the lab "layers", such as ``mask="right_arm"``.

    Returns
    -------
    Result
    """
    return _together("layers", [a, b], parameters)


def register(clips: Sequence[Clip], **parameters: Value) -> Any:
    """Time-warp two to eight clips onto each other, and blend them.

    Parameters
    ----------
    clips : sequence of Clip
        The first is the one that the others are registered to. Three and more have the same
        weight.
    **parameters
        Parameters of the lab "register"; ``weight`` is short for ``warp_weight``, the weight of
        the second of two clips.

    Returns
    -------
    Result
    """
    return _together("register", list(clips), parameters)


def synthesize(**parameters: Value) -> Any:
    """Synthesise a walk, run, start, stop, turn or jump.

    Parameters
    ----------
    **parameters
        Parameters of the lab "make", such as ``gait="run"``, ``gait_speed=3`` (metres per
        second) and ``make_seconds=6``.

    Returns
    -------
    Result
    """
    return _together("make", [], parameters)


def run_lab(lab: str, clips: Sequence[Clip] = (), **parameters: Value) -> Any:
    """Make a result by the lab of a name, as the functions above do.

    Parameters
    ----------
    lab : str
        The lab's name in links.
    clips : sequence of Clip
        The clips that it takes, in its order.
    **parameters
        Its parameters.

    Returns
    -------
    Result
        Or a list of results, where ``compare=`` asks for several.
    """
    return _together(lab, list(clips), parameters)


def builtin(name: str) -> Clip:
    """Return a clip that needs no file.

    Parameters
    ----------
    name : str
        A synthesised clip such as "walk", a bundled take such as "cmu16_walk", or a recipe such
        as "run(turn_rate:20)". `builtins` lists the first two.

    Returns
    -------
    Clip
    """
    return _core.builtin(name)


def builtins() -> list[str]:
    """Return the names of the clips that need no file."""
    return _core.builtins()


def link(
    what: Result | Clip | str,
    *clips: Clip,
    body: Clip | None = None,
    page: str = _core.PAGE,
    **parameters: Value,
) -> str:
    """Return the link of the page that shows the same.

    Parameters
    ----------
    what : Result, Clip or str
        A result; a clip, which the page then plays; or the name of a lab, whose result is not
        made for this.
    *clips : Clip
        The clips of the lab.
    body : Clip, optional
        The body on which `retarget` puts clips.
    page : str
        The address of the page.
    **parameters
        The parameters of the lab.

    Returns
    -------
    str
        A link names files by name and content; whoever opens it needs them.

    Examples
    --------
    >>> made = segue.blend(walk, run, window=20)
    >>> segue.link(made) == segue.link("blend", walk, run, window=20)
    True
    """
    if isinstance(what, Clip):
        if clips or parameters or body is not None:
            raise TypeError("a clip has its link: name a lab to link to what it makes of clips")
        query = what.query if isinstance(what, Result) else _core.query("view", [what], [])
    else:
        query = _core.query(what, list(clips), _values(what, parameters), body)
    return f"{page}?{query}"


def open_link(url: str, files: Any = ()) -> Any:
    """Make the result of a link of the page.

    Parameters
    ----------
    url : str
        The link, or all behind its question mark.
    files : sequence of paths or Clip
        The files that the link names, in any order. Built-in clips need none.

    Returns
    -------
    Result
        Or a list of results, where the link compares several.
    """
    if isinstance(files, (str, bytes, os.PathLike, Clip)):
        files = [files]
    paths = [own for own in files if not isinstance(own, Clip)]
    clips = [own for own in files if isinstance(own, Clip)] + (load_all(paths) if paths else [])
    return _single(_core.open_link(url, clips))


def _id_of(clip: Clip) -> str:
    if clip.id is None:
        raise LabError("no link can say how this clip is made: use its as_file()")
    return clip.id


def _each(lab: str, clip: Any, parameters: dict[str, Value], body: Clip | None = None) -> Any:
    values = _values(lab, parameters)
    if isinstance(clip, Clip):
        return _single(_core.make(lab, [clip], values, body))
    return [_single(made) for made in _core.make_each(lab, list(clip), values, body)]


def _together(lab: str, clips: list[Clip], parameters: dict[str, Value]) -> Any:
    return _single(_core.make(lab, clips, _values(lab, parameters)))


def _single(made: list[Result]) -> Any:
    return made[0] if len(made) == 1 else made


def _values(lab: str, parameters: Mapping[str, Value]) -> list[tuple[str, str]]:
    aliases = ALIASES.get(lab, {})
    return [(aliases.get(name, name), _text(name, value)) for name, value in parameters.items()]


def _text(name: str, value: Any) -> str:
    """Return a value as a link has it."""
    if value is None:
        return "auto"
    if isinstance(value, bool) or type(value).__name__ == "bool_":
        return "on" if value else "off"
    if isinstance(value, str):
        return value
    if isinstance(value, Clip):
        return _id_of(value)
    try:
        return repr(int(value)) if float(value).is_integer() else repr(float(value))
    except (TypeError, ValueError):
        raise TypeError(f"{name}: found {value!r}, expected a number, a word, True or False") from None


#: What the numbers of `metrics` and of results are: label, unit, better, help and good.
METRICS: dict[str, dict[str, str]] = {
    name: {"label": label, "unit": unit, "better": better, "help": text, "good": good}
    for name, label, unit, better, text, good in _core.metric_rows()
}
