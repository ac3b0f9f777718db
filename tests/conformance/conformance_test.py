"""The native client and the Python decoder against each other and against the numbers in protocol/STANDARD.md.

    python3 conformance_test.py [CLASS]

WOBBLE_TESTS_DIR is the folder of the built test programs `replay`, `print_vector` and `record_session`.
"""

import copy
import os
import pathlib
import random
import re
import struct
import subprocess
import tempfile
import unittest

import numpy

import flatbuffer
import standard
from session import Session, hash_bytes, replay, split

PROGRAMS = pathlib.Path(os.environ.get('WOBBLE_TESTS_DIR', 'build/release/tests'))
DATA = pathlib.Path(__file__).parent / 'data'

numpy.seterr(all='ignore')  # made-up numbers overflow; what comes of that is compared


def run(program, *arguments, data=b''):
    result = subprocess.run([PROGRAMS / program, *arguments], input=data, capture_output=True, check=True)
    return result.stdout.decode()


def join(messages):
    return b''.join(struct.pack('<I', len(message)) + message for message in messages)


def replay_natively(messages, kept=()):
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder) / str(i) for i in range(len(kept))]
        for file, whole in zip(files, kept):
            file.write_bytes(whole)
        return run('replay', *files, data=join(messages)).splitlines()


def flip(data, at, bit=0):
    return data[:at] + bytes([data[at] ^ 1 << bit]) + data[at + 1:]


class Case(unittest.TestCase):
    maxDiff = 2000

    def assert_alike(self, messages, kept=()):
        """Both decoders give the same lines; returns these and the Python session."""
        session = Session(kept=kept)
        lines = replay(messages, session)
        self.assertEqual(lines, replay_natively(messages, kept))
        return lines, session


def read_vector():
    """The messages of the document's test vector: welcome, blueprint, packet."""
    return [b'\0' + standard.read_bytes('vector-welcome'), b'\0' + standard.read_bytes('vector-blueprint'),
            b'\2' + standard.read_bytes('vector-packet')]


def make_chunk(whole, generation=0, offset=0, size=4096):
    """A BlueprintChunk of blueprint 0, put together by hand: two vtables, each before its table, then the bytes. With
    the whole's size as offset it has none, and stands for a blueprint that the client has kept."""
    piece = whole[offset:offset + size]
    data = struct.pack('<I4H', 12, 8, 12, 8, 4)  # root; vtable of ServerMessage: body_type at 8, body at 4
    data += struct.pack('<iIB3x', 8, 24, 2)  # ServerMessage: its body begins 24 bytes behind the offset
    data += struct.pack('<8H', 16, 28, 24, 8, 4, 16, 20, 25)  # vtable of BlueprintChunk
    data += struct.pack('<iIQIIBB2x', 16, len(whole), hash_bytes(whole), offset, 8, 0, generation)
    return b'\0' + data + struct.pack('<I', len(piece)) + piece


