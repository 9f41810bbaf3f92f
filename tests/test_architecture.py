"""The rules of the house, read from the source: where imports may go, what is not done, what is documented."""

from __future__ import annotations

import ast
import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import fo_gym

ROOT = Path(__file__).parents[1]
PACKAGES = ("envs_assets", "fo_gym", "baselines")
SOURCES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
}
TREES = {module: ast.parse(path.read_text(encoding="utf-8")) for module, path in SOURCES.items()}

# Data flows one way: a part imports from its own and from those before it. Parts on one line are equals that do not
# know each other.
FLOW = (
    (
        "envs_assets",
        "fo_gym.checks",
        "fo_gym.compiling",
        "fo_gym.extras",
        "fo_gym.instructions",
        "fo_gym.modules",
        "fo_gym.text",
        "fo_gym.toml",
    ),
    ("fo_gym.binding", "fo_gym.mail", "fo_gym.specs"),
    ("fo_gym.crew",),
    ("fo_gym.threads",),
    ("fo_gym.friction",),
    ("fo_gym.generators", "fo_gym.micro_steps", "fo_gym.parameters"),
    ("fo_gym.signals",),
    ("fo_gym.scaling",),
    ("fo_gym.hardware",),
    ("fo_gym.robots",),
    ("fo_gym.plant",),
    ("fo_gym.hardware.model",),
    ("fo_gym.control",),
    ("fo_gym.tasks",),
    ("fo_gym.simulation",),
    ("fo_gym.envs",),
    ("fo_gym.files", "fo_gym.console", "fo_gym.sb3", "fo_gym.wrappers"),
    ("fo_gym.compensators",),
    ("fo_gym.evaluation", "fo_gym.protocols"),
    ("fo_gym.evaluation.episode",),
    ("fo_gym.evaluation.metrics",),
    ("fo_gym.evaluation.competitors",),
    ("fo_gym.evaluation.runs",),
    ("fo_gym.evaluation.results",),
    ("fo_gym.plot",),
    ("fo_gym",),
    ("fo_gym.certificate", "fo_gym.tuning"),
    ("fo_gym.bench", "fo_gym.reproduction"),
    ("fo_gym.page",),
    ("fo_gym.cli", "baselines"),
)
LEVEL = {part: level for level, parts in enumerate(FLOW) for part in parts}
# What plug-ins may build on: the package itself, and what its own parts share.
PUBLIC = (
    "fo_gym",
    "fo_gym.checks",
    "fo_gym.console",
    "fo_gym.evaluation.results.statistics",
    "fo_gym.evaluation.results.style",
    "fo_gym.extras",
    "fo_gym.files",
    "fo_gym.friction",
    "fo_gym.hardware",
    "fo_gym.sb3",
    "fo_gym.scaling",
    "fo_gym.wrappers",
    "fo_gym.wrappers.vector",
)
MODERN_RANDOM = {"Generator", "BitGenerator", "SeedSequence", "default_rng", "PCG64"}


def part_of(module: str) -> str:
    """The entry of FLOW that a module belongs to."""
    if module in LEVEL:
        return module
    names = module.split(".")
    if names[0] != "fo_gym" or len(names) == 1:
        return names[0]
    return ".".join(names[:3] if names[1] == "evaluation" else names[:2])


def imports(module: str) -> Iterator[tuple[str, str]]:
    """(module, name) of everything that a module imports from the project; name is "" for a whole module."""
    for node in ast.walk(TREES[module]):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module} imports relatively"
            found = [(str(node.module), alias.name) for alias in node.names]
        elif isinstance(node, ast.Import):
            found = [(alias.name, "") for alias in node.names]
        else:
            continue
        for source, name in found:
            if source.partition(".")[0] in PACKAGES:
                yield (f"{source}.{name}", "") if f"{source}.{name}" in SOURCES else (source, name)


def test_imports_follow_the_flow() -> None:
    edges = [(module, source, part_of(module), part_of(source)) for module in SOURCES for source, _ in imports(module)]
    backwards = [
        (module, source) for module, source, here, there in edges if here != there and not LEVEL[there] < LEVEL[here]
    ]
    assert backwards == []


def test_the_flow_names_every_part() -> None:
    assert {part_of(module) for module in SOURCES} == set(LEVEL)


