#!/usr/bin/env python3
"""What compilers for GPUs make of the kernels: registers, stack, spills and resident threads, without a GPU.

    tests/gpu/check.py BUILD_DIR [--write] [--scenes DIR]

The command runs as a device of one lane over the demo's scenes and the other operations; the test spy writes
each program that is built to a file. clang with libclc compiles each of them for NVIDIA (PTX, then ptxas) and
AMD. The result is compared with tests/gpu/table.tsv: more stack, more spills, 10 % fewer resident threads, or
a program that does not compile or link, fails. --write replaces the table. A compiler that is not installed
is named and left out.

Resident threads follow from the limits of a multiprocessor: "Compute Capabilities" in NVIDIA's CUDA C++
Programming Guide, and AMD's RDNA 2 instruction set guide.
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
# Threads, groups and registers of a multiprocessor.
NVIDIA = {
    "sm_75": (1024, 16, 65536),
    "sm_86": (1536, 16, 65536),
    "sm_89": (1536, 24, 65536),
    "sm_90": (2048, 32, 65536),
    "sm_120": (1536, 24, 65536),
}
AMD = {"gfx906": 256, "gfx1030": 1024}  # vector registers of a SIMD that its wavefronts share
CLC = Path("/usr/lib/clc")
COLUMNS = ("program", "kernel", "target", "group", "registers", "stack", "spills", "resident")


def find_clang():
    for name in ("clang-16", "clang-15", "clang-14", "clang"):
        if shutil.which(name):
            return name
    return None


def collect_programs(build, scenes, folder):
    """Runs the command with the spy, which leaves the programs in `folder`."""
    command = build / "bin/pellucid"
    env = dict(
        os.environ,
        LD_PRELOAD=str(build / "lib/libcl_spy.so"),
        PELLUCID_DUMP_PROGRAMS=str(folder),
        PELLUCID_MATH_WIDTH="1",
        PELLUCID_CACHE="0",
        PELLUCID_PROGRAM_BINARIES="0",
    )
    out = folder / "out"
    out.mkdir()
    calls = [
        ["lut", kind, "--size", "8x8", "-o", out / f"{kind}.npy"]
        for kind in ("curvature", "shadow", "specular")
    ]
    calls += [
        ["lut", kind, "--profile", "jade", "--size", "8x8", "-o", out / f"{kind}_tabulated.npy"]
        for kind in ("curvature", "shadow")
    ]
    mesh = ROOT / "data/heads/head_female.obj"
    calls += [
        ["curvature", mesh, "--estimator", estimator, "--smooth", "2", "-o", out / "c.npy"]
        for estimator in ("quadric", "tensor", "edge")
    ]
    for scene in sorted(scenes.glob("*.toml")):
        text = scene.read_text()
        for method in ("auto", "light", "separable", "preintegrated"):
            variant = scenes / f"gpu_{scene.stem}_{method}.toml"
            variant.write_text(re.sub(r'scattering = "\w+"', f'scattering = "{method}"', text))
            calls.append(
                ["shade", scenes / f"{scene.stem}_gbuffer.exr", "--scene", variant, "-o", out / "o.exr"]
            )
    for call in calls:
        done = subprocess.run([command, *map(str, call)], env=env, capture_output=True, text=True)
        if done.returncode and not list(folder.glob("*.cl")):
            sys.exit(f"pellucid {' '.join(map(str, call))}: {done.stderr}")
        if done.returncode:
            print(f"pellucid {' '.join(map(str, call))}: {done.stderr.strip()[:300]}", file=sys.stderr)
    return sorted(folder.glob("*.cl"))


def run(call):
    done = subprocess.run(call, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def front_end(clang, target, library):
    """clang as a compiler of OpenCL C 1.2 for this target, with libclc's functions."""
    return [
        clang,
        "-x",
        "cl",
        "-cl-std=CL1.2",
        "-D__OPENCL_VERSION__=120",
        "-cl-no-stdinc",
        "-Xclang",
        "-finclude-default-header",
        "-target",
        target,
        "-O3",
        "-w",
        "-Xclang",
        "-mlink-builtin-bitcode",
        "-Xclang",
        str(library),
    ]


def to_ptx(clang, source, options, ptx):
    return run(
        [
            *front_end(clang, "nvptx64-nvidia-cuda", CLC / "nvptx64--nvidiacl.bc"),
            "-march=sm_70",
            "-Xclang",
            "-target-feature",
            "-Xclang",
            "+ptx63",
            *options,
            "-S",
            "-o",
            str(ptx),
            str(source),
        ]
    )


