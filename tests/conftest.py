"""One exact derivation, shared: the tests only read it."""

from __future__ import annotations

import os

# Every worker has a core; BLAS threads of several workers on one core wait for one another, and
# make dense linear algebra ten times slower. Before anything imports NumPy.
for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import pytest

from asymptotics import ClosedForms, Expansion, exact_string, expand


@pytest.fixture(scope="session")
def sixth() -> Expansion:
    return expand(exact_string(), 6)


@pytest.fixture(scope="session")
def forms(sixth: Expansion) -> ClosedForms:
    return ClosedForms(sixth)


@pytest.fixture(scope="session")
def circular(sixth: Expansion, forms: ClosedForms) -> ClosedForms:
    return ClosedForms(sixth, forms.frame, "circular")
