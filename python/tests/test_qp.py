# SPDX-License-Identifier: MIT
"""rbd.qp: answers by hand, in both scalars; errors by name."""
import numpy as np
import pytest

import rbd


def test_answers_by_hand(library):
    """The place nearest to (1, 0.5) with x + y <= 1 and x >= 0; a soft row; an equality; no H."""
    near = 1e-5 if library.real == "float" else 1e-12
    s = rbd.qp(np.eye(2), [-1, -0.5], [[1, 1]], [0, -np.inf], [np.inf, 1], library=library)
    assert s.x.dtype == library.dtype
    assert np.allclose(s.x, [0.75, 0.25], atol=near) and np.allclose(s.multipliers, [0, 0.25], atol=near)
    assert s.side.tolist() == [0, 1] and s.steps == 1 and s.rounds == 0 and 0 <= s.dual < near

    again = rbd.qp(np.eye(2), [-1, -0.6], [[1, 1]], [0, -np.inf], [np.inf, 1], warm=s, library=library)
    assert np.allclose(again.x, [0.7, 0.3], atol=near) and again.steps == 0

    assert np.allclose(rbd.qp([[1]], [0], None, [1], None, [3], library=library).x, 0.75, atol=near)
    assert np.allclose(rbd.qp(np.eye(2), [0, 0], [[1, 1]], [1], [1], library=library).x, 0.5, atol=near)
    corner = rbd.qp(np.zeros((2, 2)), [-1, -1], [[1, 2], [4, 2]], [0, 0, -np.inf, -np.inf], [np.inf, np.inf, 4, 12],
                    library=library)
    assert np.allclose(corner.x, [8 / 3, 2 / 3], rtol=1e-4) and corner.rounds > 0
    assert np.allclose(rbd.qp([[2]], [-6], library=library).x, 3, atol=near)


def test_what_cannot_be_solved_says_why(library):
    with pytest.raises(rbd.RbdError, match="row 1.*contradicts") as error:
        rbd.qp([[1]], [0], [[1], [1]], [1, -np.inf], [np.inf, 0], library=library)
    assert error.value.status == rbd.QpStatus.INFEASIBLE
    assert error.value.results.multipliers.tolist() == [-1, 1]
    for H, f, status in ([0], [-1], "UNBOUNDED"), ([-1], [0], "CONVEX"):
        with pytest.raises(rbd.RbdError) as error:
            rbd.qp([H], f, library=library)
        assert error.value.status == rbd.QpStatus[status]
        assert (error.value.results is None) == (status == "CONVEX")
    with pytest.raises(rbd.RbdError, match="row 0, field 'lower': above upper"):
        rbd.qp([[1]], [0], None, [2], [1], library=library)
    with pytest.raises(rbd.RbdError, match="variable 1, field 'H': H is not symmetric"):
        rbd.qp([[1, 0.5], [0, 1]], [0, 0], library=library)
    with pytest.raises(rbd.RbdError, match="'soft'"):
        rbd.qp([[1]], [0], None, [2], [3], [-1], library=library)


@pytest.mark.parametrize("arguments, sentence", [
    (([[1]], [np.nan]), r"f\[0\] is nan"),
    (([[np.inf]], [0]), r"H\[0, 0\] is inf"),
    (([[1]], [0], [[np.nan]]), r"C\[0, 0\] is nan"),
    (([[1]], [0], None, [np.nan]), r"lower\[0\] is nan"),
    (([[1]], [0], None, None, [np.nan]), r"upper\[0\] is nan"),
    (([[1]], [0], None, [0], None, [np.nan]), r"soft\[0\] is nan"),
    (([[1, 0]], [0]), "H must have the shape"),
    (([[1]], [0], [[1, 2]]), "C must have the shape"),
    (([[1]], [0], [[1]], [0, 0, 0]), "1 to 2 entries.*not 3"),
    (([[1]], [0], [[1]], [0, 0], [1]), "upper must have the shape"),
])
def test_slips_are_named(arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        rbd.qp(*arguments)


def test_other_slips():
    with pytest.raises(TypeError, match="warm must be a QpSolution"):
        rbd.qp([[1]], [0], warm=[1])
    with pytest.raises(TypeError, match="steps must be a whole number"):
        rbd.qp([[1]], [0], steps=1.5)
    with pytest.raises(rbd.RbdError, match="'steps'"):
        rbd.qp([[1]], [0], steps=-1)
