"""Pellucid in Blender: a panel in the sidebar of the 3D view that renders the scene with scattering under
skin, eyes, jade and the like.

The zip that `./run blender-addon` builds is installed by Preferences, Add-ons, Install.
docs/guide/blender.md says how it is used.
"""

bl_info = {
    "name": "Pellucid",
    "author": "The Pellucid authors",
    "version": (0, 1, 0),
    "blender": (3, 3, 0),
    "location": "3D View > Sidebar > Pellucid",
    "description": "Subsurface scattering for skin, eyes and translucent materials",
    "category": "Render",
}

from . import panel, properties, render  # noqa: E402

PARTS = (properties, render, panel)


def register():
    for part in PARTS:
        part.register()


def unregister():
    for part in reversed(PARTS):
        part.unregister()
