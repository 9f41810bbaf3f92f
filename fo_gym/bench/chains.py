"""Arms of any number of joints, made on the fly."""

from __future__ import annotations

from pathlib import Path

from fo_gym.robots import Robot

_LINK = """
<body name="link{j}" pos="0 0 {offset}">
  <joint name="joint{j}" axis="{axis}" range="-2.5 2.5"/>
  <geom name="bar{j}" type="capsule" fromto="0 0 0 0 0 0.2" size="0.03" mass="1"/>
  {rest}
</body>"""

__all__ = ["chain"]


def chain(joints: int, folder: Path) -> Robot:
    """Links of 0.2 m and 1 kg, one on the other, whose axes lie across and along in turn; motors by design.

    Args:
        joints: how many.
        folder: where its file is written, which it needs for as long as it lives.
    """
    links = ""
    for j in reversed(range(joints)):
        links = _LINK.format(j=j, offset=0.2 if j else 0.0, axis="0 0 1" if j % 2 else "0 1 0", rest=links)
    compiler = '<compiler angle="radian" autolimits="true"/>'
    path = folder / f"chain_of_{joints}.xml"
    path.write_text(f"<mujoco>{compiler}<worldbody>{links}</worldbody></mujoco>", encoding="utf-8")
    return Robot.from_file(path)
