"""The range decoder and the coefficients of a shape payload: section 6 of STANDARD.md."""

from standard import read_numbers, read_rows

EXPECTATIONS = read_numbers('expectations')
LAST_MAGNITUDE = 15  # stands for this and all above
MAX_COEFFICIENT = 1 << 20


class Refused(Exception):
    """A payload or record that the document says to refuse; the text is its reason."""


class Table:
    """Symbols of given frequencies, which add up to 4,096."""

    def __init__(self, frequencies):
        assert sum(frequencies) == 4096
        self.frequencies = frequencies
        self.starts = [sum(frequencies[:i]) for i in range(len(frequencies))]
        self.symbols = [symbol for symbol, count in enumerate(frequencies) for _ in range(count)]


class RangeDecoder:
    def __init__(self, data):
        self.data = data
        self.next = 4
        head = data[:4] + bytes(4 - len(data[:4]))
        self.code = int.from_bytes(head, 'big')
        self.range = 0xFFFFFFFF

    def _narrow(self, start, width):
        code = self.code - start * self.range
        size = self.range * width
        while size < 1 << 24:
            byte = self.data[self.next] if self.next < len(self.data) else 0
            code = (code << 8 | byte) & 0xFFFFFFFF
            size <<= 8
            self.next += 1
        self.code = code
        self.range = size

    def read_symbol(self, table):
        self.range >>= 12
        symbol = table.symbols[min(self.code // self.range, 4095)]
        self._narrow(table.starts[symbol], table.frequencies[symbol])
        return symbol

    def read_uniform(self, count):
        self.range //= count
        value = min(self.code // self.range, count - 1)
        self._narrow(value, 1)
        return value

    def read_bits(self, bits):
        return self.read_uniform(1 << bits)

    def check_overrun(self):
        if self.next > len(self.data) + 4:
            raise Refused('truncated')

    def check_end(self):
        self.check_overrun()
        if self.next < len(self.data):
            raise Refused('trailing bytes')


MAGNITUDES = [Table(row) for row in read_rows('magnitude-frequencies')]


def find_logarithm(x):
    """Eight times the place of the highest bit (the lowest is 0), and the three bits behind it."""
    place = x.bit_length() - 1
    return 8 * place + ((x << 3) >> place & 7)


class Contexts:
    """Which table the next coefficient is read from."""

    def __init__(self):
        self.seen_short = self.expected_short = self.seen_long = self.expected_long = 4096
        self.expected = 0

    def find(self, level):
        self.expected = EXPECTATIONS[(level + 40) // 2]
        gain = (find_logarithm(self.seen_short) - find_logarithm(self.expected_short) +
                find_logarithm(self.seen_long) - find_logarithm(self.expected_long))
        place = find_logarithm(self.expected) + gain // 2 - 96 + 55
        return 0 if place < 0 else min(place // 3, len(MAGNITUDES) - 1)

    def add(self, magnitude):
        seen = min(magnitude, 1023) << 12
        self.seen_short += seen + 512 - (self.seen_short >> 3)
        self.expected_short += self.expected + 512 - (self.expected_short >> 3)
        self.seen_long += seen + 128 - (self.seen_long >> 5)
        self.expected_long += self.expected + 128 - (self.expected_long >> 5)


def read_escape(decoder):
    length = 0
    while length < 20 and decoder.read_bits(1) == 1:
        length += 1
    high = max(length - 16, 0)
    low = decoder.read_bits(length - high)
    return (1 << length) - 1 + (low | decoder.read_bits(high) << (length - high))


def read_coefficients(decoder, levels):
    """One coefficient, in steps, for each level (already relative to the step, within -40 and 80)."""
    contexts = Contexts()
    values = []
    for level in levels:
        context = contexts.find(level)
        magnitude = decoder.read_symbol(MAGNITUDES[context])
        if magnitude == LAST_MAGNITUDE:
            magnitude += read_escape(decoder)
        if context > 24:
            low_bits = (context - 22) // 3
            magnitude = magnitude << low_bits | decoder.read_bits(low_bits)
        if magnitude > MAX_COEFFICIENT:
            raise Refused('bad coefficient')
        contexts.add(magnitude)
        values.append(-magnitude if magnitude > 0 and decoder.read_bits(1) == 1 else magnitude)
        decoder.check_overrun()
    return values
