"""docs/python_api.md is what the docstrings say."""

import sys

import pytest
from conftest import ROOT

sys.path.insert(0, str(ROOT / "crates/mser3d-py"))


def test_the_api_page_is_current():
    pytest.importorskip("distributed")
    import api_page

    page = api_page.page()
    assert page == api_page.PATH.read_text(encoding="utf-8"), "run: python crates/mser3d-py/api_page.py"
    for name in ("mser3d.detect", "mser3d.Result", "Result.save", "mser3d.dask.detect_many"):
        assert f" {name}\n" in page
