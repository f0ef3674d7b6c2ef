"""What the tests of ctypes share: claims, hashes, memory with canaries, sizes of ffi-tests/vectors.rs."""

import ctypes
import struct

import fixpair_ctypes as fixpair
from fixpair_ctypes import Components

N, FINE, FINER, PADDING, ROWS, BOX, SEED = 12, 18, 24, 3, 40, 200.0, 0x0123456789ABCDEF

failures = []
claims = []


def check(holds, claim):
    claims.append(claim)
    if not holds:
        failures.append(claim)


def fnv(*pieces):
    """FNV-1a of 64 bits."""
    value = 0xCBF29CE484222325
    for piece in pieces:
        for byte in bytes(piece):
            value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def doubles(*values):
    return struct.pack(f"={len(values)}d", *values)


def integers(*values):
    return struct.pack(f"={len(values)}Q", *values)


class Buffer:
    """Zeros on a cache line, with 64 bytes of canary on either side."""

    everything = []

    def __init__(self, kind, count):
        size = ctypes.sizeof(kind) * count
        self.raw = (ctypes.c_uint8 * (size + 256))(*([0xA5] * (size + 256)))
        self.start = -(-ctypes.addressof(self.raw) // 64) * 64 + 64
        self.skip = self.start - ctypes.addressof(self.raw)
        self.array = (kind * count).from_buffer(self.raw, self.skip)
        ctypes.memset(self.start, 0, size)
        self.size = size
        Buffer.everything.append(self)

    def canaries_live(self):
        raw = bytes(self.raw)
        outside = raw[:self.skip] + raw[self.skip + self.size:]
        return outside == b"\xa5" * len(outside)

    def __bytes__(self):
        return ctypes.string_at(self.start, self.size)

    def at(self, element):
        """The address of an element."""
        return self.start + element * ctypes.sizeof(self.array._type_)


def elements(buffer, brick):
    """The bytes of a brick's elements, in the order of their indices."""
    width = ctypes.sizeof(buffer.array._type_) * (2 if brick.space == fixpair.FOURIER else 1)
    data, (a, b, c) = bytes(buffer), brick.stride
    places = (x * a + y * b + z * c for x in range(brick.count[0]) for y in range(brick.count[1])
              for z in range(brick.count[2]))
    return b"".join(data[place * width:(place + 1) * width] for place in places)


def noise(i):
    return ((i * 2654435761 + 12345) & 0xFFFFFFFF) / 2147483648.0 - 1.0


def made(kind, function, *arguments):
    """A structure that a function fills."""
    value = kind()
    function(value, *arguments)
    return value


def array(values):
    buffer = Buffer(ctypes.c_double, len(values))
    buffer.array[:] = values
    return buffer


def triples(start, size, count):
    return Components(start, start + size, start + 2 * size, 3, count)


def parallel_for(context, count, body, argument):
    """A loop of the host's, in Python, backwards."""
    for index in reversed(range(count)):
        body(argument, index)
    return 0
