"""``python -m pellucid.view.gallery OUT``: pictures of materials, methods, lights and mistakes, each with
the scene that makes it.

Every picture has a folder with what the viewer exports: ``pellucid shade gbuffer.exr --scene scene.toml -o
again.exr`` there makes it again. `--pictures-only` leaves out the G-buffers and shadow maps, which are
large, as in the repository's docs/gallery.
"""
from __future__ import annotations

import argparse
import sys
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .. import files
from ..skin import skin_info
from .export import export
from .look import MODES, PRESETS, SKINS, Lamp, Look
from .session import Session, pigments

SIDE = [Lamp("Key", 75.0, 15.0)]
BACK = [Lamp("Key", 150.0, 15.0, intensity=2.5)]
FRONT = [Lamp("Key", 20.0, 30.0)]


@dataclass
class Entry:
    """One picture, the words below it, and what differs from the standard look and view."""

    name: str
    words: str
    look: dict[str, Any]
    azimuth: float = 20.0
    zoom: float = 1.0
    to: tuple[float, float] = (0.0, 0.0)  # where the camera points, right and up, in heights of the mesh
    mm: float = 1.0


STANDARD = Entry("standard", "", {})


def _side(name: str, words: str, mm: float = 1.0, **look: object) -> Entry:
    """Near, and lit from the side."""
    return Entry(name, words, {"lamps": SIDE, "ambient": 0.02, **look}, 25, 0.5, mm=mm)


def _material(name: str, words: str, **look: object) -> Entry:
    return Entry(name, words, {"ambient": 0.08, "specular": 0.35, **look})


GALLERY: dict[str, list[Entry]] = {
    "Materials": [
        _material("skin", "Skin: the profile of d'Eon and Luebke."),
        _material("skin-pale", "Pale skin.", profile="skin-pale", albedo=(1.1, 1.15, 1.15)),
        _material("skin-dark", "Dark skin.", profile="skin-dark", albedo=(0.45, 0.4, 0.38)),
        _material("marble", "Marble.", profile="marble", albedo=(1.05, 1.4, 1.6), pores=0.0, roughness=0.15),
        _material("jade", "Jade.", profile="jade", albedo=(0.35, 1.2, 0.75), pores=0.0, roughness=0.12,
                  specular=0.6),
        _material("paraffin", "Paraffin wax: light goes far.", profile="paraffin", albedo=(1.15, 1.35, 1.1),
                  pores=0.0, roughness=0.35),
    ],
    "Methods": [
        _side(f"method-{method}", words, method=method, **more)
        for method, words, more in [
            ("none", "None: Lambert. Shadows are hard and grey.", {"transmission": 0.0}),
            ("preintegrated", "Pre-integrated: tables, no neighbours.", {}),
            ("separable", "Separable: two filters across the screen.", {}),
            ("screen", "Screen: the whole profile over the picture.", {}),
            ("light", "Light: the sum over the light's own map.", {}),
            ("texture", "Texture: the head's texture, lit and scattered.", {}),
            ("auto", "Auto, the default.", {})]
    ],
    "Lights": [
        Entry("light-front", "From the front: hardly anything to scatter, and hardly any work.",
              {"lamps": FRONT}),
        Entry("light-side", "From the side: the terminator turns red.", {"lamps": SIDE}),
        Entry("light-back", "From behind: ears let light through.",
              {"lamps": BACK, "ambient": 0.1, "pores": 0.0, "specular": 0.1}, 10, 0.4, (0.22, -0.03)),
    ],
    "Mistakes": [
        _side("wrong-unit",
              "The mesh is in mm, and unit_mm said 10: light reaches a tenth as far as it should, and the "
              "picture is nearly Lambert's. The shader warns of it.", 10.0),
        _side("too-soft", "unit_mm said 0.1: skin turns to wax.", 0.1),
        _side("orange-rim",
              "deep_scatter_color (FaceWorks' term) with a strong colour: a rim along nose, lips and ears "
              "that real skin does not have.", method="preintegrated", deep_scatter=(2.0, 0.6, 0.2)),
        _side("coarse-shadow-map",
              "A shadow map of 128 texels: its texels are wider than the profile reaches, and edges of "
              "shadows are steps.", shadow_size=128),
    ],
}


