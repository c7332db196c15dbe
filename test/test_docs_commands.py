# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""What make docs-test takes from a page, and that it stops at the first command that fails."""

from __future__ import annotations

import runpy
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = """
```
true plain
```

<!-- docs-test: make, colcon -->
```sh
true make and colcon
```
```yaml
not: run
```
<!-- docs-test: needs data -->

```bash
lane_dp run BAG
```

<!-- docs-test: needs ROS -->
```
no_such_program --yes
true one \\
  two
```
"""


@pytest.fixture(scope="module")
def docs_test():
    return runpy.run_path(str(ROOT / ".ci" / "docs_test.py"))


def run(docs_test, page: str, way: str = "pip", clone: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run a page without any installation."""
    docs_test["INSTALL"][way] = "true"
    text = docs_test["script"]({"page.md": list(docs_test["blocks"](page))}, way, "/usr/bin:/bin")
    command = ["env", f"CLONE={clone}", "bash", "-c", text]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("way", "lines"),
    [
        ("pip", ["true plain"]),
        ("make", ["true plain", "true make and colcon"]),
        ("colcon", ["true plain", "true make and colcon", "true one   two"]),
    ],
)
def test_each_way_to_install_runs_its_blocks(docs_test, way, lines):
    chosen = [docs_test["chosen"](block, way, "/usr/bin:/bin") for block in docs_test["blocks"](PAGE)]
    assert [text.strip() for text in chosen if text.strip()] == lines


def test_a_block_tells_its_line(docs_test):
    assert [block.line for block in docs_test["blocks"](PAGE)] == [3, 8, 16, 21]


def test_the_first_command_that_fails_ends_it_and_is_named(docs_test):
    result = run(docs_test, "```\necho before\nfalse --this\necho after\n```\n")
    assert result.returncode == 1
    assert result.stderr == "failed: false --this\n"
    assert "before\n" in result.stdout and "== all of it ran" not in result.stdout


def test_all_blocks_share_one_shell_which_starts_each_page_in_the_clone(docs_test, tmp_path):
    (tmp_path / "sub").mkdir()
    page = "```\nx=kept\ncd sub\n```\n```sh\npwd; echo $x\n```\n```python\nprint('by python', 1 + 1)\n```\n"
    result = run(docs_test, page, clone=tmp_path)
    assert result.returncode == 0, result.stderr
    assert {f"{tmp_path}/sub", "kept", "by python 2", "== all of it ran"} <= set(result.stdout.splitlines())


def test_a_comment_that_is_not_understood_is_refused_with_its_line(docs_test):
    with pytest.raises(
        ValueError, match="line 3: docs-test: nedds ROS: expected needs ..., or make, pip, colcon"
    ):
        list(docs_test["blocks"]("<!-- docs-test: nedds ROS -->\n```\nls\n```\n"))


@pytest.mark.parametrize(
    ("command", "is_interrupted"),
    [
        ("ros2 launch lane_dp_ros lane_detector.launch.py camera:=/a", True),
        ("ros2 launch lane_dp_ros lane_detector.launch.py --show-args", False),
        ("ros2 run lane_dp_ros lane_detector --ros-args -r a:=b", True),
        ("ros2 run lane_dp_ros lane_dp --version", False),
        ("colcon build", False),
    ],
)
def test_what_runs_until_ctrl_c_is_interrupted(docs_test, command, is_interrupted):
    prefix = "timeout --preserve-status --signal=INT 10 " if is_interrupted else ""
    assert docs_test["bounded"](command) == prefix + command


def test_every_block_of_the_readme_is_understood(docs_test):
    found = list(docs_test["blocks"]((ROOT / "README.md").read_text(encoding="utf-8")))
    assert {
        way for way in docs_test["INSTALL"] for block in found if docs_test["chosen"](block, way, "")
    } == {
        "make",
        "pip",
        "colcon",
    }
