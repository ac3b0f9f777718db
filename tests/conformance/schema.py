"""Reads protocol/messages.fbs: which fields a table or struct has, of which types and in which order.

It understands what that file uses: enums, structs, tables and unions without attributes and without default values.
"""

import re

import numpy

from standard import FOLDER

SCALARS = {
    'bool': '?', 'int8': 'i1', 'uint8': 'u1', 'int16': 'i2', 'uint16': 'u2', 'int32': 'i4', 'uint32': 'u4',
    'int64': 'i8', 'uint64': 'u8', 'float': 'f4',
}


class Schema:
    """tables: name -> [(field, type)]; unions: name -> [table]; dtypes: numpy's for scalars, enums and structs."""

    def __init__(self, text):
        self.tables = {}
        self.unions = {}
        self.dtypes = {name: numpy.dtype('<' + code) for name, code in SCALARS.items()}
        text = re.sub(r'//[^\n]*', '', text)
        for kind, name, base, body in re.findall(r'(enum|struct|table|union)\s+(\w+)\s*(?::\s*(\w+))?\s*{([^}]*)}', text):
            if kind == 'enum':
                self.dtypes[name] = self.dtypes[base]
            elif kind == 'union':
                self.unions[name] = [member.strip() for member in body.split(',')]
            else:
                fields = [tuple(part.strip() for part in field.split(':')) for field in body.split(';') if field.strip()]
                if kind == 'struct':
                    self.dtypes[name] = self._lay_out(fields)
                else:
                    self.tables[name] = fields

    def _lay_out(self, fields):
        """A struct's fields lie in order, each aligned to its size; the whole to the largest of these."""
        offset, largest, offsets = 0, 1, []
        for _, kind in fields:
            alignment = self.find_alignment(self.dtypes[kind])
            offset = -(-offset // alignment) * alignment
            offsets.append(offset)
            offset += self.dtypes[kind].itemsize
            largest = max(largest, alignment)
        return numpy.dtype({
            'names': [name for name, _ in fields],
            'formats': [self.dtypes[kind] for _, kind in fields],
            'offsets': offsets,
            'itemsize': -(-offset // largest) * largest,
        })

    def find_alignment(self, dtype):
        """Of a scalar its size, of a struct that of its most aligned field."""
        if dtype.names is None:
            return dtype.itemsize
        return max(self.find_alignment(dtype[name]) for name in dtype.names)


SCHEMA = Schema((FOLDER / 'messages.fbs').read_text(encoding='utf-8'))
