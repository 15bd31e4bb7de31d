"""One exact derivation, shared: the tests only read it."""

from __future__ import annotations

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
