"""Arithmetic in a fixed order gives what NumPy's gives, to rounding."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models import arithmetic
from models.arithmetic import arithmetic_digest, eigen, libm_digest
from tests.support.processes import printed

generators = st.integers(0, 2**32 - 1).map(np.random.default_rng)
sizes = st.integers(1, 40)


def test_a_total_adds_from_the_first_on_and_whole_numbers_exactly() -> None:
    tenths = [0.1] * 10
    assert arithmetic.total(tenths) == 0.9999999999999999
    assert arithmetic.total(iter(tenths)) == arithmetic.total(tenths)
    assert arithmetic.total([1e16, 1.0, -1e16]) == 0.0
    assert arithmetic.total([10**30, 1, -(10**30)]) == 1
    assert arithmetic.total([]) == 0


@given(rng=generators, n=sizes, m=sizes, p=sizes)
def test_products_are_those_of_numpy_to_rounding(
    rng: np.random.Generator, n: int, m: int, p: int
) -> None:
    A, B, C = rng.normal(size=(n, m)), rng.normal(size=(m, p)), rng.normal(size=(p, m))
    x, y = rng.normal(size=m), rng.normal(size=n)
    for ours, numpys in (
        (arithmetic.matrix_product(A, B), A @ B),
        (arithmetic.times_transposed(A, C), A @ C.T),
        (arithmetic.transposed_times(A, A), A.T @ A),
        (arithmetic.matrix_vector(A, x), A @ x),
        (arithmetic.vector_matrix(y, A), y @ A),
        (arithmetic.stacked_product(A[None, :, :], B), A @ B[None]),
        (arithmetic.stacked_applied(A, x), A @ x),
        (arithmetic.squared_lengths(A), np.sum(A * A, axis=1)),
        (arithmetic.length(x), np.linalg.norm(x)),
        (arithmetic.distance(x, x[::-1]), np.linalg.norm(x - x[::-1])),
    ):
        np.testing.assert_allclose(ours, numpys, rtol=1e-12, atol=1e-12)


@given(rng=generators, n=sizes)
def test_equations_of_a_positive_matrix_are_solved(rng: np.random.Generator, n: int) -> None:
    A = rng.normal(size=(n, n + 3))
    S, r = A @ A.T + 1e-3 * np.eye(n), rng.normal(size=n)
    x = arithmetic.solve_positive(np.tril(S), r)
    np.testing.assert_allclose(S @ x, r, atol=1e-8)


def test_a_matrix_that_is_not_positive_is_refused() -> None:
    for S in (np.zeros((2, 2)), -np.eye(3), np.array([[1.0, 2.0], [2.0, 1.0]])):
        with pytest.raises(ArithmeticError, match="not positive definite"):
            arithmetic.solve_positive(S, np.ones(len(S)))


@given(rng=generators, n=st.integers(1, 12))
def test_eigenvectors_rebuild_their_matrix(rng: np.random.Generator, n: int) -> None:
    A = rng.normal(size=(n, n))
    S = A + A.T
    values, V = eigen(S)
    assert (np.diff(values) <= 1e-9).all()
    np.testing.assert_allclose(V @ np.diag(values) @ V.T, S, atol=1e-9)
    np.testing.assert_allclose(V.T @ V, np.eye(n), atol=1e-9)
    np.testing.assert_allclose(values, np.linalg.eigvalsh(S)[::-1], atol=1e-9)


def test_the_exponential_of_many_numbers_is_accurate_to_single_precision() -> None:
    x = np.linspace(-86.0, 0.0, 100_001).astype(np.float32)
    np.testing.assert_allclose(arithmetic.exp_of_many(x), np.exp(x.astype(float)), rtol=3e-7)
    assert (arithmetic.exp_of_many(np.array([-90.0, -1e4], np.float32)) == 0.0).all()


@given(x=st.lists(st.floats(-700.0, 700.0), min_size=1, max_size=20))
def test_functions_of_arrays_are_those_of_libm(x: list[float]) -> None:
    a = np.array(x)
    np.testing.assert_allclose(arithmetic.exp(a), np.exp(a), rtol=1e-14)
    np.testing.assert_allclose(arithmetic.sin(a), np.sin(a), rtol=1e-12, atol=1e-15)
    positive = np.abs(a) + 1e-300
    np.testing.assert_allclose(arithmetic.log(positive), np.log(positive), rtol=1e-14)
    b = a[::-1].copy()
    np.testing.assert_allclose(arithmetic.atan2(a, b), np.arctan2(a, b), rtol=1e-14)
    np.testing.assert_allclose(arithmetic.log_sum_exp(a, b), np.logaddexp(a, b), rtol=1e-13)


@pytest.mark.parametrize(
    "environment",
    [
        {"OPENBLAS_CORETYPE": "Nehalem"},
        {"OPENBLAS_CORETYPE": "Sandybridge", "OPENBLAS_NUM_THREADS": "2"},
        {"NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 X86_V3 X86_V4 AVX512F AVX512_SKX"},
    ],
)
def test_no_kernel_of_blas_and_no_dispatch_of_numpy_changes_a_bit(
    environment: dict[str, str],
) -> None:
    code = "from models.arithmetic import *; print(libm_digest(), arithmetic_digest())"
    told = printed("-W", "ignore", "-c", code, **environment).split()
    assert told == [libm_digest(), arithmetic_digest()]
