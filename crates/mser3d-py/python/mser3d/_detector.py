"""A detector as scikit-learn's estimators are: parameters first, shapes later."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np

from ._detect import detect, detect_volume
from ._options import with_options
from ._result import Result


@with_options("detect")
def _parameters(**options: Any) -> None:
    """The parameters of a detector."""


class Detector:
    """Finds the stable regions of shapes, all with the same parameters: those of `mser3d.detect`.

    ``Detector(voxels=20000).fit(mesh)`` has ``result_``, ``labels_`` and ``regions_``; ``transform(mesh)`` gives the descriptors of the
    regions of another mesh. A mask, indexed [x, y, z], serves in place of a mesh. It can be cloned as scikit-learn's
    estimators can, which need not be installed.
    """

    result_: Result
    labels_: np.ndarray
    regions_: Any

    def __init__(self, **parameters: Any) -> None:
        self._parameters: dict[str, Any] = {}
        self.set_params(**parameters)

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """The parameters that were set."""
        return dict(self._parameters)

    def set_params(self, **parameters: Any) -> Detector:
        """Sets parameters and returns itself; None is as if one were not set."""
        known = _known()
        for name in parameters:
            if name not in known:
                raise TypeError(f"Detector: there is no parameter {name!r}; see help(mser3d.detect)")
        self._parameters.update(parameters)
        return self

    def fit(self, X: Any, y: Any = None) -> Detector:
        """Finds the regions of a mesh or a mask, and returns itself."""
        self.result_ = self._detect(X)
        result = self.result_
        self.labels_ = result.vertex_labels if result._native.has_mesh else result.voxel_labels
        self.regions_ = result.regions
        return self

    def transform(self, X: Any) -> np.ndarray:
        """The descriptors of the regions of a mesh or a mask: (regions, q)."""
        return self._detect(X).descriptors

    def fit_transform(self, X: Any, y: Any = None) -> np.ndarray:
        """As `fit`, and the descriptors of the regions: (regions, q)."""
        return self.fit(X).result_.descriptors

    def __repr__(self) -> str:
        return f"Detector({', '.join(f'{name}={value!r}' for name, value in self._parameters.items())})"

    def _detect(self, X: Any) -> Result:
        if isinstance(X, np.ndarray) and X.ndim in (3, 4):
            return detect_volume(X, **self._parameters)
        return detect(X, **self._parameters)


def _known() -> frozenset[str]:
    return frozenset(inspect.signature(_parameters).parameters) - {"options"}
