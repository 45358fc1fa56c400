"""Unknowns that one element alone touches, such as enhanced strains: what is left of a matrix without them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import scipy.sparse as sp


def condensed(A: sp.csr_array, element: NDArray[np.int32]) -> sp.csr_array:
    """A matrix (n, n) with what own unknowns answer in the rows and columns of all others.

    Parameters
    ----------
    A : sparse array, (n, n)
    element : int array, (n,)
        Of each unknown the element that it is local to, or -1. Rows and columns of these are to be left out.
    """
    own = np.flatnonzero(element >= 0)
    if not len(own):
        return A
    return (A - A[:, own] @ (inverse_by_element(A[own][:, own], element[own]) @ A[own])).tocsr()


def inverse_by_element(A: sp.csr_array, element: NDArray[np.int32]) -> sp.csr_array:
    """Inverse of a matrix that couples the unknowns of each element with each other only."""
    import scipy.sparse as sp

    _, first, number, count = np.unique(element, return_index=True, return_inverse=True, return_counts=True)
    place, k = np.arange(len(element)) - first[number], np.arange(count.max())
    blocks = np.tile(np.eye(len(k)), (len(count), 1, 1))  # fillers of smaller ones are identities
    entry = A.tocoo()
    blocks[number, place, place] = 0.0
    blocks[number[entry.row], place[entry.row], place[entry.col]] = entry.data
    row, column = np.broadcast_arrays(first[:, None, None] + k[:, None], first[:, None, None] + k)
    used = np.maximum(k[:, None], k) < count[:, None, None]
    return sp.csr_array((np.linalg.inv(blocks)[used], (row[used], column[used])), shape=A.shape)
