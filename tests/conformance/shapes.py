"""From a shape payload to a pose and vertices: section 6 of STANDARD.md.

What the document computes in binary32 is done in numpy.float32, which rounds after every operation.
"""

import math

import numpy

from range_decoder import RangeDecoder, Refused, Table, read_coefficients
from standard import read_numbers

MODES = Table(read_numbers('mode-frequencies'))
GRIDS = Table(read_numbers('grid-frequencies'))
LENGTHS = Table(read_numbers('length-frequencies'))
STEP_EIGHTHS = read_numbers('step-eighths')
MAX_SIDES = 8
F = numpy.float32


class Patch:
    """What a decoder knows of a patch before its records come. basis: None where the blueprint has none."""

    def __init__(self, rest, size, basis):
        self.rest = rest  # (n, 3) float32
        self.size = size
        self.basis = basis
        self.exponent = math.frexp(size)[1]
        squares = [dot(v, v) for v in rest]
        self.reach = numpy.sqrt(max(squares))


class Decoded:
    """centroid: 3 floats; rotation: w, x, y, z; shape: (n, 3) floats; and what led there."""

    def __init__(self, head, coefficients, centroid, rotation):
        self.head = head
        self.coefficients = coefficients
        self.centroid = centroid
        self.rotation = rotation
        self.suggestions = None
        self.sums = None
        self.shape = None


