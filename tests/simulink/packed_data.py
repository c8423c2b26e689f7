"""MATLAB's binary data, element by element, for the tests."""

import struct

MARK = b"\x00\x01IM"


def element(kind, content):
    return struct.pack("<2I", kind, len(content)) + content + bytes(-len(content) % 8)


def matrix(kind, size, *body, name=b""):
    flags = element(6, struct.pack("<2I", kind, 0))
    extents = element(5, struct.pack(f"<{len(size)}i", *size)) if size else b""
    return element(14, flags + extents + element(1, name) + b"".join(body))


def double(value):
    return matrix(6, (1, 1), element(9, struct.pack("<d", value)))


def words(*numbers):
    return matrix(13, (len(numbers), 1), element(6, struct.pack(f"<{len(numbers)}I", *numbers)))


def octets(content):
    return matrix(9, (1, len(content)), element(2, content))


def structure(**fields):
    names = b"".join(name.encode().ljust(32, b"\0") for name in fields)
    head = element(5, struct.pack("<i", 32)) + element(1, names)
    return matrix(2, (1, 1), head, *fields.values())


def opaque(kind, content):
    return matrix(17, (), element(1, b"MCOS"), element(1, kind), content)
