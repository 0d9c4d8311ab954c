"""The recipes of docs/guide/batch.md for Slurm and Kubernetes, as they stand there: with an `sbatch` that
starts its jobs on this machine, and with pods that are processes of it."""
import contextlib
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("distributed")
batch = pytest.importorskip("pellucid.batch")
ROOT = Path(__file__).parents[3]
ENTRIES = 24

SBATCH = """#!/bin/sh
n=$(($(cat {0}/count 2>/dev/null || echo 0) + 1)); echo $n >{0}/count
cp "$1" {0}/job$n.sh
setsid bash {0}/job$n.sh >{0}/job$n.log 2>&1 & echo $! >{0}/job$n.pid
echo "Submitted batch job $n"
"""
SCANCEL = """#!/bin/sh
for n in "$@"; do kill -TERM -- -$(cat {0}/job$n.pid); done
"""
# The custom resource is held against its definition, unknown keys included; then each pod is its container's
# command.
PODS = """
import contextlib, json, os, subprocess, time
from pathlib import Path
import dask_kubernetes, dask_kubernetes.operator as operator, distributed, jsonschema, yaml

def strict(schema):
    if isinstance(schema, dict):
        for value in schema.values():
            strict(value)
        if "properties" in schema and schema.get("type") == "object":
            schema.setdefault("additionalProperties", False)
    elif isinstance(schema, list):
        for value in schema:
            strict(value)

class Pods(contextlib.ExitStack):
    status = distributed.core.Status.running

    def __init__(self, namespace, custom_cluster_spec):
        super().__init__()
        helm = Path(dask_kubernetes.__file__).parent / "operator/deployment/helm"
        crds = helm / "dask-kubernetes-operator/crds"
        version = yaml.safe_load((crds / "daskcluster.yaml").read_text())["spec"]["versions"][0]
        schema = version["schema"]["openAPIV3Schema"]
        strict(schema["properties"]["spec"])
        jsonschema.validate(json.loads(json.dumps(custom_cluster_spec)), schema)
        spec, file = custom_cluster_spec["spec"], Path("scheduler.json")
        containers = [spec[part]["spec"]["containers"][0] for part in ("worker", "scheduler")]
        print("gpus", *("nvidia.com/gpu" in str(container["resources"]) for container in containers))
        self.start(spec["scheduler"], {}, "--port", "0", "--dashboard-address", ":0",
                   "--scheduler-file", str(file))
        while not file.exists():
            time.sleep(0.05)
        self.scheduler_address = json.loads(file.read_text())["address"]
        for i in range(min(2, spec["worker"]["replicas"])):
            given = {"DASK_WORKER_NAME": f"tables-{i}", "DASK_SCHEDULER_ADDRESS": self.scheduler_address}
            self.start(spec["worker"], given, "--dashboard-address", ":0")

    def start(self, part, given, *more):
        container = part["spec"]["containers"][0]
        env = {**os.environ, **{e["name"]: e["value"] for e in container["env"]}, **given}
        name = given.get("DASK_WORKER_NAME", "")
        args = [a.replace("$(DASK_WORKER_NAME)", name) for a in container["args"]]
        args = ["127.0.0.1" if a == "0.0.0.0" else a for a in args]  # a pod has a network of its own
        if "--host" not in args:
            args += ["--host", "127.0.0.1"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        process = self.enter_context(subprocess.Popen([*args, *more], env=env, **quiet))
        self.callback(process.terminate)

operator.KubeCluster = Pods
"""


def recipe(heading, changes):
    """The block of code under a heading, with the places and sizes of this machine."""
    code = (ROOT / "docs/guide/batch.md").read_text(
        ).split(f"### {heading}", 1)[1].split("```python\n", 1)[1].split("```", 1)[0]
    for old, new in changes.items():
        assert old in code, f"the recipe has no {old}"
        code = code.replace(old, new)
    return code


@pytest.fixture
def run_recipe(tmp_path):
    """Runs a recipe's text on a small manifest and compares the tables with those made here."""
    (tmp_path / "m.toml").write_text(f"[[grid]]\nsize = [8]\ndiffusion_radius = "
                                     f"{[1 + i / 10 for i in range(ENTRIES)]}\n")

    def run(code, device):
        (tmp_path / "recipe.py").write_text(code)
        path = os.pathsep.join([str(tmp_path), str(Path(sys.executable).parent), os.environ["PATH"]])
        process = subprocess.Popen([sys.executable, "recipe.py"], cwd=tmp_path,
                                   env={**os.environ, "PATH": path}, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
        groups.append(process.pid)
        out, err = process.communicate(timeout=300)
        logs = "\n".join(p.read_text() for p in tmp_path.glob("*.log"))
        assert process.returncode == 0, err + logs
        assert f"made={ENTRIES}" in out, out + logs
        manifest = batch.Manifest(tmp_path / "m.toml")
        made = {p.name: p.read_bytes() for p in (tmp_path / "tables").iterdir() if p.suffix != ".json"}
        assert made == {e.file: manifest.make(device, i) for i, e in enumerate(manifest.entries)}
        return out

    groups = []
    yield run
    for group in groups + [int(p.read_text()) for p in tmp_path.glob("job*.pid")]:
        with contextlib.suppress(OSError):
            os.killpg(group, signal.SIGKILL)


def test_slurm(run_recipe, tmp_path, device):
    pytest.importorskip("dask_jobqueue", reason="dask-jobqueue is not installed")
    pytest.importorskip("cryptography", reason="cryptography is not installed")
    for name, text in (("sbatch", SBATCH), ("scancel", SCANCEL)):
        (tmp_path / name).write_text(text.format(tmp_path))
        (tmp_path / name).chmod(0o755)
    run_recipe(recipe("Slurm", {
        "/shared/manifest.toml": str(tmp_path / "m.toml"), "/shared/tables": str(tmp_path / "tables"),
        "/shared/venv/bin/python": sys.executable, "/shared/home/me/dask": str(tmp_path),
        "DEVICE=gpu": "DEVICE=" + os.environ.get("PELLUCID_DEVICE", ""),
        "workers=100": "workers=2"}), device)
    script = (tmp_path / "job1.sh").read_text()
    subprocess.run(["bash", "-n"], input=script, text=True, check=True)
    asked = re.findall(r"^#SBATCH (.*)$", script, re.M)
    assert {"-p gpu", "--gres=gpu:1", "-n 1", "--cpus-per-task=4", "-t 01:00:00"} <= set(asked)
    assert any(a.startswith("--mem=") for a in asked)
    assert "--nthreads 1" in script and "Starting worker" not in script
    assert "tls://" in script and "--tls-key" in script, "whoever reaches a port without TLS can run anything"
    assert re.search(r"Threads:\s+1\b",
                     (tmp_path / "job1.log").read_text()), "a worker takes one piece at a time"


def test_kubernetes(run_recipe, tmp_path, device):
    for module in ("dask_kubernetes", "jsonschema"):
        pytest.importorskip(module,
                            reason=f"{module} is not installed: pip install dask-kubernetes jsonschema")
    said = run_recipe(PODS + recipe("Kubernetes", {
        '"manifest.toml"': repr(str(tmp_path / "m.toml")),
        '"s3://bucket/tables"': repr(str(tmp_path / "tables")),
        '"PELLUCID_DEVICE": "gpu"': f'"PELLUCID_DEVICE": "{os.environ.get("PELLUCID_DEVICE", "")}"'}), device)
    assert "gpus True False" in said, "a GPU for each worker, none for the scheduler"
