"""Verifies and reads a FlatBuffer in one pass: section 3 of STANDARD.md, "What to verify".

read(bytes, 'ServerMessage') gives a dict from field names to values: numbers, bytes for strings, numpy arrays for
vectors of scalars and structs, lists of dicts for vectors of tables, None for what is absent (0 for a number). A union
gives its table under its name, and its table's name under NAME_type. Malformed is raised for anything that the
document says to refuse.
"""

import struct

import numpy

from schema import SCHEMA

MAX_DEPTH = 8
MAX_TABLES = 64


class Malformed(Exception):
    """Not a FlatBuffer of this schema."""


def read(data, root):
    return _Reader(data).read_root(root)


class _Reader:
    def __init__(self, data):
        self.data = data
        self.depth = 0
        self.tables = 0

    def read_root(self, root):
        if len(self.data) < 8:
            raise Malformed
        return self.read_table(self._follow(0), root)

    def read_table(self, at, name):
        self.depth += 1
        self.tables += 1
        if self.depth > MAX_DEPTH or self.tables > MAX_TABLES:
            raise Malformed
        vtable = at - self._scalar(at, '<i')
        size = self._scalar(vtable, '<H')
        if size % 2 != 0:
            raise Malformed
        self._check(vtable, size)
        fields = {}
        slot = 4  # of the next field in the vtable, behind its own size and the table's
        for field, kind in SCHEMA.tables[name]:
            if kind in SCHEMA.unions:
                self._read_union(at, vtable, size, slot, field, kind, fields)
                slot += 4
                continue
            place = self._find(at, vtable, size, slot)
            fields[field] = self._read_field(place, kind)
            slot += 2
        self.depth -= 1
        return fields

    def _find(self, at, vtable, size, slot):
        """Where a field lies; None when it is absent."""
        offset = struct.unpack_from('<H', self.data, vtable + slot)[0] if slot + 2 <= size else 0
        return at + offset if offset else None

    def _read_field(self, place, kind):
        if kind in SCHEMA.dtypes:
            dtype = SCHEMA.dtypes[kind]
            if place is None:
                return 0 if dtype.names is None else None
            self._check(place, dtype.itemsize, SCHEMA.find_alignment(dtype))
            value = numpy.frombuffer(self.data, dtype, 1, place)[0]
            return value.item() if dtype.names is None and dtype.kind != 'f' else value
        if place is None:
            return None
        start = self._follow(place)
        if kind == 'string':
            return self._read_string(start)
        if kind.startswith('['):
            return self._read_vector(start, kind[1:-1])
        return self.read_table(start, kind)

    def _read_union(self, at, vtable, size, slot, field, kind, fields):
        place = self._find(at, vtable, size, slot)
        number = self._read_field(place, 'uint8')
        members = SCHEMA.unions[kind]
        place = self._find(at, vtable, size, slot + 2)
        start = None if place is None else self._follow(place)
        known = 1 <= number <= len(members)
        fields[field + '_type'] = members[number - 1] if known else None
        fields[field] = self.read_table(start, members[number - 1]) if known and start is not None else None

    def _read_string(self, start):
        count = self._read_count(start, 1)
        self._check(start + 4 + count, 1)
        if self.data[start + 4 + count] != 0:
            raise Malformed
        return self.data[start + 4:start + 4 + count]

    def _read_vector(self, start, kind):
        dtype = SCHEMA.dtypes.get(kind, numpy.dtype('<u4'))  # tables: offsets
        count = self._read_count(start, dtype.itemsize)
        if kind in SCHEMA.dtypes:
            return numpy.frombuffer(self.data, dtype, count, start + 4)
        places = [start + 4 + 4 * i for i in range(count)]
        return [self.read_table(place + self._scalar(place, '<I'), kind) for place in places]

    def _read_count(self, start, each):
        count = self._scalar(start, '<I')
        self._check(start, 4 + count * each)
        return count

    def _follow(self, place):
        """The place that an offset points to."""
        offset = self._scalar(place, '<I')
        if offset == 0 or offset >= 1 << 31:
            raise Malformed
        self._check(place + offset, 1)
        return place + offset

    def _scalar(self, at, code):
        size = struct.calcsize(code)
        self._check(at, size, size)
        return struct.unpack_from(code, self.data, at)[0]

    def _check(self, at, size, alignment=1):
        if at < 0 or at % alignment != 0 or size >= len(self.data) or at > len(self.data) - size:
            raise Malformed