def view(session: Session, entry: Entry = STANDARD) -> None:
    tall = session.mesh.high[1] - session.mesh.low[1]
    session.orbit.frame(session.mesh.low, session.mesh.high, 1.0)
    session.orbit.azimuth, session.orbit.elevation = entry.azimuth, 2.0
    session.orbit.pan = (entry.to[0] * tall, entry.to[1] * tall)
    session.orbit.distance *= entry.zoom


def skins(session: Session, out: Path, size: int) -> list[str]:
    """One head in a row of skins from their pigments, and their numbers."""
    pictures = []
    lines = ["![One head, six skins](skins.png)", "",
             "One head, six skins, by melanin and blood alone: the viewer's presets, nearest to measured "
             "colours.", "", "| skin | melanin | blood | L\\*, a\\*, b\\* | ITA | mean distance, mm |",
             "|---|---|---|---|---|---|"]
    for name, _, _ in SKINS:
        session.look = Look.from_dict({**PRESETS[name], "ambient": 0.08})
        session.take_pigments(session.look)
        info = skin_info(pigments(session.look))
        pictures.append(session.radiance(session.look, size, size))
        lab, far = (", ".join(f"{v:.{digits}f}" for v in of) for of, digits in
                    ((info.lab, 0), (info.mean_distance, 2)))
        lines.append(f"| {name.removeprefix('Skin, ')} | {session.look.melanin} | {session.look.blood} | "
                     f"{lab} | {info.typology_angle:.0f}° | {far} |")
    files.write_image(out / "skins.png", np.concatenate(pictures, 1))
    return [*lines, ""]


def modes(session: Session, out: Path, size: int) -> list[str]:
    """All that the viewer shows of one view, four in a row."""
    pictures = []
    session.look = Look(lamps=[*BACK, Lamp("Fill", -20.0, 20.0, intensity=0.6)], deep_scatter=(0.5, 0.2, 0.1))
    session.mm = 1.0
    for session.look.mode in MODES:
        pictures.append(session.frame(size, size).pixels)
    rows = [np.concatenate(pictures[i:i + 4], 1) for i in range(0, len(pictures), 4)]
    files.write_image(out / "modes.png", np.concatenate(rows))
    return ["## Modes", "", "![What the viewer shows](modes.png)", "",
            f"What the viewer shows of one view, row by row: {'; '.join(MODES.values())}.", ""]


def make(out: Path, pictures_only: bool, sections: Iterable[str], size: int = 480) -> None:
    session = Session()
    session.load(files.standard_head())
    lines = ["# Gallery", "",
             "Made by `python -m pellucid.view.gallery`. Each picture has a folder with its scene file; "
             "without `--pictures-only` the G-buffer and shadow maps are written too, and `pellucid shade "
             "gbuffer.exr --scene scene.toml -o again.exr` there gives the same picture.", ""]
    for section in sections:
        lines += [f"## {section}", ""]
        if section == "Materials":
            view(session)
            lines += skins(session, out, size // 2)
        if section == "Mistakes":
            view(session)
            lines[-2:-2] = modes(session, out, size // 2)
        for entry in GALLERY[section]:
            print(f"{section}: {entry.name}", file=sys.stderr, flush=True)
            session.look, session.mm = Look(**entry.look), entry.mm
            view(session, entry)
            export(session, out / entry.name, size, size, pictures_only)
            lines += [f"![{entry.words}]({entry.name}/picture.png)", "",
                      f"{entry.words} [scene]({entry.name}/scene.toml)", ""]
    text = "\n".join(
        line if line.startswith(("|", "![")) else textwrap.fill(line, 120, break_on_hyphens=False)
        for line in lines)
    (out / "README.md").write_text(text.rstrip() + "\n", encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m pellucid.view.gallery",
                                     description="Pictures of materials, methods, lights and mistakes.")
    parser.add_argument("out", type=Path, help="folder")
    parser.add_argument("--pictures-only", action="store_true", help="leave out G-buffers and shadow maps")
    parser.add_argument("--section", choices=list(GALLERY), action="append", help="only these")
    parser.add_argument("--size", type=int, default=480, help="pixels a side (480)")
    a = parser.parse_args()
    make(a.out, a.pictures_only, a.section or list(GALLERY), a.size)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