def test_no_module_imports_itself_in_a_circle() -> None:
    edges = {module: {source for source, _ in imports(module)} for module in SOURCES}
    done: set[str] = set()

    def visit(module: str, path: tuple[str, ...]) -> None:
        assert module not in path, " -> ".join((*path, module))
        if module not in done:
            for source in edges[module]:
                visit(source, (*path, module))
            done.add(module)

    for module in SOURCES:
        visit(module, ())


def beyond_the_public_face(module: str) -> Iterator[str]:
    """What a module takes from fo_gym that is not for plug-ins."""
    for source, name in imports(module):
        if source.startswith("baselines"):
            continue
        if source not in PUBLIC:
            yield f"{module} imports {source}"
        elif name and name not in importlib.import_module(source).__all__:
            yield f"{module} imports {name} from {source}"
    for node in (node for node in ast.walk(TREES[module]) if isinstance(node, ast.Attribute)):
        if dotted(node.value) == "fo_gym" and node.attr not in fo_gym.__all__:
            yield f"{module} uses fo_gym.{node.attr}"


def test_baselines_use_the_public_face_only() -> None:
    baselines = [module for module in SOURCES if module.startswith("baselines")]
    assert baselines
    assert [offender for module in baselines for offender in beyond_the_public_face(module)] == []


def test_the_public_face_is_there() -> None:
    assert all(hasattr(fo_gym, name) for name in fo_gym.__all__)
    assert len(set(fo_gym.__all__)) == len(fo_gym.__all__)


def dotted(node: ast.expr) -> str:
    """The name that an expression spells, such as "np.random.seed"; "" if it is not a name."""
    if isinstance(node, ast.Attribute):
        return f"{dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def not_done(tree: ast.Module) -> Iterator[str]:
    """What a module does that is not done here."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.Attribute | ast.Name):
            names = [dotted(node)]
        else:
            names = []
        for name in names:
            full = name.replace("np.", "numpy.", 1) if name.startswith("np.") else name
            legacy = full.startswith("numpy.random.") and full.split(".")[2] not in MODERN_RANDOM
            forbidden = full in ("eval", "exec", "time.sleep") or full.split(".")[0] == "pickle"
            global_state = full == "random" and isinstance(node, ast.Import)
            if legacy or forbidden or global_state:
                yield f"{name} in line {node.lineno}"


def test_what_is_not_done() -> None:
    assert {module: found for module, tree in TREES.items() if (found := list(not_done(tree)))} == {}


def test_the_search_finds_it() -> None:
    lines = (
        "eval('1')",
        "exec('x = 1')",
        "np.random.seed(0)",
        "x = numpy.random.normal()",
        "from numpy.random import rand",
        "import random",
        "from time import sleep",
        "time.sleep(1)",
        "import pickle",
        "pickle.load(file)",
    )
    assert [line for line in lines if not list(not_done(ast.parse(line)))] == []
    assert not list(not_done(ast.parse("rng = np.random.default_rng(0)\ndef f(rng: np.random.Generator): ...")))


def undocumented(node: ast.AST, path: str) -> Iterator[str]:
    """Public modules, classes, functions and methods without a docstring."""
    if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is None:
        yield path
    if isinstance(node, ast.Module | ast.ClassDef):
        for child in node.body:
            if isinstance(child, ast.ClassDef | ast.FunctionDef) and not child.name.startswith("_"):
                yield from undocumented(child, f"{path}.{child.name}")


def test_everything_public_is_documented() -> None:
    assert [name for module, tree in TREES.items() for name in undocumented(tree, module)] == []


def test_files_are_short() -> None:
    lengths = {module: len(path.read_text(encoding="utf-8").splitlines()) for module, path in SOURCES.items()}
    assert {module: length for module, length in lengths.items() if length >= 300} == {}


def test_everything_runs_without_a_display(tmp_path: Path) -> None:
    """Each module is imported and an environment stepped where there is no OpenGL."""
    modules = [module for module in SOURCES if not module.startswith("baselines.rl")]
    program = f"""
import importlib
for module in {modules!r}:
    importlib.import_module(module)
import gymnasium
env = gymnasium.make("FJRStiction-v0")
env.reset(seed=0)
print(env.step([0.5])[0].shape)
"""
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment |= {"MUJOCO_GL": "disable", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-W", "error", "-c", program]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "(9,)\n", "")
