"""Objects in a model's binary workspace, in data made as MATLAB lays them out."""

import struct

from packed_data import MARK, double, element, matrix, octets, opaque, structure, words

from drake_leg.simulink.matlab.matfiles import read_struct


def reference(number):
    return opaque(b"Simulink.Parameter", words(0xDD000000, 2, 1, 1, number, 1))


def objects(*values):
    """Lay out objects with the properties Value and Text, whose value is not in the list."""
    names = b"Simulink\0Parameter\0Value\0Text\0".ljust(40, b"\0")
    classes = struct.pack("<8I", 0, 0, 0, 0, 1, 2, 0, 0)
    sets = [0, 0]
    table = [0] * 6
    for number, _ in enumerate(values):
        sets += [2, 3, 1, number, 4, 0, 2, 0]
        table += [1, 0, 0, 0, number + 1, number + 1]
    regions = [names, classes, b"", struct.pack(f"<{len(table)}I", *table)]
    regions.append(struct.pack(f"<{len(sets)}I", *sets))
    ends, at = [], 40
    for region in regions:
        at += len(region)
        ends.append(at)
    head = struct.pack("<10I", 3, 4, *ends, *[at] * 3) + b"".join(regions)
    cells = (octets(head), matrix(6, (0, 0), element(9, b"")), *map(double, values))
    wrapped = opaque(b"FileWrapper__", matrix(1, (len(cells), 1), *cells))
    return octets(MARK + bytes(4) + structure(MCOS=wrapped))


def test_values_of_parameter_objects_are_read():
    fields = structure(L=reference(1), M=reference(2), plain=double(7.0), gone=reference(9))
    content = MARK + bytes(4) + fields + objects(0.25, 4.0)
    assert read_struct(content, "the workspace") == {"L": 0.25, "M": 4.0, "plain": 7.0}


def test_objects_without_their_list_are_left_out():
    content = MARK + bytes(4) + structure(L=reference(1), plain=double(7.0))
    assert read_struct(content, "the workspace") == {"plain": 7.0}
