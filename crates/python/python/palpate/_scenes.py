"""Parts of a study's config, without TOML."""

from __future__ import annotations

from typing import Any


def surface(kind: str, **settings: Any) -> dict[str, Any]:
    """Returns the surface of a probe or an object, for a scene: ``surface("sphere", radius=30.0)``.

    ``schema()`` returns the kinds with their settings, units and defaults. ``Study`` checks the settings.
    """
    return {"kind": kind, **settings}


def scene(kind: str, **parts: Any) -> dict[str, Any]:
    """Returns the scene of a study: ``scene("roll", probe=surface("sphere", radius=10.0), object=…, motion={…}, sensor={…})``.

    Kinds are "roll", "glide", "press" and "fingertip". ``Study`` checks the parts.
    """
    return {"kind": kind, **parts}
