"""A reference is ten times finer than the errors that it judges, or says that it is not."""

from types import SimpleNamespace

import pytest

from tetherfmu.study.measuring import errors
from tetherfmu.study.measuring.errors import FINER, fine_enough, judging
from tetherfmu.study.measuring.tables import known


def references(finest):
    """A stand-in of `converged` whose own error is the target, or the finest that can be reached; and its targets."""
    targets = []

    def converged(_scene, target, _names):
        targets.append(target)
        return SimpleNamespace(own_error=lambda _names: max(target, finest), run=SimpleNamespace(flown=target))

    return converged, targets


@pytest.mark.parametrize(("finest", "good"), [(1e-9, True), (1e-3, False)])
def test_refined_until_it_is_ten_times_finer_or_the_finest(monkeypatch, finest, good):
    """The errors found depend on the reference, and the first one is as large as they are."""
    converged, targets = references(finest)
    monkeypatch.setattr(errors, "converged", converged)
    reference, found = judging(None, lambda target: [4e-3 - 0.2 * target, 0.1], ("kite_force",), 4e-3)
    assert targets[0] == 4e-3
    assert targets[1] == pytest.approx((4e-3 - 0.2 * 4e-3) / FINER)
    assert fine_enough(reference.own_error(None), found) is good
    assert found[0] == pytest.approx(4e-3, rel=0.1)


@pytest.mark.parametrize(("own", "text"), [(1e-4, "0.61 %"), (1e-3, "0.61 ± 0.1 %")])
def test_an_error_that_a_coarse_reference_judges_says_so(own, text):
    assert known(0.0061, own) == text
