"""A working directory with files that are not what they are taken for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"
ROW = "env,variant,compensator,seed,protocol,competitor_hash\n"
FILES: dict[str, str | bytes] = {
    "file": "",
    "empty.py": "",
    "binary.toml": bytes(range(256)),
    "empty.toml": "",
    "no_rows/episodes.csv": "",
    "no_text/episodes.csv": bytes(range(256)),
    "no_table/episodes.csv": "a,b\n1\n1,2,3\n",
    "no_seed/episodes.csv": f"{ROW}{STICTION},nominal,pid-low,1.5,full@1,1\n",
    "no_env/episodes.csv": f"{ROW}Nothing-v0,nominal,pid-low,1,full@1,1\n",
    "no_name/episodes.csv": f"{ROW}{STICTION},nominal,{'x' * 100000},1,full@1,1\n",
    "no_processor/episodes.csv": f"{ROW}{STICTION},nominal,pid-low,1,full@1,1\n",
    "no_processor/processor.json": '{"x": 3}',
    "no_variant/episodes.csv": f"{ROW}{STICTION},wild,pid-low,1,full@1,1\n",
}


PROTOCOL = {
    "name": '"small"',
    "split": '"validation"',
    "seeds": "2",
    "environments": '["FJRSquare-v0"]',
    "variants": '["nominal"]',
    "compensators": '["pid-low"]',
}


def protocol(**keys: str) -> str:
    return "\n".join(f"{key} = {value}" for key, value in {**PROTOCOL, **keys}.items())


PROTOCOLS = {
    "nobody.toml": protocol(compensators='["nobody"]'),
    "references.toml": protocol(compensators='["none", "ideal"]'),
    "case.toml": protocol(compensators='["PID-low"]'),
    "space.toml": protocol(compensators='["pid-low "]'),
    "blank.toml": protocol(compensators='[""]'),
    "no_file.toml": protocol(compensators='["nothing.py:Mine"]'),
    "digits.toml": protocol(seeds="9" * 5000),
    "nested.toml": f"name = {'[' * 5000}",
}
MINE = """import numpy as np
class Mine:
    feedback = "nominal"
    def reset(self, joints, num_envs): self.shape = (num_envs, joints.dof)
    def estimate(self, signals): return {estimate}
"""
ESTIMATES = {
    "complex_.py": "np.zeros(self.shape, complex)",
    "bools.py": "np.zeros(self.shape, bool)",
    "objects.py": "np.zeros(self.shape, object)",
    "masked.py": "np.ma.masked_array(np.zeros(self.shape), mask=True)",
    "texts.py": "np.full(self.shape, '1')",
    "nothing_.py": "None",
}
"""What a file's class gives, which crosses to another process."""


@contextmanager
def hostile_folder(folder: Path) -> Iterator[Path]:
    """The folder, with such files, as the current one."""
    for name, content in FILES.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    (folder / "loop").symlink_to("loop")
    for name in (*PROTOCOLS, *ESTIMATES):
        text = PROTOCOLS.get(name) or MINE.format(estimate=ESTIMATES.get(name))
        (folder / name).write_text(text, encoding="utf-8")
    for name in ("folder.toml", "folder.py", "no_file/episodes.csv"):
        (folder / name).mkdir(parents=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


def written(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if "__pycache__" not in path.parts}
