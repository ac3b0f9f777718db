"""Decodes a recorded session and prints the hash of everything decoded, as the program `replay` does.

    python3 session.py < FILE

FILE holds messages as a WebSocket delivers them (section 8 of STANDARD.md), each behind its length in 32 bits. For each
message that brought records, a line says its place (from 0), the number of records so far and the hash so far: FNV-1a
over each decoded record's body, tick, centroid, rotation (w, x, y, z) and vertices in the body's frame, little-endian.
"""

import struct
import sys

import numpy

import flatbuffer
from bases import BadBasis, read_basis
from range_decoder import Refused
from shapes import Patch, decode

VERSION = 6
MAX_PACKET = 1176
MAX_MESSAGE = 64 * 1024
MAX_BLUEPRINT = 512 * 1024
PATCH = 512  # vertices
HISTORY = 64  # packets
GENERATIONS = 32
WORLD = 8192  # m
SMALLEST = float(numpy.float32(0.001))  # m, size of a blueprint


def hash_bytes(data, value=0xCBF29CE484222325):
    """FNV-1a, 64 bits."""
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def is_finite(array):
    """Whether every float of a vector of structs, or of an array of floats, is finite."""
    if array.dtype.names:
        return all(is_finite(array[name]) for name in array.dtype.names)
    return array.dtype.kind != 'f' or bool(numpy.isfinite(array).all())


