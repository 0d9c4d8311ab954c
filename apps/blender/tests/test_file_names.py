"""Names of the Blender script's files, which need no Blender."""
import importlib.util
from pathlib import Path

FILE = Path(__file__).parents[1] / "gbuffer/file_names.py"
SPEC = importlib.util.spec_from_file_location("file_names", FILE)


def test_materials_that_differ_in_signs_or_case_have_files_of_their_own():
    module = importlib.util.module_from_spec(SPEC)
    SPEC.loader.exec_module(module)
    taken = set()
    names = [module.unique("profile", name, ".toml", taken) for name in (
        "Skin", "skin", "Skin.A", "Skin A", "Skin_A", "\u76ae\u80a4", "\u5634\u5507", "", "../x")]
    assert names == [f"profile_{end}.toml" for end in (
        "Skin", "skin_2", "Skin_A", "Skin_A_2", "Skin_A_3", "\u76ae\u80a4", "\u5634\u5507", "", "___x")]