def decode(data, patch, obstacles):
    """Raises Refused with the document's reason."""
    decoder = RangeDecoder(data)
    head = read_head(decoder, patch.exponent)
    uses_basis, follows, presses = (head['mode'] >> bit & 1 for bit in range(3))
    if uses_basis and patch.basis is None:
        raise Refused('bad mode')
    step_level = head['step'] - 8 * head['grid']
    count = 3 * len(patch.rest)
    if uses_basis:
        levels = numpy.clip(patch.basis.levels - step_level, -40, 80).tolist()
    else:
        levels = [16] * count
    coefficients = read_coefficients(decoder, levels)
    decoder.check_end()

    decoded = Decoded(head, coefficients, *dequantise(head))
    sides = find_sides(obstacles, decoded, patch.reach) if follows or presses else []
    step = numpy.ldexp(F(STEP_EIGHTHS[step_level % 8]), step_level // 8 - 15)
    if uses_basis:
        move_along_modes(patch, decoded, sides if follows else [], step)
    else:
        decoded.shape = patch.rest + numpy.array(coefficients, F).reshape(-1, 3) * step
    if presses:
        decoded.shape = press_out(decoded.shape, sides)
    return decoded


def read_head(decoder, exponent):
    """mode, grid, step, x y z (centroid in units of the grid), largest, a b c and turn."""
    head = {'mode': decoder.read_symbol(MODES)}
    if head['mode'] & 3 == 2:
        raise Refused('bad mode')
    place = decoder.read_symbol(GRIDS)
    head['grid'] = decoder.read_bits(5) if place == 9 else place + 8 - exponent
    if not 0 <= head['grid'] <= 17:
        raise Refused('bad step')
    head['step'] = decoder.read_bits(6)
    head['turn'] = min(max(head['grid'] + exponent + 1, 7), 16)
    for axis in 'xyz':
        head[axis] = read_coordinate(decoder)
        if abs(F(head[axis])) > numpy.ldexp(F(8192), head['grid']):
            raise Refused('bad pose')
    head['largest'] = decoder.read_bits(2)
    half = (46341 >> (16 - head['turn'])) + 1
    for name in 'abc':
        head[name] = decoder.read_uniform(2 * half + 1) - half
    if not find_square_left(head) > F(0.2):
        raise Refused('bad pose')
    decoder.check_overrun()
    return head


def read_coordinate(decoder):
    length = decoder.read_symbol(LENGTHS)
    if length == 0:
        return 0
    magnitude, shift, left = 0, 0, length - 1
    while left > 16:
        magnitude |= decoder.read_bits(16) << shift
        shift += 16
        left -= 16
    magnitude |= decoder.read_bits(left) << shift | 1 << (length - 1)
    return -magnitude if decoder.read_bits(1) else magnitude


def find_square_left(head):
    a, b, c = (numpy.ldexp(F(head[name]), -head['turn']) for name in 'abc')
    return F(1) - a * a - b * b - c * c


def dequantise(head):
    centroid = numpy.array([numpy.ldexp(F(head[axis]), -head['grid']) for axis in 'xyz'])
    others = [numpy.ldexp(F(head[name]), -head['turn']) for name in 'abc']
    others.insert(head['largest'], numpy.sqrt(find_square_left(head)))
    return centroid, numpy.array(others)


def dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def cross(a, b):
    return numpy.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def rotate(q, v):
    u = q[1:]
    return v + cross(u, cross(u, v) + v * q[0]) * F(2)


def find_sides(obstacles, pose, reach):
    """[(normal in the body's frame, height of the centroid above the side)], at most eight."""
    inverse = pose.rotation * numpy.array([1, -1, -1, -1], F)
    sides = []
    for obstacle in obstacles:
        side = find_side(obstacle, pose.centroid)
        if side is None or not side[1] < reach:
            continue
        sides.append((rotate(inverse, side[0]), side[1]))
        if len(sides) == MAX_SIDES:
            break
    return sides


def find_side(obstacle, point):
    a, b = (numpy.array(obstacle[name].tolist(), F) for name in 'ab')
    if obstacle['kind'] == 0:  # a plane
        height = dot(a, point) - b[0]
        return (a, height) if height >= 0 else None
    if obstacle['kind'] != 1:
        return None
    way = point - a  # a box
    outside = [axis for axis in range(3) if abs(way[axis]) > b[axis]]
    if len(outside) != 1:
        return None
    axis = outside[0]
    normal = numpy.zeros(3, F)
    normal[axis] = -1 if way[axis] < 0 else 1
    return normal, abs(way[axis]) - b[axis]


def press_out(points, sides):
    points = points.copy()
    for normal, height in sides:
        depth = dot(points, normal) + height
        inside = depth < 0
        points[inside] = points[inside] - normal * depth[inside, None]
    return points


def wrap(sums):
    """Modulo 2^32, then read as signed."""
    return sums.astype(numpy.int64).astype(numpy.uint32).view(numpy.int32)


def suggest(patch, sides, step):
    """What contact suggests for each coefficient, in sixteenths of a step; None when nothing is pressed out."""
    pressed = press_out(patch.rest, sides)
    if numpy.array_equal(pressed, patch.rest):
        return None
    way = (pressed - patch.rest) * numpy.ldexp(F(1), 12 - patch.exponent)
    moved = numpy.rint(numpy.clip(way, F(-8191), F(8191))).astype(float)
    along = wrap(project(patch.basis, moved))
    scale = numpy.ldexp(F(1), patch.exponent - 28) / step
    suggested = along.astype(F) * patch.basis.gains.astype(F) * scale
    return numpy.rint(numpy.clip(suggested, F(-1048576), F(1048576))).astype(numpy.int64)


def project(basis, moved):
    """The sum over each column times what moves along it, in the order of coefficients."""
    if basis.is_scalar:
        return (basis.columns @ moved).ravel()
    return basis.columns @ moved.ravel()


def move_along_modes(patch, decoded, sides, step):
    values = numpy.array(decoded.coefficients, float) * 16
    decoded.suggestions = suggest(patch, sides, step)
    if decoded.suggestions is not None:
        values += decoded.suggestions
    if patch.basis.is_scalar:
        sums = patch.basis.columns.T @ values.reshape(-1, 3)
    else:
        sums = (patch.basis.columns.T @ values).reshape(-1, 3)
    decoded.sums = wrap(sums)
    decoded.shape = patch.rest + decoded.sums.astype(F) * numpy.ldexp(step, -18)