class Blueprint:
    """What a decoder keeps of a whole blueprint: the patches. Raises Malformed, BadBasis or Refused."""

    def __init__(self, data):
        fields = flatbuffer.read(data, 'Blueprint')
        if len(data) > MAX_BLUEPRINT or fields['name'] is None or fields['rest'] is None or fields['faces'] is None:
            raise Refused('missing field')
        rest, size = fields['rest'], float(fields['size'])
        count = len(rest)
        positions = numpy.stack([rest['x'], rest['y'], rest['z']], axis=1)
        patches = -(-count // PATCH)
        good = (1 <= count <= 4096 and SMALLEST <= size <= WORLD and bool((numpy.abs(positions) <= WORLD).all())
                and self._are_below(fields['faces'], count) and self._are_edges_good(fields, count))
        if not good:
            raise Refused('out of range')
        bases = [None] * patches
        if fields['bases'] is not None:
            if len(fields['bases']) != patches or any(basis['bytes'] is None for basis in fields['bases']):
                raise Refused('out of range')
            sizes = [min(PATCH, count - PATCH * i) for i in range(patches)]
            bases = [read_basis(basis['bytes'].tobytes(), n) for basis, n in zip(fields['bases'], sizes)]
        self.patches = [Patch(positions[PATCH * i:PATCH * (i + 1)], size, basis) for i, basis in enumerate(bases)]

    @staticmethod
    def _are_below(triples, count):
        return all(bool((triples[name] < count).all()) for name in triples.dtype.names)

    def _are_edges_good(self, fields, count):
        edges = fields['edges']
        edge_count = 0 if edges is None else len(edges)
        if edge_count > 32768 or (edges is not None and not self._are_below(edges, count)):
            return False
        return all(fields[name] is None or (len(fields[name]) == wanted and is_finite(fields[name]))
                   for name, wanted in (('particles', count), ('springs', edge_count)))


class BlueprintStore:
    """Blueprints by number, and those that are on their way: section 2 of STANDARD.md, "Blueprints"."""

    def __init__(self, kept):
        self.entries = {}
        self.expected = 0
        self.kept = kept  # whole blueprints by hash

    def add_chunk(self, chunk):
        number = chunk['blueprint']
        is_kept = len(chunk['bytes']) == 0
        is_first = chunk['offset'] == 0 or is_kept
        if number >= 255:
            return
        if number not in self.entries and number >= self.expected and not is_first:
            return
        entry = self.entries.setdefault(number, {'blueprint': None, 'generation': 0, 'bytes': b'', 'stated': None})
        stated = (chunk['total'], chunk['hash'], chunk['generation'])
        if is_first:
            entry['bytes'] = b''
            if entry['blueprint'] is not None and entry['generation'] == chunk['generation']:
                return
            entry['stated'] = stated
        if is_kept:
            if chunk['hash'] in self.kept:
                self._put_in_force(entry, chunk, self.kept[chunk['hash']])
            return
        if chunk['offset'] != len(entry['bytes']) or stated != entry['stated']:
            entry['bytes'] = b''
            return
        entry['bytes'] += chunk['bytes'].tobytes()
        if len(entry['bytes']) < chunk['total']:
            return
        whole, entry['bytes'] = entry['bytes'], b''
        self._put_in_force(entry, chunk, whole)

    @staticmethod
    def _put_in_force(entry, chunk, whole):
        if hash_bytes(whole) != chunk['hash']:
            return
        try:
            entry['blueprint'] = Blueprint(whole)
            entry['generation'] = chunk['generation']
        except (flatbuffer.Malformed, BadBasis, Refused):
            pass

    def find(self, number, generation):
        entry = self.entries.get(number)
        return entry['blueprint'] if entry is not None and entry['generation'] == generation else None


class Received:
    """Which packets have arrived: section 4 of STANDARD.md."""

    def __init__(self):
        self.newest = 0
        self.seen = set()

    def take(self, sequence):
        """Whether it is new and not more than 64 behind the newest."""
        if sequence in self.seen or sequence < self.newest - HISTORY:
            return False
        self.seen.add(sequence)
        self.newest = max(self.newest, sequence)
        return True


def read_varint(data, at):
    """The number and where it ends."""
    value = 0
    for i in range(5):
        if at + i >= len(data):
            raise Refused('truncated')
        byte = data[at + i]
        value |= (byte & 127) << 7 * i
        if byte < 128:
            if (byte == 0 and i > 0) or value >= 1 << 32:
                raise Refused('truncated')
            return value, at + i + 1
    raise Refused('truncated')


def read_byte(data, at):
    if at >= len(data):
        raise Refused('truncated')
    return data[at], at + 1


def read_packet(data):
    """Head (sequence, tick, time ratio, input tick) and records; raises Refused."""
    if len(data) < 16 or len(data) > MAX_PACKET or data[0] != 0x57 or data[1] != VERSION:
        raise Refused('bad head')
    head = struct.unpack_from('<IIHI', data, 2)
    if head[0] == 0:
        raise Refused('bad head')
    records, at = [], 16
    while at < len(data):
        record, at = read_record(data, at)
        if record['rest'] > head[1]:
            raise Refused('bad record')
        records.append(record)
    return head, records


def read_record(data, at):
    record = {'patch': 0, 'generation': 0, 'rest': 0}
    record['body'], at = read_varint(data, at)
    blueprint, at = read_byte(data, at)
    record['blueprint'] = blueprint & 127
    if record['blueprint'] == 127:
        record['blueprint'], at = read_byte(data, at)
        if record['blueprint'] < 127:
            raise Refused('bad record')
    if blueprint & 128:
        both, at = read_byte(data, at)
        record['patch'], record['generation'] = both & 7, both >> 3
        record['rest'], at = read_varint(data, at)
        if both == 0 and record['rest'] == 0:
            raise Refused('bad record')
    length, at = read_varint(data, at)
    if record['body'] == 0 or length == 0:
        raise Refused('bad record')
    if length > len(data) - at:
        raise Refused('truncated')
    record['payload'] = data[at:at + length]
    return record, at + length


class Session:
    """A client that only decodes. on_decoded(record, decoded) is called for each record that was decoded. kept: whole
    blueprints that it has from earlier connections."""

    def __init__(self, on_decoded=None, kept=()):
        self.on_decoded = on_decoded
        self.welcome = None
        self.is_first_scene = True
        self.has_ended = False
        self.blueprints = BlueprintStore({hash_bytes(whole): whole for whole in kept})
        self.received = Received()
        self.records = 0
        self.hash = hash_bytes(b'')
        self.refused = []  # reasons of records that did not decode

    def take(self, message):
        """One message: a byte for the channel, then what ENet carries on it."""
        if self.has_ended or not 2 <= len(message) <= MAX_MESSAGE + 1:
            return
        try:
            if message[0] == 0:
                self._take_control(message[1:])
            elif message[0] == 2:
                self._take_snapshot(message[1:])
        except (flatbuffer.Malformed, Refused):
            pass

    def _take_control(self, data):
        message = flatbuffer.read(data, 'ServerMessage')
        kind, body = message['body_type'], message['body']
        if body is None:
            raise Refused('missing field')
        if kind == 'Welcome' and self.welcome is None and is_welcome_good(body):
            self.welcome = body
            self.blueprints.expected = body['blueprint_count']
        elif kind == 'BlueprintChunk' and self.welcome is not None and is_chunk_good(body):
            self.blueprints.add_chunk(body)
        elif kind == 'NextScene' and self.welcome is not None and body['scene'] is not None:
            self.welcome = None
            self.is_first_scene = False
            self.blueprints = BlueprintStore(self.blueprints.kept)
        elif kind == 'Goodbye' and body['detail'] is not None and body['reason'] <= 13:
            self.has_ended = True

    def _take_snapshot(self, data):
        head, records = read_packet(data)
        if not self.received.take(head[0]):
            return
        self.records += len(records)
        if self.welcome is None or (not self.is_first_scene and head[1] <= self.welcome['tick']):
            return
        for record in records:
            self._take_record(record, head[1])

    def _take_record(self, record, tick):
        blueprint = self.blueprints.find(record['blueprint'], record['generation'])
        if blueprint is None or record['patch'] >= len(blueprint.patches):
            return
        try:
            decoded = decode(record['payload'], blueprint.patches[record['patch']], self.welcome['obstacles'])
        except Refused as refused:
            self.refused.append(str(refused))
            return
        pose = decoded.centroid.tobytes() + decoded.rotation.tobytes()
        data = struct.pack('<II', record['body'], tick) + pose + decoded.shape.tobytes()
        self.hash = hash_bytes(data, self.hash)
        if self.on_decoded:
            self.on_decoded(record, decoded)


def is_in_world(array):
    """Whether every float of a vector of structs, or of an array of floats, is within the world's border."""
    if array.dtype.names:
        return all(is_in_world(array[name]) for name in array.dtype.names)
    return array.dtype.kind != 'f' or bool((numpy.abs(array) <= WORLD).all())


def is_welcome_good(welcome):
    if any(welcome[name] is None for name in ('scene', 'obstacles', 'height_fields', 'game')):
        return False
    obstacles, fields = welcome['obstacles'], welcome['height_fields']
    with numpy.errstate(over='ignore', invalid='ignore'):
        lowest = fields['corner']['z'] + fields['low']
        highest = lowest + fields['step'] * numpy.float32(65535)
        normals = obstacles['a'][obstacles['kind'] == 0]
        lengths = numpy.sqrt(normals['x'] * normals['x'] + normals['y'] * normals['y'] + normals['z'] * normals['z'])
    halves = obstacles['b'][obstacles['kind'] == 1]
    return bool(welcome['tick_hz'] > 0 and welcome['snapshot_hz'] > 0 and welcome['blueprint_count'] <= 255
                and len(obstacles) <= 1024 and len(fields) <= 16 and welcome['hands'] <= 15 and welcome['reach'] >= 0
                and len(welcome['game']) <= 32 and welcome['rank'] <= 3 and is_drive_good(welcome['drive'])
                and welcome['talk'] <= 3 and len(welcome['description'] or '') <= 256
                and (welcome['own_blueprint'] < welcome['blueprint_count'] or welcome['blueprint_count'] == 0)
                and is_in_world(obstacles)
                and (abs(lengths - 1) <= 1e-3).all() and all((halves[axis] >= 0).all() for axis in 'xyz')
                and (obstacles['kind'] <= 3).all() and ((obstacles['kind'] < 2) | (obstacles['radius'] > 0)).all()
                and is_in_world(fields) and is_in_world(lowest) and is_in_world(highest)
                and all(((fields[name] >= 2) & (fields[name] <= 128)).all() for name in ('columns', 'rows'))
                and (fields['cell_size'] > 0).all() and (fields['step'] >= 0).all())


def is_drive_good(drive):
    return drive is None or all(0 <= drive[name] <= 8192 for name in drive.dtype.names)


def is_chunk_good(chunk):
    if chunk['bytes'] is None or (len(chunk['bytes']) == 0 and chunk['offset'] != chunk['total']):
        return False
    return (chunk['generation'] < GENERATIONS and chunk['total'] <= MAX_BLUEPRINT and len(chunk['bytes']) <= 4096
            and chunk['offset'] + len(chunk['bytes']) <= chunk['total'])


def split(data):
    """The messages of a recorded session."""
    messages, at = [], 0
    while at + 4 <= len(data):
        size = struct.unpack_from('<I', data, at)[0]
        messages.append(data[at + 4:at + 4 + size])
        at += 4 + size
    return messages


def replay(messages, session=None):
    """What `replay` prints of these messages."""
    session = session or Session()
    lines = []
    for place, message in enumerate(messages):
        before = session.records
        session.take(message)
        if session.records != before:
            lines.append(f'{place} {session.records} {session.hash:016x}')
    return lines


if __name__ == '__main__':
    print('\n'.join(replay(split(sys.stdin.buffer.read()))))
