#!/usr/bin/env python3
"""Registers, stack and spills of the kernels with compilers for GPUs, without a GPU.

    tests/gpu/check.py BUILD_DIR [--write] [--scenes DIR]

The command runs as a device of one lane over the demo's scenes and the other operations, and so do tests of
what no command runs; the test spy writes each program that is built to a file. clang with libclc compiles
each of them for NVIDIA (PTX, then ptxas) and AMD. The result is compared with tests/gpu/table.tsv: more
stack, more spills, 10 % more registers, or a program that does not compile or link, fails. --write replaces
the table. A compiler that is not installed is named and left out.
"""

import argparse
import concurrent.futures
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
TABLE = ROOT / "tests/gpu/table.tsv"
NVIDIA = ("sm_75", "sm_86", "sm_89", "sm_90", "sm_120")
AMD = ("gfx906", "gfx1030")
CLC = Path("/usr/lib/clc")
# What no command runs: tests that do.
TESTS = {
    "test_texture_scatter": "*ASphere*:*ShadersSampleIt",
    "test_shade_passes": "*MatchesTheOracle*",
    "test_tap_cells": "*EachDisk*",
    "test_screen_curvature": "*AtEverySize",
    "test_surface_integral": "*Sphere*",
    "test_skin_maps": "*AlbedoAndRadius*:*LeastFactor",
    "test_scatter_blend": "*AlbedoBefore*:*ThinSheets*",
    "test_mesh_live": "MeshNormals.*",
}
COLUMNS = ("program", "kernel", "target", "registers", "stack", "spills")


def collect_programs(build, scenes, folder):
    """Runs the command with the spy, which leaves the programs in `folder`."""
    env = dict(os.environ, LD_PRELOAD=str(build / "lib/libcl_spy.so"), PELLUCID_DUMP_PROGRAMS=str(folder),
               PELLUCID_MATH_WIDTH="1", PELLUCID_CACHE="0", PELLUCID_PROGRAM_BINARIES="0")
    out = folder / "out"
    out.mkdir()
    calls = [["warm-up"], ["lut", "specular", "--size", "8x8", "-o", out / "lut.npy"]]
    calls += [["curvature", ROOT / "data/heads/head_female.obj", "--estimator", estimator, "--smooth", "2",
               "-o", out / "c.npy"] for estimator in ("quadric", "tensor", "edge")]
    for scene in sorted(scenes.glob("*.toml")):
        for method in ("auto", "light", "separable", "preintegrated"):
            variant = scenes / f"gpu_{scene.stem}_{method}.toml"
            text = re.sub(r'scattering = "\w+"', f'scattering = "{method}"', scene.read_text())
            if method == "preintegrated":  # wide shadows filtered from maps, where the demo traces them
                text = re.sub("^wide_shadow = .*\n", "", text, flags=re.M)
            if scene.stem == "key" and method == "auto":  # a light with a size
                before, _, after = text.rpartition('"directional"')
                text = before + '"sphere"' + after.replace("radius = 0", "radius = 20", 1)
            variant.write_text(text)
            gbuffer = scenes / f"{scene.stem}_gbuffer.exr"
            calls.append(["shade", gbuffer, "--scene", variant, "-o", out / "o.exr"])
    # light from maps alone, which no scene of the demo has
    calls.append(["bench", "--first-gpu", "--only", "ear-1: light", "-o", out / "bench"])
    named = [f"ear-1: {method}, half rate" for method in ("light", "disk, 32 taps", "separable, 2 x 25 taps")]
    named += ["light-turns: disk, 8 taps, history", "light-turns: disk, 8 taps, half rate, history"]
    calls.append(["bench", *(word for name in named for word in ("--only", name)), "-o", out / "bench"])
    calls = [["pellucid", *call] for call in calls]
    built = [test for test in TESTS if (build / "bin" / test).exists()]
    calls += [[test, f"--gtest_filter={TESTS[test]}"] for test in built]
    for name, *call in calls:
        code, said = run([build / "bin" / name, *call], env=env)
        if code and not list(folder.glob("*.cl")):
            sys.exit(f"{name} {' '.join(map(str, call))}: {said}")
        if code:
            print(f"{name} {' '.join(map(str, call))}: {said.strip()[:300]}", file=sys.stderr)
    return sorted(folder.glob("*.cl"))


def run(call, **options):
    done = subprocess.run([str(c) for c in call], capture_output=True, text=True, **options)
    return done.returncode, done.stdout + done.stderr


def to_assembly(clang, target, library, options, source, assembly):
    """clang as a compiler of OpenCL C 1.2 for this target, with libclc's functions."""
    return run([clang, *shlex.split("-x cl -cl-std=CL1.2 -D__OPENCL_VERSION__=120 -cl-no-stdinc -O3 -w -S"),
                "-Xclang", "-finclude-default-header", "-Xclang", "-mlink-builtin-bitcode", "-Xclang",
                CLC / library, "-target", target, *options, "-o", assembly, source])


