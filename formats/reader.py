"""A reader in 60 lines: prints the points, or the vertices and triangles, of a spmesh stream as OBJ.

    python3 reader.py < STREAM

It shows how a stream is taken apart, and checks what no reader may leave out: checksums, sequence, counts, END.
It reads points and triangle meshes that are not compressed; spmesh.md says what else there is."""
import struct, sys

def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def take(length):
    data = sys.stdin.buffer.read(length)
    assert len(data) == length, "truncated"
    return data


head = take(16)
assert head[:8] == b"\x89SPM\r\n\x1a\n", "not a spmesh stream"
version, kind, length = struct.unpack("<HHI", head[8:])
assert version == 2 and kind in (1, 2) and 16 <= length <= 2**20, "not points or triangles of version 2"
body = take(length)
assert crc32c(head + body) == int.from_bytes(take(4), "little"), "damaged header"
coordinates, dims, elevation, flags, features, count = struct.unpack("<BBBBIQ", body[:16])
assert features == 0, "needs a feature that this reader does not know"
records, at = {}, 16
while at < length:
    tag, size = struct.unpack_from("<4sI", body, at)
    records[tag], at = body[at + 8 : at + 8 + size], at + 8 + size
grid = struct.unpack("<6d", records[b"GRID"]) if coordinates == 2 else (1.0,) * 3 + (0.0,) * 3
point = struct.Struct("<%d%s" % (dims + elevation, "i" if coordinates == 2 else "d"))
totals, finalized, tag, sequence = [0] * 7, 0, b"", 0
while tag != b"END ":
    tag, number, size, checksum = struct.unpack("<4sIII", frame := take(16))
    assert number == sequence and size <= 2**20, "a block is missing, too long or compressed"
    payload, sequence = take(size), (sequence + 1) % 2**32
    assert crc32c(frame[:12] + payload) == checksum, "damaged block"
    if tag in (b"PNTS", b"PTCH"):
        first, new, imported, simplices, final = struct.unpack_from("<QIIII", payload) if tag == b"PTCH" else (0, size // point.size, 0, 0, 0)
        start = 24 if tag == b"PTCH" else 0
        ids = list(range(first, first + new)) + list(struct.unpack_from("<%dQ" % imported, payload, start + new * point.size))
        assert start + new * point.size + 8 * imported + 12 * simplices + 4 * final == size, "counts do not fit"
        for stored in point.iter_unpack(payload[start : start + new * point.size]):
            print("v", *(c * scale + offset for c, scale, offset in zip(stored, grid, grid[3:])))
        for triangle in struct.iter_unpack("<3I", payload[size - 12 * simplices - 4 * final : size - 4 * final]):
            print("f", *(ids[corner] + 1 for corner in triangle))
        totals[0 if kind == 1 else 2] += new
        totals[3], finalized = totals[3] + simplices, finalized + final
    totals[1] += size // 8 * (tag == b"CELL")
    assert tag[0] & 32 or tag in (b"PNTS", b"PTCH", b"CELL", b"END "), "a block that this reader does not know"
stated = struct.unpack("<7Q", payload)
if kind == 2:
    totals[0], totals[4] = totals[2] + stated[4], stated[4]
assert list(stated) == totals and finalized == totals[2] and not sys.stdin.buffer.read(1), "wrong totals, or more after END"
