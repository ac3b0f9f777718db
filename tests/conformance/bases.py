"""Bases: from the bytes of a blueprint to columns of integers, as section 7 of STANDARD.md has it.

Sums must run in the order of the document. numpy's sum and matrix product choose their own, so sums are taken with
cumsum, which goes through its axis from the first entry to the last.
"""

import math

import numpy

MAX_BYTES = 65536


class BadBasis(Exception):
    """Bytes that are no basis for a patch of this size."""


class Basis:
    """columns[k]: column k in units of 2^-14. Scalar: a column is one number a vertex and counts for each axis.

    The columns are integers kept in binary64: their products with coefficients add up to less than 2^53, so that
    numpy's matrix product is exact in whatever order it sums.
    """

    def __init__(self, is_scalar, columns, levels, gains):
        self.is_scalar = is_scalar
        self.columns = numpy.rint(numpy.clip(columns, -1.0, 1.0) * 16384.0)
        self.levels = levels
        self.gains = gains


class _Bytes:
    def __init__(self, data):
        self.data = data
        self.next = 0

    def take(self, dtype, count):
        size = numpy.dtype(dtype).itemsize * count
        if size > len(self.data) - self.next:
            raise BadBasis('shorter than its fields')
        values = numpy.frombuffer(self.data, dtype, count, self.next)
        self.next += size
        return values

    def take_one(self, dtype):
        return int(self.take(dtype, 1)[0])


def read_basis(data, vertices):
    """The basis of a patch of so many vertices."""
    source = _Bytes(data)
    kind = source.take_one('u1')
    count = source.take_one('<u2')
    if len(data) > MAX_BYTES or kind > 2 or count == 0 or count > (256 if kind == 0 else 512) or count != vertices:
        raise BadBasis('size or kind')
    if kind == 2:
        grid = [int(n) for n in source.take('<u2', 3)]
        if math.prod(grid) != count:
            raise BadBasis('grid')
    else:
        modes, blocks, order, turns = _take_modes(source, kind, count)
    levels = source.take('u1', 3 * count).astype(int) - 192
    gains = source.take('i1', 3 * count)
    if source.next != len(data):
        raise BadBasis('longer than its fields')
    if kind == 2:
        return Basis(True, make_cosines(*grid), levels, gains)
    axes = 3 if kind == 0 else 1
    rows = [axes * vertex + axis for vertex in order for axis in range(axes)]
    return Basis(kind == 1, complete(modes, rows, blocks, turns), levels, gains)


def _take_modes(source, kind, count):
    rows = 3 * count if kind == 0 else count
    mode_count = source.take_one('<u2')
    block_count = source.take_one('u1')
    if mode_count >= rows or (kind == 1 and block_count != 0):
        raise BadBasis('modes or blocks')
    order = [int(vertex) for vertex in source.take('<u2', count)]
    modes = source.take('i1', mode_count * rows).reshape(mode_count, rows).astype(float)
    rest = rows - mode_count
    sizes = [rest * (i + 1) // block_count - rest * i // block_count for i in range(block_count)]
    entries = sum(size * size for size in sizes)
    pairs = source.take('u1', (entries + 1) // 2)
    if sorted(order) != list(range(count)):
        raise BadBasis('order')
    halves = numpy.stack([pairs & 15, pairs >> 4], axis=1).ravel()[:entries].astype(float)
    halves[halves > 7] -= 16
    turns = []
    for size in sizes:
        turns.append(halves[:size * size].reshape(size, size))
        halves = halves[size * size:]
    return modes, sizes, order, turns


def add_up(products, axis=-1):
    """Sums along an axis in ascending order; 0 of nothing."""
    if products.shape[axis] == 0:
        return numpy.zeros(numpy.delete(products.shape, axis))
    return numpy.take(numpy.cumsum(products, axis=axis), -1, axis=axis)


def orthonormalise(vectors):
    """Gram and Schmidt's method on the rows of a matrix, in place."""
    for i, vector in enumerate(vectors):
        before = math.sqrt(add_up(vector * vector))
        for unit in vectors[:i]:
            vector -= add_up(unit * vector) * unit
        left = math.sqrt(add_up(vector * vector))
        if not left > 1e-3 * before:
            raise BadBasis('modes that depend on each other')
        vector /= left


def complete(modes, rows, blocks, turns):
    """The modes made orthonormal and the rest of the basis, column after column (as rows of the result)."""
    orthonormalise(modes)
    count = len(modes)
    work = modes[:, rows].T.copy()  # rows in the order of completion, a column for each mode
    reflections = []
    for k in range(count):
        v = work[k:, k].copy()
        length = math.sqrt(add_up(v * v))
        v[0] += -length if v[0] < 0 else length
        square = add_up(v * v)
        reflections.append((v, 2 / square if square > 0 else 0.0))
        _reflect(work[k:], *reflections[k])
    rest = numpy.zeros((len(rows), len(rows) - count))
    rest[count:] = numpy.eye(len(rows) - count)
    for k in reversed(range(count)):
        _reflect(rest[k:], *reflections[k])
    columns = list(modes)
    first = 0
    for size, turn in zip(blocks or [1] * rest.shape[1], turns or [None] * rest.shape[1]):
        block = rest[:, first:first + size]
        first += size
        if turn is not None:
            orthonormalise(turn)
            block = numpy.stack([add_up(block * column) for column in turn], axis=1)
        for column in block.T:
            columns.append(numpy.empty(len(rows)))
            columns[-1][rows] = column
    return numpy.array(columns)


def _reflect(matrix, v, factor):
    dots = add_up(v[:, None] * matrix, axis=0) * factor
    matrix -= v[:, None] * dots


def make_cosines(*grid):
    """The products of cosines on a grid of vertices, lowest frequency first."""
    axes = []
    for n in grid:
        axes.append([[math.sqrt((1.0 if a == 0 else 2.0) / n) * math.cos(math.pi * (a * (2 * i + 1)) / (2 * n))
                      for i in range(n)] for a in range(n)])
    nx, ny, nz = grid
    modes = [(a, b, c) for c in range(nz) for b in range(ny) for a in range(nx)]
    modes.sort(key=lambda mode: (mode[0] * ny * nz) ** 2 + (mode[1] * nx * nz) ** 2 + (mode[2] * nx * ny) ** 2)
    x, y, z = (numpy.array(axis) for axis in axes)
    return numpy.array([(x[a] * y[b][:, None] * z[c][:, None, None]).ravel() for a, b, c in modes])
