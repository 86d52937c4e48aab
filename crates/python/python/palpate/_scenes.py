"""Parts of a study's config, without TOML."""

from __future__ import annotations

from typing import Any


def surface(kind: str, **settings: Any) -> dict[str, Any]:
    """Surface of a probe or an object, for a scene: ``surface("sphere", radius=30.0)``.

    ``schema()`` has the kinds with their settings, units and defaults. A Study checks them.
    """
    return {"kind": kind, **settings}


def scene(kind: str, **parts: Any) -> dict[str, Any]:
    """Scene of a study: ``scene("roll", probe=surface("sphere", radius=10.0), object=…, motion={…}, sensor={…})``.

    Kinds are "roll", "glide", "press" and "fingertip". A Study checks the parts.
    """
    return {"kind": kind, **parts}
