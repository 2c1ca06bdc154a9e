"""Labels of clips."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from typing import Union

Labels = Union[Mapping[str, Union[str, Sequence[str]]], str, "os.PathLike[str]"]


def read_labels(labels: Labels | None) -> dict[str, list[str]]:
    """Return the labels of each path."""
    if labels is None:
        return {}
    if isinstance(labels, Mapping):
        return {path: [own] if isinstance(own, str) else list(own) for path, own in labels.items()}
    with open(labels, newline="", encoding="utf-8-sig") as file:
        rows = [row for row in csv.reader(file) if row]
    read: dict[str, list[str]] = {}
    for row in rows:
        own = [label.strip() for label in row[1:] if label.strip()]
        read.setdefault(row[0].strip(), []).extend(own)
    return read
