"""What documents say of the package is so."""

import inspect
import pathlib

import mser3d
import numpy as np
import pytest
from conftest import ROOT
from mser3d import _native, _options, _stubs

HERE = pathlib.Path(__file__).resolve().parents[1]


def blocks(page):
    """The Python of a page."""
    for block in page.split("```python\n")[1:]:
        yield block.split("```")[0]


@pytest.mark.parametrize("page", [HERE / "README.md", ROOT / "docs/python.md"], ids=lambda page: page.name)
def test_pages_run(page, tmp_path, monkeypatch):
    (tmp_path / "fixtures").symlink_to(ROOT / "fixtures")
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks(page.read_text()):
        exec(compile(block, str(page), "exec"), names)
    assert names


def test_the_version_is_the_workspaces():
    text = (ROOT / "Cargo.toml").read_text()
    assert f'version = "{mser3d.__version__}"' in text.split("[workspace.package]")[1]


def test_the_stub_is_current():
    assert pathlib.Path(_stubs.PATH).read_text() == _stubs.stubs(), "run: python -m mser3d._stubs"


def test_the_native_stub_names_what_there_is():
    text = (HERE / "python/mser3d/_native.pyi").read_text()
    for name, value in vars(_native).items():
        if name.startswith("_") or name == "_native":
            continue
        assert f"def {name}(" in text or f"class {name}:" in text, name
        if inspect.isclass(value):
            body = text.split(f"class {name}:")[1].split("\nclass ")[0]
            own = [n for n in vars(value) if not n.startswith("_") or n == "__len__"]
            for member in own:
                assert f"def {member}(" in body or f"{member}:" in body, f"{name}.{member}"


def test_signatures_are_the_command_lines():
    signature = inspect.signature(mser3d.detect)
    assert list(signature.parameters)[:3] == ["mesh", "faces", "progress"]
    for option in _options.described("detect"):
        assert option["name"] in signature.parameters, option["name"]
    connectivity = signature.parameters["connectivity"]
    assert connectivity.default == "26" or connectivity.default == "6"
    text = mser3d.detect.__doc__
    for word in ("voxels : int", "About how many" if "About how many" in text else "Voxels in the solid", "'commute'"):
        assert word in text


def test_every_public_name_is_documented():
    for name in mser3d.__all__:
        value = getattr(mser3d, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(value), name
        if inspect.isclass(value) and value.__module__.startswith("mser3d"):
            for member, attribute in vars(value).items():
                if not member.startswith("_") and (callable(attribute) or isinstance(attribute, property)):
                    assert inspect.getdoc(attribute), f"{name}.{member}"