class Vector(Case):
    """Section 11 of the document."""

    def test_native_code_makes_what_the_document_shows(self):
        printed = dict(re.findall(r'^```text ([\w-]+)\n(.*?)^```$', run('print_vector'), re.MULTILINE | re.DOTALL))
        self.assertIn('vector-hash', printed)
        for name, text in printed.items():
            self.assertEqual(standard.BLOCKS[name].split(), text.split(), name)

    def test_python_decodes_what_the_document_shows(self):
        found = []
        session = Session(lambda record, decoded: found.append((record, decoded)))
        lines = replay(read_vector(), session)
        self.assertEqual(lines, replay_natively(read_vector()))
        (record, decoded), = found
        self.assertEqual((record['body'], session.records), (7, 1))
        self.assertEqual(f'{session.hash:016x}', standard.BLOCKS['vector-hash'].strip())

        patch = session.blueprints.find(0, 0).patches[0]
        self.assertEqual(patch.basis.columns.ravel().tolist(), standard.read_numbers('vector-columns'))
        head = [decoded.head[name] for name in
                ('mode', 'grid', 'step', 'x', 'y', 'z', 'largest', 'turn', 'a', 'b', 'c')]
        self.assertEqual(head, standard.read_numbers('vector-head'))
        self.assertEqual(decoded.coefficients, standard.read_numbers('vector-coefficients'))
        self.assertEqual(decoded.suggestions.tolist(), standard.read_numbers('vector-suggestions'))
        self.assertEqual(decoded.sums.ravel().tolist(), standard.read_numbers('vector-sums'))
        bits = [f'{word:08x}' for word in decoded.shape.ravel().view(numpy.uint32)]
        self.assertEqual(bits, standard.BLOCKS['vector-vertices'].split())

    def test_any_cosine_is_good_enough(self):
        # Section 7: no entry of a basis of cosines lies so near to a half that the last bits of a library's cosine
        # decide how it is rounded. All grids that fit in a patch, up to the order of their sides.
        axes = {n: self.list_magnitudes(n) for n in range(1, 513)}
        nearest = min(self.find_distance(axes[x], axes[y], axes[z])
                      for x in range(1, 513)
                      for y in range(1, min(x, 512 // x) + 1)
                      for z in range(1, min(y, 512 // (x * y)) + 1))
        self.assertGreater(nearest, 3e-6)

    @staticmethod
    def list_magnitudes(n):
        """At least those that u(a, i, n) has."""
        if n == 1:
            return numpy.array([1.0])
        angles = numpy.pi * numpy.arange(n) / (2 * n)
        return numpy.append(numpy.sqrt(2 / n) * numpy.cos(angles), numpy.sqrt(1 / n))

    @staticmethod
    def find_distance(x, y, z):
        """Of the entries to the nearest half, in units of 2^-14."""
        entries = x[:, None, None] * y[:, None] * z * 16384
        return float(numpy.abs(entries - numpy.floor(entries) - 0.5).min())


class Recording:
    """A session that record_session wrote. Each scene is a test of its own, so that they run side by side."""

    def test_hash(self):
        messages = split((DATA / f'{self.scene}.session').read_bytes())
        followed = []
        session = Session(lambda record, decoded: followed.append(decoded.suggestions is not None))
        lines = replay(messages, session)
        self.assertEqual(lines, replay_natively(messages))
        self.assertEqual(session.refused, [])
        self.assertGreater(len(followed), 70)
        self.assertGreater(sum(followed), 20, 'records that follow contact')


class Arena(Recording, Case):
    """Full bases."""

    scene = 'arena'


class Curtain(Recording, Case):
    """Cosines; blueprints that change because the cloth tears."""

    scene = 'curtain'


class Patches(Recording, Case):
    """Scalar modes, a body of two patches, a plane."""

    scene = 'patches'


class FlippedByte(Case):
    def test_it_gives_another_hash(self):
        messages = split((DATA / 'patches.session').read_bytes())
        lines = [line.split() for line in replay_natively(messages)]
        session = Session()
        next_place = 0
        for share in (0.6, 0.75, 0.9):
            place, _, honest = lines[int(share * len(lines))]
            for message in messages[next_place:int(place)]:
                session.take(message)
            next_place = int(place)
            message = messages[next_place]
            message = flip(message, len(message) // 2)
            changed = copy.deepcopy(session)
            changed.take(message)
            native = replay_natively(messages[:next_place] + [message])[-1].split()[2]
            with self.subTest(place=place):
                self.assertEqual(f'{changed.hash:016x}', native)
                self.assertNotEqual(native, honest)


class Live(Case):
    """A server and clients of now, on virtual time."""

    def test_a_session_recorded_now(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / 'session'
            last = run('record_session', 'jelly_stack', '1', 'trained', path).splitlines()[-1]
            messages = split(path.read_bytes())
        lines, session = self.assert_alike(messages)
        self.assertEqual(f'{session.hash:x}', last.split()[1], 'of the client that played')
        self.assertGreater(len(lines), 10)

    def test_scenes_that_follow_one_another(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / 'session'
            last = run('record_session', 'lattice,pair,lattice', '1.5', 'untrained', path).splitlines()[-1]
            messages = split(path.read_bytes())
        lines, session = self.assert_alike(messages)
        self.assertEqual(f'{session.hash:x}', last.split()[1], 'of the client that played')
        self.assertFalse(session.is_first_scene)
        self.assertGreater(len(lines), 10)


class MadeUp(Case):
    """Bytes that no server sends: both decoders take and refuse the same."""

    def setUp(self):
        self.random = random.Random(1)
        self.welcome, self.blueprint, self.packet = read_vector()

    def number(self, packets):
        """Gives each packet the next sequence, so that none is taken for a duplicate."""
        return [packet[:3] + struct.pack('<I', i + 1) + packet[7:] for i, packet in enumerate(packets)]

    def test_payloads(self):
        packets = []
        for _ in range(1500):
            records = b''
            for _ in range(4):
                payload = self.random.randbytes(self.random.randint(8, 60))
                if self.random.random() < 0.5:  # the start of an honest one reaches further
                    payload = self.packet[21:21 + self.random.randint(1, 16)] + payload[:24]
                records += bytes([7, 0, len(payload)]) + payload
            packets.append(self.packet[:17] + records)
        lines, session = self.assert_alike([self.welcome, self.blueprint, *self.number(packets)])
        self.assertGreater(len(set(line.split()[2] for line in lines)), 100, 'records that decode')
        self.assertGreaterEqual(set(session.refused), {'bad mode', 'bad step', 'bad pose', 'trailing bytes', 'truncated'})

    def test_packets(self):
        packets = [flip(self.packet, at, bit) for at in range(17, len(self.packet)) for bit in range(8)]
        packets += [self.packet[:size] for size in range(17, len(self.packet))]
        self.assert_alike([self.welcome, self.blueprint, *self.number(packets)])

    def test_blueprints(self):
        whole = flatbuffer.read(self.blueprint[1:], 'ServerMessage')['body']['bytes'].tobytes()
        taken = 0
        for at in range(len(whole)):
            changed = flip(whole, at, self.random.randrange(8))
            with self.subTest(at=at):
                _, session = self.assert_alike([self.welcome, make_chunk(changed), self.packet])
                taken += session.hash != hash_bytes(b'')
        self.assertGreater(taken, 50)

    def test_control_messages(self):
        for i in range(2):
            messages = [self.welcome, self.blueprint, self.packet]
            for at in range(1, len(messages[i]), 2):
                changed = list(messages)
                changed[i] = flip(changed[i], at, self.random.randrange(8))
                with self.subTest(message=i, at=at):
                    self.assert_alike(changed)

    def test_kept_blueprint(self):
        whole = flatbuffer.read(self.blueprint[1:], 'ServerMessage')['body']['bytes'].tobytes()
        _, honest = self.assert_alike([self.welcome, self.blueprint, self.packet])
        messages = [self.welcome, make_chunk(whole, offset=len(whole)), self.packet]
        nothing = hash_bytes(b'')
        for kept, expected in (([whole], honest.hash), ([b'other', whole], honest.hash), ([], nothing),
                               ([flip(whole, 100)], nothing)):
            with self.subTest(kept=len(kept)):
                self.assertEqual(self.assert_alike(messages, kept)[1].hash, expected)
        with self.subTest('its bytes are no blueprint'):
            broken = whole[:-40]
            messages[1] = make_chunk(broken, offset=len(broken))
            self.assertEqual(self.assert_alike(messages, [broken])[1].hash, nothing)

    def test_order_of_pieces(self):
        whole = flatbuffer.read(self.blueprint[1:], 'ServerMessage')['body']['bytes'].tobytes()
        for i in range(60):
            messages = []
            for _ in range(4):
                generation = self.random.randrange(3)
                pieces = [make_chunk(whole, generation, at, 90) for at in range(0, len(whole), 90)]
                if self.random.random() < 0.6:  # begins anew, leaves a gap, or stands for what is kept
                    pieces.insert(self.random.randrange(len(pieces) + 1), make_chunk(
                        whole, self.random.randrange(3), self.random.choice((0, 90, len(whole))), 90))
                record = bytes([7, 128, generation << 3, 0]) if generation else bytes([7, 0])
                messages += pieces + [self.packet[:17] + record + self.packet[19:]]
            packets = iter(self.number([message for message in messages if message[0] == 2]))
            messages = [next(packets) if message[0] == 2 else message for message in messages]
            with self.subTest():
                self.assert_alike([self.welcome, *messages], [whole] if i % 2 == 0 else [])


if __name__ == '__main__':
    unittest.main()