def nvidia_rows(clang, ptxas, source, options, work, groups):
    ptx = work / f"{source.stem}.ptx"
    code, said = to_ptx(clang, source, options, ptx)
    if code:
        return [], f"clang for NVIDIA: {said[:600]}"
    rows = []
    for target, (threads, blocks, registers) in NVIDIA.items():
        code, said = run(
            [ptxas, "-v", "-O3", f"--gpu-name={target}", "-o", str(work / f"{source.stem}.cubin"), str(ptx)]
        )
        if code:
            return rows, f"ptxas {target}: {said[:600]}"
        for m in re.finditer(
            r"entry function '(\w+)' for.*?\n(?:.*\n)*?\s*(\d+) bytes stack frame, (\d+) bytes spill stores"
            r".*\n.*?Used (\d+) registers",
            said,
        ):
            name, stack, spills, used = m[1], int(m[2]), int(m[3]), int(m[4])
            group = groups.get(name, 64)
            warps = -(-group // 32)
            of_registers = registers // (-(-max(used, 1) * 32 // 256) * 256) // warps
            resident = min(blocks, of_registers, threads // (warps * 32)) * group
            rows.append((name, target, group, used, stack, spills, round(100 * resident / threads)))
    return rows, None


def amd_rows(clang, source, options, work):
    rows = []
    for target, registers in AMD.items():
        assembly = work / f"{source.stem}.{target}.s"
        code, said = run(
            [
                *front_end(clang, "amdgcn-amd-amdhsa", CLC / "amdgcn--amdhsa.bc"),
                f"-mcpu={target}",
                "-nogpulib",
                *options,
                "-S",
                "-o",
                str(assembly),
                str(source),
            ]
        )
        if code:
            return rows, f"clang for {target}: {said[:600]}"
        text = assembly.read_text()
        for block in re.findall(r"^  - \.a.*?(?=^  - \.a|^amdhsa\.target)", text, flags=re.S | re.M):
            field = {k: v for k, v in re.findall(r"\.(\w+):\s+(\S+)", block)}
            size = re.search(r"\.reqd_workgroup_size:\s*\n\s*- (\d+)", block)
            group = int(size[1]) if size else 64
            wave = int(field.get("wavefront_size", 64))
            used = max(int(field.get("vgpr_count", 1)), 1)
            waves = min(
                16 if wave == 32 else 10,
                registers // (-(-used // 8) * 8) if wave == 32 else registers // (-(-used // 4) * 4),
            )
            filled = group / (-(-group // wave) * wave)
            rows.append(
                (
                    field["name"],
                    target,
                    group,
                    used,
                    int(field.get("private_segment_fixed_size", 0)),
                    int(field.get("vgpr_spill_count", 0)),
                    round(100 * filled * waves / (16 if wave == 32 else 10)),
                )
            )
    return rows, None


def name_of(source):
    """A name that stays: the kernels' files and the options, not the hash of the text."""
    text = source.read_text()
    kernels = re.findall(r"__kernel[^;{]*?void\s+(\w+)\s*\(", text)
    options = re.findall(
        r"-DPEL_(FEATURES|HIDDEN|SHADOW_CONTENT|PIXELS|ESTIMATOR|FORM)=(\w+)", text.split("\n", 1)[0]
    )
    return "+".join(dict.fromkeys(kernels)) + "".join(f" {k.lower()}={v}" for k, v in options)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--write", action="store_true", help="replace the table")
    parser.add_argument("--scenes", type=Path, help="scenes of the demo; made if left out")
    args = parser.parse_args()
    build = args.build.resolve()
    clang, ptxas = find_clang(), shutil.which("ptxas")
    if not clang or not (CLC / "nvptx64--nvidiacl.bc").exists():
        print("skipped: clang and libclc are not installed (Debian: clang libclc-14)")
        return 0
    if not ptxas:
        print(
            "ptxas is not installed (CUDA toolkit, or PyPI's nvidia-cuda-nvcc): nothing for NVIDIA"
        )
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        scenes = work / "scenes"
        if args.scenes:
            shutil.copytree(args.scenes, scenes)
        else:
            subprocess.run(
                [build / "bin/pellucid", "demo", "--size", "320x180", "-o", scenes],
                check=True,
                capture_output=True,
            )
        programs = work / "programs"
        programs.mkdir()
        sources = collect_programs(build, scenes, programs)
        rows, faults = {}, []

        def compile_one(source):
            options = [
                o
                for o in shlex.split(source.read_text().split("\n", 1)[0][3:])
                if o.startswith(("-D", "-cl-"))
            ]
            found, wrong = amd_rows(clang, source, options, work)
            faults = [wrong] if wrong else []
            if ptxas:  # PTX by clang does not hold the size of a group
                more, wrong = nvidia_rows(
                    clang, ptxas, source, options, work, {row[0]: row[2] for row in found}
                )
                found, faults = found + more, faults + ([wrong] if wrong else [])
            return name_of(source), found, faults

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for program, found, wrong in pool.map(compile_one, sources):
                faults += [f"{program}: {w}" for w in wrong]
                for kernel, target, *rest in found:
                    key = (program, kernel, target)
                    old = rows.get(key)  # of variants of one name the worst
                    rows[key] = (
                        rest
                        if not old
                        else [
                            rest[0],
                            max(old[1], rest[1]),
                            max(old[2], rest[2]),
                            max(old[3], rest[3]),
                            min(old[4], rest[4]),
                        ]
                    )
    for fault in faults:
        print(fault, file=sys.stderr)
    if args.write:
        lines = ["\t".join(COLUMNS)] + ["\t".join(map(str, (*key, *rows[key]))) for key in sorted(rows)]
        TABLE.write_text("\n".join(lines) + "\n")
    worse = []
    known = {
        tuple(c[:3]): list(map(int, c[3:]))
        for c in (line.split("\t") for line in TABLE.read_text().splitlines()[1:])
    }
    for key, now in sorted(rows.items()):
        if key in known:
            was = known[key]
            if now[2] > was[2] or now[3] > was[3] or now[4] < 0.9 * was[4]:
                worse.append(
                    f"{' / '.join(key)}: stack {was[2]} -> {now[2]}, spills {was[3]} -> {now[3]}, "
                    f"resident {was[4]} -> {now[4]} %"
                )
        else:
            worse.append(f"{' / '.join(key)}: not in the table (tests/gpu/check.py --write)")
    for line in worse:
        print(line, file=sys.stderr)
    compiled = len({k[0] for k in rows})
    print(
        f"{compiled} programs, {len({k[:2] for k in rows})} kernels, {len(rows)} rows, {len(faults)} faults, "
        f"{len(worse)} worse than the table"
    )
    return 1 if faults or worse else 0


if __name__ == "__main__":
    sys.exit(main())