def nvidia_rows(clang, ptxas, source, options, work):
    ptx = work / f"{source.stem}.ptx"
    own = ["-march=sm_70", "-Xclang", "-target-feature", "-Xclang", "+ptx63"]
    code, said = to_assembly(clang, "nvptx64-nvidia-cuda", "nvptx64--nvidiacl.bc", own + options, source, ptx)
    if code:
        return [], f"clang for NVIDIA: {said[:600]}"
    rows = []
    for target in NVIDIA:
        code, said = run([ptxas, "-v", "-O3", f"--gpu-name={target}", "-o", ptx.with_suffix(".cubin"), ptx])
        if code:
            return rows, f"ptxas {target}: {said[:600]}"
        for name, stack, spills, registers in re.findall(
                r"entry function '(\w+)' for.*?\n(?:.*\n)*?\s*(\d+) bytes stack frame, (\d+) bytes spill"
                r" stores.*\n.*?Used (\d+) registers", said):
            rows.append((name, target, int(registers), int(stack), int(spills)))
    return rows, None


def amd_rows(clang, source, options, work):
    rows = []
    for target in AMD:
        assembly = work / f"{source.stem}.{target}.s"
        code, said = to_assembly(clang, "amdgcn-amd-amdhsa", "amdgcn--amdhsa.bc",
                                 [f"-mcpu={target}", "-nogpulib", *options], source, assembly)
        if code:
            return rows, f"clang for {target}: {said[:600]}"
        text = assembly.read_text()
        for block in re.findall(r"^  - \.a.*?(?=^  - \.a|^amdhsa\.target)", text, re.S | re.M):
            field = dict(re.findall(r"\.(\w+):\s+(\S+)", block))
            numbers = (int(field.get(key, 0)) for key in
                       ("vgpr_count", "private_segment_fixed_size", "vgpr_spill_count"))
            rows.append((field["name"], target, *numbers))
    return rows, None


def name_of(source):
    """A stable name: the kernels' files and the options, not the hash of the text."""
    text = source.read_text()
    kernels = re.findall(r"__kernel[^;{]*?void\s+(\w+)\s*\(", text)
    options = re.findall(r"-DPEL_(FEATURES|HIDDEN|SHADOW_CONTENT|PIXELS|ESTIMATOR|FORM)=(\w+)",
                         text.split("\n", 1)[0])
    return "+".join(dict.fromkeys(kernels)) + "".join(f" {k.lower()}={v}" for k, v in options)


def compile_all(clang, ptxas, sources, work):
    """({(program, kernel, target): the other columns}, faults). Of variants of one name the worst counts."""
    def compile_one(source):
        options = [o for o in shlex.split(source.read_text().split("\n", 1)[0][3:])
                   if o.startswith(("-D", "-cl-"))]
        found, wrong = amd_rows(clang, source, options, work)
        more, also = nvidia_rows(clang, ptxas, source, options, work) if ptxas else ([], None)
        return name_of(source), found + more, [f for f in (wrong, also) if f]

    rows, faults = {}, []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for program, found, wrong in pool.map(compile_one, sources):
            faults += [f"{program}: {w}" for w in wrong]
            for kernel, target, *now in found:
                old = rows.setdefault((program, kernel, target), now)
                rows[program, kernel, target] = [*map(max, old, now)]
    return rows, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--write", action="store_true", help="replace the table")
    parser.add_argument("--scenes", type=Path, help="scenes of the demo; made if left out")
    args = parser.parse_args()
    build = args.build.resolve()
    clang = next(filter(shutil.which, ("clang-16", "clang-15", "clang-14", "clang")), None)
    ptxas = shutil.which("ptxas")
    if not clang or not (CLC / "nvptx64--nvidiacl.bc").exists():
        print("clang and libclc are not installed (Debian: clang libclc-14)")
        return 2
    if not ptxas:
        print("ptxas is not installed (CUDA toolkit, or PyPI's nvidia-cuda-nvcc): nothing for NVIDIA")
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        scenes, programs = work / "scenes", work / "programs"
        if args.scenes:
            shutil.copytree(args.scenes, scenes)
        else:
            subprocess.run([build / "bin/pellucid", "demo", "--size", "320x160", "-o", scenes], check=True,
                           capture_output=True)
        programs.mkdir()
        rows, faults = compile_all(clang, ptxas, collect_programs(build, scenes, programs), work)
    if args.write:
        lines = ["\t".join(COLUMNS)] + ["\t".join(map(str, (*key, *rows[key]))) for key in sorted(rows)]
        TABLE.write_text("\n".join(lines) + "\n")
    worse = []
    known = {tuple(c[:3]): list(map(int, c[3:]))
             for c in (line.split("\t") for line in TABLE.read_text().splitlines()[1:])}
    for key, now in sorted(rows.items()):
        was = known.get(key)
        if not was:
            worse.append(f"{' / '.join(key)}: not in the table (tests/gpu/check.py --write)")
        elif now[0] > 1.1 * was[0] or now[1] > was[1] or now[2] > was[2]:
            worse.append(f"{' / '.join(key)}: registers {was[0]} -> {now[0]}, stack {was[1]} -> {now[1]}, "
                         f"spills {was[2]} -> {now[2]}")
    sys.stderr.writelines(f"{line}\n" for line in faults + worse)
    print(f"{len({k[0] for k in rows})} programs, {len({k[:2] for k in rows})} kernels, {len(rows)} rows, "
          f"{len(faults)} faults, {len(worse)} worse than the table")
    return 1 if faults or worse else 0


if __name__ == "__main__":
    sys.exit(main())
