"""Packages that only corpora need."""

from __future__ import annotations

import importlib
from typing import Any


def needed(module: str) -> Any:
    """Return a module.

    Raises
    ------
    ImportError
        It is not installed; the text says how to install it.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        advice = f'corpora need {module}: pip install "segue-motion[corpus]" ({error})'
        raise ImportError(advice) from error
